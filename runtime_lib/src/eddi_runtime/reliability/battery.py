"""A battery whose level of charge in percent, and temperature, are observed.

Source: the battery of SafeDrones (Aslansefat et al. 2022): bands of charge, each with a state of
use and one of recovery.
"""

from __future__ import annotations

from typing import Optional

from .arrhenius import Arrhenius
from .chain import ChainSpec
from .component import Component, Known
from .estimate import Estimate, Moment, Values
from .free_horizon import FreeHorizon
from .markov import generator, mean_times

_BANDS = {4: 0, 3: 2, 2: 4}
EMPTY = 6
_STATES = 8


def battery_spec(failure: float, alpha: float, beta: float, degradation: float) -> ChainSpec:
    """Return the chain B4, C4, B3, C3, B2, C2, Empty, F (rates in 1/h)."""
    arcs = []
    for band in range(3):
        b = 2 * band
        below = b + 2 if band < 2 else EMPTY
        arcs += [(b, b + 1, alpha), (b + 1, b, beta), (b, below, degradation), (b, 7, failure)]
    return ChainSpec(_STATES, 0, (6, 7), tuple(arcs))


class Battery(Component):
    """The level selects a band; heat makes the chain run faster (accelerated life).

    Its memory is the band: a known level leaves one state possible, an unknown one all from the
    last band down, until a level comes that is not ignored.

    Args:
        spec: of ``battery_spec``.
        level: id of the input, percent.
        horizon: hours, the longest one.
        repair: the level may rise again.
        heat: how temperature ages it; None: not at all.
        temperature: id of the input, degC.
    """

    def __init__(
        self,
        spec: ChainSpec,
        level: str,
        horizon: float,
        *,
        repair: bool,
        heat: Optional[Arrhenius] = None,
        temperature: str = "",
    ) -> None:
        self._level, self._repair = level, repair
        self._heat, self._hot = heat, None if heat is None else heat.limit(temperature)
        worst = 1.0 if heat is None else heat.worst
        self._ahead = FreeHorizon(spec.states, spec.arcs, spec.fail, horizon * worst)
        self._now = [0.0] * EMPTY + [1.0, 1.0]
        self._tau = mean_times(generator(spec.states, spec.arcs, spec.fail), spec.fail).tolist()
        self._band, self._missed = 4, False

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        """Take level and temperature; unknown ones are bounded by the worst."""
        del known
        level = self._believed(values[self._level])
        factor, colder = 1.0, False
        if self._heat is not None and self._hot is not None:
            hot, is_known = self._most(values, self._hot)
            colder = not is_known  # it may be so cold that nothing ages
            factor = self._heat.factor(hot)
        first = _BANDS.get(self._band, EMPTY)
        ahead = self._ahead.at(factor * moment.horizon)
        if level is not None and not colder:
            p, alive = ahead[first]
            return Estimate(p, p, alive, self._aged(self._tau[first], factor))
        if level is None:  # with repair it may have been charged
            possible = slice(0 if self._repair else first, _STATES)
        else:
            possible = slice(first, first + 1)
        failed, working = zip(*ahead[possible])
        low = min(self._now[possible] if colder else failed)
        missing = [self._level] if level is None else []
        missing += [self._hot.name] if colder and self._hot is not None else []
        life = self._aged(min(self._tau[possible]), factor)
        return Estimate(low, max(failed), min(working), life, tuple(missing))

    @staticmethod
    def _aged(life: float, factor: float) -> float:
        return life / factor if factor > 0.0 and life > 0.0 else life

    def _believed(self, level: Optional[float]) -> Optional[float]:
        """Return the level, None where the band is not known either."""
        if level is None:
            self._missed = self._band in _BANDS  # what is empty cannot sink
            return None
        band = 4 if level > 75 else 3 if level > 50 else 2 if level > 25 else 1
        if band > self._band and not self._repair:
            self.latched += 1
            self._report_fault(
                self._level, "it rises to a higher band; ignored without `repair: true`"
            )
            return None if self._missed else level
        self._band, self._missed = band, False
        return level

    def reset(self) -> None:
        """Return to a full battery."""
        super().reset()
        self._band, self._missed = 4, False
        if self._hot is not None:
            self._hot.reset()

"""Rotors, a processor, equal units, and models in series."""

from __future__ import annotations

import math
from typing import Any, Dict, List, Mapping, Optional, Tuple

from .arrhenius import Arrhenius
from .chain import Chain, Horizons
from .component import AGAIN, Component, Known, reader
from .estimate import Estimate, Moment, Values
from .limit import Limit
from .seen import KEPT, Seen
from .structures import Rotors
from .weibull import hazard

_NAN = float("nan")
_LARGEST_STRESS = 1e300


class Propulsion(Component):
    """Rotors whose motors are known to work or not.

    While all statuses are known, the state is: what lies ahead of it was found in advance.

    Args:
        rotors: chain and structure, motors by their place in the configuration.
        inputs: for each place the input of its motor and, for a list, the position in it.
        repair: a failed motor may work again.
        quantum: hours.
        horizons: where to look ahead.
    """

    def __init__(
        self,
        rotors: Rotors,
        inputs: Tuple[Tuple[str, Optional[int]], ...],
        quantum: float,
        horizons: Horizons,
        *,
        repair: bool,
    ) -> None:
        self.chain = Chain(rotors.spec, quantum, horizons)
        self._rotors, self._inputs, self._repair = rotors, inputs, repair
        self._statuses = reader(tuple(dict.fromkeys(name for name, _ in inputs)))
        self._sure: Dict[int, List[Estimate]] = {}
        self._seen: Dict[Tuple[Optional[bool], ...], Seen] = {}
        self._forget()

    def _forget(self) -> None:
        self._failed = [False] * self._rotors.motors
        self._last: Optional[Tuple[Any, ...]] = None  # statuses that ask for no further look
        self._state: Optional[int] = None  # the one that is known, as long as it is
        self._vague: Optional[Seen] = None

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        """Take the status of each motor."""
        del known
        statuses = self._statuses(values)
        if statuses != self._last:
            self._take(values, statuses)
        if self._state is None:
            return self._bounded(moment)
        sure = self._sure.get(moment.at)
        if sure is None:
            sure = self._sure[moment.at] = self.chain.sure(moment.at)
        return sure[self._state]

    def _take(self, values: Values, statuses: Tuple[Any, ...]) -> None:
        """Find the states that are possible."""
        latched = self.latched
        working: List[Optional[bool]] = []
        unknown: List[str] = []
        for motor, (name, position) in enumerate(self._inputs):
            value = values[name]
            if position is not None and value is not None:
                value = value[position] if len(value) == self._rotors.motors else None
            status = self._status(motor, value)
            if status is None:
                unknown.append(name)
            working.append(status)
        # a claim that something works again is counted each time
        self._last = statuses if latched == self.latched else None
        if not unknown:
            self._state = int(self._rotors.consistent(tuple(working)).argmax())
            self._vague = None
            return
        if self._state is not None:
            self.chain.place(self._state)
        self._state, self._vague = None, self._see(tuple(working), tuple(dict.fromkeys(unknown)))

    def _see(self, working: Tuple[Optional[bool], ...], unknown: Tuple[str, ...]) -> Seen:
        seen = self._seen.get(working)
        if seen is None:
            if len(self._seen) >= KEPT:
                self._seen.clear()
            mask = self._rotors.consistent(working)
            seen = self._seen[working] = self.chain.seen(mask, unknown)
        return seen

    def _bounded(self, moment: Moment) -> Estimate:
        seen = self._vague
        assert seen is not None
        assert seen.mask is not None
        found = self.chain.step(moment, seen)
        # a set of failures without weight is new, not contradictory: at the start nothing failed
        return found._replace(reason="") if found.reason and seen.mask[-1] else found

    def _status(self, motor: int, value: Optional[bool]) -> Optional[bool]:
        if self._failed[motor] and value is not False and not self._repair:
            if value is True:
                self.latched += 1
                self._report_fault(self._inputs[motor][0], AGAIN)
            return False
        self._failed[motor] = value is False
        return value

    def prepare(self, horizons: Horizons) -> None:
        """Prepare other horizons."""
        self.chain.prepare(horizons)
        self._sure.clear()
        self._seen.clear()
        self.reset()

    def reset(self) -> None:
        """All motors work."""
        super().reset()
        self._forget()
        self.chain.reset()


class Processor(Component):
    """A processor that ages by temperature (Arrhenius) and load: cumulative exposure.

    Args:
        values: mttf_ref in hours, shape, u_max, age in hours at reference conditions.
        heat: how temperature ages it.
        temperature: id of the input, degC.
        utilisation: id of the input, None for always one.
    """

    def __init__(
        self,
        values: Mapping[str, float],
        heat: Arrhenius,
        temperature: str,
        utilisation: Optional[str],
    ) -> None:
        self._shape = values["shape"]
        self._mean = values["mttf_ref"]
        self._scale = self._mean / math.gamma(1.0 + 1.0 / self._shape)
        self._heat, self._hot = heat, heat.limit(temperature)
        most = values["u_max"]
        self._load = None if utilisation is None else Limit(utilisation, most, f"u_max ({most:g})")
        self._age = values["age"]
        self._least = self._largest = self._age  # exposure: apart once something was missed

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        """Add the exposure since the last step; unknown conditions count as the worst ones."""
        del known
        unknown: List[str] = []
        hot, known_hot = self._most(values, self._hot)
        if not known_hot:
            unknown.append(self._hot.name)
        load = 1.0
        if self._load is not None:
            load, known_load = self._most(values, self._load)
            if not known_load:
                unknown.append(self._load.name)
        stress = min(load * self._heat.factor(hot), _LARGEST_STRESS)
        self._largest += stress * moment.hours
        if not unknown:
            self._least += stress * moment.hours
        best, worst = self._ahead(stress * moment.horizon)
        low = 0.0 if unknown else -math.expm1(-best)
        high, alive = -math.expm1(-worst), math.exp(-worst)
        return Estimate(low, high, alive, self._life(stress), tuple(unknown))

    def _ahead(self, exposure: float) -> Tuple[float, float]:
        """Return the hazard of what lies ahead, at least and at most."""
        if self._shape == 1.0:  # a difference of large numbers would cancel
            same = exposure / self._scale
            return same, same
        most = hazard(self._largest, exposure, self._scale, self._shape)
        if self._least == self._largest:
            return most, most
        least = hazard(self._least, exposure, self._scale, self._shape)
        return min(least, most), max(least, most)  # with shape < 1 it gets better with time

    def _life(self, stress: float) -> float:
        if stress == 0.0:
            return math.inf
        return self._mean / stress if self._shape == 1.0 or self._largest == 0.0 else _NAN

    def reset(self) -> None:
        """Return to the start of the mission."""
        super().reset()
        self._least = self._largest = self._age
        self._hot.reset()
        if self._load is not None:
            self._load.reset()


class KOutOfN(Component):
    """Equal units, of which k are needed: satellites, cells, redundant sensors."""

    def __init__(self, k: int, rate: float, largest: Optional[int], name: str) -> None:
        self._k, self._rate, self._largest, self._name = k, rate, largest, name

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        """Take how many units are available."""
        del known
        units = values[self._name]
        if units is not None:
            p, r = self._failure(int(units), moment.horizon)
            return Estimate(p, p, r, self._life(int(units)))
        best = 0.0 if self._largest is None else self._failure(self._largest, moment.horizon)[0]
        return Estimate(best, 1.0, 0.0, 0.0, (self._name,))

    def _failure(self, n: int, hours: float) -> Tuple[float, float]:
        if n < self._k:
            return 1.0, 0.0
        q, w = -math.expm1(-self._rate * hours), math.exp(-self._rate * hours)
        terms = [_binomial(n, i) * w**i * q ** (n - i) for i in range(n + 1)]
        return min(1.0, math.fsum(terms[: self._k])), min(1.0, math.fsum(terms[self._k :]))

    def _life(self, n: int) -> float:
        if self._rate == 0.0 and n >= self._k:
            return math.inf
        return math.fsum(1.0 / (i * self._rate) for i in range(self._k, n + 1))


def _binomial(n: int, k: int) -> float:
    result = 1
    for i in range(min(k, n - k)):
        result = result * (n - i) // (i + 1)
    return float(result)


class Series(Component):
    """Fails as soon as one of its parts does."""

    def __init__(self, parts: Tuple[str, ...]) -> None:
        self._parts = parts

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        """Combine the estimates of the parts."""
        del values, moment
        parts = [known[name] for name in self._parts]
        low, high = _series([p.low for p in parts]), _series([p.high for p in parts])
        unknown = tuple(dict.fromkeys(name for part in parts for name in part.unknown))
        reason = next((part.reason for part in parts if part.reason), "")
        alive = math.prod(part.reliability for part in parts)
        mttf = parts[0].mttf if len(parts) == 1 else _NAN
        return Estimate(low, high, alive, mttf, unknown, reason)


def _series(failures: List[float]) -> float:
    if any(p >= 1.0 for p in failures):
        return 1.0
    return -math.expm1(math.fsum(math.log1p(-p) for p in failures)) + 0.0  # never -0.0

"""Models that are chains under observation, and the two with a formula of their own."""

from __future__ import annotations

import math
from itertools import product
from operator import itemgetter
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from .arrhenius import Arrhenius
from .chain import INCONSISTENT, Chain, ChainSpec, Horizons, Seen
from .component import AGAIN, Component, Known
from .estimate import Estimate, Moment, Values
from .estimate import known as sure
from .limit import Limit
from .structures import Rotors
from .weibull import hazard

_NAN = float("nan")
_LARGEST_STRESS = 1e300
_KEPT = 64
"""How many different observations of a chain are kept."""
_ALL_VALUES = 10
"""Unknown inputs of a chain of which all values are tried."""


def reader(names: Sequence[str]) -> Callable[[Values], Tuple[Any, ...]]:
    """Return what reads the values of some inputs as a tuple."""
    if len(names) == 1:
        (name,) = names
        return lambda values: (values[name],)
    return itemgetter(*names) if names else lambda _: ()


class MarkovChain(Component):
    """A chain of the user's own, observed through verdicts that a state holds.

    Args:
        spec: the chain.
        observe: (state, input id, negated): the verdict F excludes the state.
        quantum: hours.
        horizons: where to look ahead.
        age: hours that it had run, unobserved, before the start of the mission.
        repair: after it was seen to have failed it may work again.
    """

    def __init__(
        self,
        spec: ChainSpec,
        observe: Tuple[Tuple[int, str, bool], ...],
        quantum: float,
        horizons: Horizons,
        age: float = 0.0,
        *,
        repair: bool = False,
    ) -> None:
        self.chain = Chain(spec, quantum, horizons, age)
        self._observe, self._repair = observe, repair
        self._lost = False  # it was seen that it has failed
        names = tuple(dict.fromkeys(name for _, name, _ in observe))
        self._names, self._verdicts = names, reader(names)
        self._seen: Dict[Tuple[Any, ...], Seen] = {(): self.chain.everything}

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        """Exclude the states whose verdict is F."""
        del known
        verdicts = self._verdicts(values)
        seen = self._seen.get(verdicts)
        if seen is None:
            seen = self._see(verdicts)
        if self._lost:
            return self._again(moment, seen, verdicts)
        self._lost = seen.fatal
        return self.chain.step(moment, seen)

    def _again(self, moment: Moment, seen: Seen, verdicts: Tuple[Any, ...]) -> Estimate:
        """Take what is seen after a failure."""
        if self._repair:
            found = self.chain.step(moment, seen)
            if not seen.alive:
                return found
            self._lost = False  # without weight, but no contradiction: it was repaired
            return found._replace(reason="")
        if not seen.alive:
            return sure(1.0, 0.0, 0.0)
        self.latched += 1
        given = dict(zip(self._names, verdicts))
        for state, name, negated in self._observe:
            if state in self.chain.fail and given[name] is negated:
                self._say(name, AGAIN)
        return sure(1.0, 0.0, 0.0, INCONSISTENT)

    def _see(self, verdicts: Tuple[Any, ...]) -> Seen:
        mask = np.ones(self.chain.states)
        given = dict(zip(self._names, verdicts))
        for state, name, negated in self._observe:
            if given[name] is negated:
                mask[state] = 0.0
        unknown = tuple(name for name in self._names if given[name] is None)
        if len(self._seen) >= _KEPT:
            self._seen.clear()
        seen = self.chain.seen(mask, unknown)
        if seen.alive and unknown and self._may_exclude_all(given, unknown):
            seen = seen._replace(bounds=[(low, 1.0, 0.0, 0.0) for low, _, _, _ in seen.bounds])
        self._seen[verdicts] = seen
        return seen

    def _may_exclude_all(self, given: Dict[str, Any], unknown: Tuple[str, ...]) -> bool:
        """Tell whether no state is left for some values of unknown inputs: that is a failure."""
        if len(unknown) > _ALL_VALUES:
            return True
        for values in product((False, True), repeat=len(unknown)):
            whole = {**given, **dict(zip(unknown, values))}
            excluded = {state for state, name, negated in self._observe if whole[name] is negated}
            if len(excluded) == self.chain.states:
                return True
        return False

    def prepare(self, horizons: Horizons) -> None:
        """Prepare other horizons."""
        self.chain.prepare(horizons)
        self._seen = {(): self.chain.everything}
        self.reset()

    def reset(self) -> None:
        """Return to the start of the mission."""
        super().reset()
        self._lost = False
        self.chain.reset()


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
            if len(self._seen) >= _KEPT:
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
                self._say(self._inputs[motor][0], AGAIN)
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
        self._exposure = self._age

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
        # what gets better with time, shape < 1, is worst when it has not aged
        if not unknown or self._shape >= 1.0:
            self._exposure += stress * moment.hours
        if self._shape == 1.0:  # a difference of large numbers would cancel
            ahead = stress * moment.horizon / self._scale
        else:
            ahead = hazard(self._exposure, stress * moment.horizon, self._scale, self._shape)
        p = -math.expm1(-ahead)
        low = 0.0 if unknown else p
        return Estimate(low, p, math.exp(-ahead), self._life(stress), tuple(unknown))

    def _life(self, stress: float) -> float:
        if stress == 0.0:
            return math.inf
        return self._mean / stress if self._shape == 1.0 or self._exposure == 0.0 else _NAN

    def reset(self) -> None:
        """Return to the start of the mission."""
        super().reset()
        self._exposure = self._age
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

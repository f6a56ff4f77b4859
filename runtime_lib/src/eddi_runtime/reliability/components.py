"""Models that are chains under observation, and the two with a formula of their own."""

from __future__ import annotations

import math
from typing import List, Mapping, Optional, Tuple

import numpy as np

from .arrhenius import Arrhenius
from .chain import INCONSISTENT, Chain, ChainSpec, Horizons
from .component import Component, Known
from .estimate import Estimate, Moment, Values
from .structures import Rotors

_NAN = float("nan")


class MarkovChain(Component):
    """A chain of the user's own, observed through verdicts that a state holds.

    Args:
        spec: the chain.
        observe: (state, input id, negated): the verdict F excludes the state.
        quantum: hours.
        horizons: where to look ahead.
    """

    def __init__(
        self,
        spec: ChainSpec,
        observe: Tuple[Tuple[int, str, bool], ...],
        quantum: float,
        horizons: Horizons,
    ) -> None:
        self.chain = Chain(spec, quantum, horizons)
        self._observe = observe
        self._mask = np.ones(spec.states) if observe else None

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        """Exclude the states whose verdict is F."""
        del known
        self.chain.advance(moment.quanta)
        unknown: List[str] = []
        mask = self._mask
        if mask is not None:
            mask[:] = 1.0
            for state, name, negated in self._observe:
                verdict = values[name]
                if verdict is None:
                    unknown.append(name)
                elif verdict is negated:
                    mask[state] = 0.0
        fits = self.chain.observe(mask)
        names = tuple(dict.fromkeys(unknown))
        return self.chain.estimate(moment, mask, names, "" if fits else INCONSISTENT)

    def reset(self) -> None:
        """Return to the initial state."""
        super().reset()
        self.chain.reset()


class Propulsion(Component):
    """Rotors whose motors are known to work or not.

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
        self._failed = [False] * rotors.motors

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        """Take the status of each motor."""
        del known
        self.chain.advance(moment.quanta)
        working: List[Optional[bool]] = []
        unknown: List[str] = []
        for motor, (name, position) in enumerate(self._inputs):
            value = values[name]
            if position is not None and value is not None:
                value = value[position] if len(value) == self._rotors.motors else None
            if value is None and not self._failed[motor]:
                unknown.append(name)
            working.append(self._status(motor, value))
        mask = self._rotors.consistent(tuple(working))
        fits = self.chain.observe(mask)
        # a set of failures without weight is new, not contradictory: at the start nothing failed
        reason = "" if fits or not unknown or mask[-1] else INCONSISTENT
        return self.chain.estimate(moment, mask, tuple(dict.fromkeys(unknown)), reason)

    def _status(self, motor: int, value: Optional[bool]) -> Optional[bool]:
        if self._failed[motor] and value is not False and not self._repair:
            self.latched += value is True
            return False
        self._failed[motor] = value is False
        return value

    def reset(self) -> None:
        """All motors work."""
        super().reset()
        self._failed = [False] * self._rotors.motors
        self.chain.reset()


class Processor(Component):
    """A processor that ages by temperature (Arrhenius) and load: cumulative exposure.

    Args:
        values: mttf_ref in hours, shape, u_max.
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
        self._heat = heat
        self._worst = values["u_max"] * heat.worst
        self._temperature, self._utilisation = temperature, utilisation
        self._exposure = 0.0

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        """Add the exposure since the last step; unknown conditions count as the worst ones."""
        del known
        heat = values[self._temperature]
        load = 1.0 if self._utilisation is None else values[self._utilisation]
        names = {self._temperature: heat, self._utilisation or "": load}
        unknown = tuple(name for name, value in names.items() if value is None)
        stress = self._worst if unknown else load * self._heat.factor(heat)
        self._exposure += stress * moment.hours
        before = self._hazard(self._exposure)
        ahead = self._hazard(self._exposure + stress * moment.horizon) - before
        if self._shape == 1.0:  # a difference of large numbers would cancel
            ahead = stress * moment.horizon / self._scale
        p = -math.expm1(-ahead)
        return Estimate(0.0 if unknown else p, p, math.exp(-ahead), self._life(stress), unknown)

    def _hazard(self, exposure: float) -> float:
        return float((exposure / self._scale) ** self._shape)

    def _life(self, stress: float) -> float:
        if stress == 0.0:
            return math.inf
        return self._mean / stress if self._shape == 1.0 or self._exposure == 0.0 else _NAN

    def reset(self) -> None:
        """Return to a new processor."""
        super().reset()
        self._exposure = 0.0


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
    return -math.expm1(math.fsum(math.log1p(-p) for p in failures))

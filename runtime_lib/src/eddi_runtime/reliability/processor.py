"""A processor that ages by temperature (Arrhenius) and load."""

from __future__ import annotations

import math

from .component import NAN, Component, Estimate, Known, Moment, Values, hazard
from .laws import Arrhenius, Limit

_LARGEST_STRESS = 1e300


class Processor(Component):
    """Cumulative exposure, of which the law of Weibull makes a hazard."""

    def __init__(
        self,
        mean: float,  # hours to failure at reference conditions
        shape: float,
        heat: Arrhenius,
        temperature: str,
        load: tuple[str, float] | None = None,  # id of its input, and its limit
        age: float = 0.0,  # hours at reference conditions
    ) -> None:
        self._mean, self._shape, self._age = mean, shape, age
        self._scale = mean / math.gamma(1.0 + 1.0 / shape)
        self._heat, self._hot = heat, heat.limit(temperature)
        self._load = None if load is None else Limit(*load, f"u_max ({load[1]:g})")
        self.reset()

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        unknown: list[str] = []
        hot, known_hot = self._hot.most(values, self)
        if not known_hot:
            unknown.append(self._hot.name)
        load = 1.0
        if self._load is not None:
            load, known_load = self._load.most(values, self)
            if not known_load:
                unknown.append(self._load.name)
        stress = min(load * self._heat.factor(hot), _LARGEST_STRESS)
        self._largest += stress * moment.hours
        if not unknown:
            self._least += stress * moment.hours
        best, worst = self._ahead(stress * moment.horizon)
        low = 0.0 if unknown else -math.expm1(-best)
        high, alive = -math.expm1(-worst), math.exp(-worst)
        steady = self._shape == 1.0 or self._largest == 0.0
        life = math.inf if stress == 0.0 else self._mean / stress if steady else NAN
        return Estimate(low, high, alive, life, tuple(unknown))

    def _ahead(self, exposure: float) -> tuple[float, float]:
        """Return the hazard of what lies ahead, at least and at most."""
        if self._shape == 1.0:  # a difference of large numbers would cancel
            same = exposure / self._scale
            return same, same
        most = hazard(self._largest, exposure, self._scale, self._shape)
        if self._least == self._largest:
            return most, most
        least = hazard(self._least, exposure, self._scale, self._shape)
        return min(least, most), max(least, most)  # with shape < 1 it gets better with time

    def reset(self) -> None:
        super().reset()
        self._least = self._largest = self._age  # exposure: apart once something was missed
        self._hot.reset()
        if self._load is not None:
            self._load.reset()

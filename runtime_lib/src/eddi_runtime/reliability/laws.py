"""How heat ages things, by Arrhenius, and inputs whose limit is declared."""

from __future__ import annotations

import math
from typing import NamedTuple

from .component import Component, Values

BOLTZMANN = 8.617333262e-5  # eV/K
_KELVIN = 273.15
_HOTTEST = 700.0


class Arrhenius(NamedTuple):
    """Ageing at a temperature, relative to a reference (Arrhenius 1889; IEC 61709)."""

    energy: float  # activation energy in eV
    reference: float  # temperature in degC at which the factor is 1
    hottest: float  # temperature in degC that counts while the true one is not known

    def factor(self, temperature: float) -> float:
        """Return the acceleration factor at a temperature in degC; finite for every one."""
        warmer = 1.0 / (self.reference + _KELVIN) - 1.0 / (temperature + _KELVIN)
        return math.exp(min(self.energy / BOLTZMANN * warmer, _HOTTEST))

    def limit(self, name: str) -> Limit:
        return Limit(name, self.hottest, f"t_max ({self.hottest:g} degC)")


class Limit:
    """The range of an input up to a declared limit, which a sensor may be seen to contradict.

    A value above it is not believed, but the input may be as large until one is believed.
    """

    def __init__(self, name: str, largest: float, shown: str) -> None:
        self.name, self._largest, self._shown = name, largest, shown
        self._worst = largest

    def most(self, values: Values, owner: Component) -> tuple[float, bool]:
        """Return the value of the input, or the worst that it may be, and whether it is known."""
        value: float | None = values[self.name]
        if value is None:
            return self._worst, False
        self._worst = max(value, self._largest)
        if value > self._largest:
            text = f"{value:g} is above {self._shown}; it counts as unknown"
            owner.report_fault(self.name, text)
        return value, value <= self._largest

    def reset(self) -> None:
        self._worst = self._largest

"""How much faster something ages when it is hot."""

from __future__ import annotations

import math
from typing import NamedTuple

from .limit import Limit

BOLTZMANN = 8.617333262e-5
"""eV/K."""
_KELVIN = 273.15
_LARGEST = 700.0


class Arrhenius(NamedTuple):
    """Law of Arrhenius: ageing at a temperature, relative to a reference.

    Source: S. Arrhenius 1889; as acceleration factor in JEDEC JEP122 and IEC 61709.

    Attributes:
        energy: activation energy in eV.
        reference: temperature in degC at which the factor is 1.
        hottest: temperature in degC that counts while the true one is not known.
    """

    energy: float
    reference: float
    hottest: float

    def factor(self, temperature: float) -> float:
        """Return the acceleration factor at a temperature in degC; finite for every one."""
        warmer = 1.0 / (self.reference + _KELVIN) - 1.0 / (temperature + _KELVIN)
        return math.exp(min(self.energy / BOLTZMANN * warmer, _LARGEST))

    @property
    def worst(self) -> float:
        """The factor at the hottest temperature."""
        return self.factor(self.hottest)

    def limit(self, name: str) -> Limit:
        """Return the range of a temperature input."""
        return Limit(name, self.hottest, f"t_max ({self.hottest:g} degC)")

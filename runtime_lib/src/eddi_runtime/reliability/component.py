"""What every model of a monitor can do."""

from __future__ import annotations

from operator import itemgetter
from types import MappingProxyType
from typing import Any, Callable, Mapping, Sequence, Tuple

from .chain import Horizons
from .estimate import Estimate, Moment, Values
from .limit import Limit

Known = Mapping[str, Estimate]
"""Model -> what it reported in this step."""

NOTHING: Mapping[str, str] = MappingProxyType({})
AGAIN = "it reports that a failed part works again; ignored without `repair: true`"


def reader(names: Sequence[str]) -> Callable[[Values], Tuple[Any, ...]]:
    """Return what reads the values of some inputs as a tuple."""
    if len(names) == 1:
        (name,) = names
        return lambda values: (values[name],)
    return itemgetter(*names) if names else lambda _: ()


class Component:
    """One model of a monitor; it is asked once a step, behind those that it uses."""

    latched: int = 0
    """How often a claim was ignored that something failed works again."""

    said: Mapping[str, str] = NOTHING
    """Input id -> what is wrong with its value, since the monitor took this over."""

    @property
    def grows(self) -> bool:
        """Return whether what lies ahead never gets less probable with the horizon."""
        return True

    def _report_fault(self, name: str, text: str) -> None:
        self.said = {**self.said, name: text}

    def _most(self, values: Values, limit: Limit) -> Tuple[float, bool]:
        """Return the value of an input, or the worst that it may be, and whether it is known."""
        value, fault = limit.take(values[limit.name])
        if value is not None:
            return value, True
        if fault:
            self._report_fault(limit.name, fault)
        return limit.worst, False

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        """Let time pass, take the observations, look ahead."""
        raise NotImplementedError

    def prepare(self, horizons: Horizons) -> None:
        """Prepare other horizons and return to the start of the mission."""
        del horizons
        self.reset()

    def reset(self) -> None:
        """Return to the start of the mission."""
        self.latched, self.said = 0, NOTHING

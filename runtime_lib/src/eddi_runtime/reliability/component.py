"""What every model of a monitor can do, and what it reports in a step."""

from __future__ import annotations

from operator import itemgetter
from types import MappingProxyType
from typing import Any, Callable, Mapping, NamedTuple, Sequence

Values = Mapping[str, Any]
"""Input id -> bool, float, list of them with None, or None where nothing is known."""

NAN = float("nan")
NOTHING: Mapping[str, str] = MappingProxyType({})
AGAIN = "it reports that a failed part works again; ignored without `repair: true`"


class Moment(NamedTuple):
    """When a step is."""

    quanta: int  # how many quanta have passed since the last step
    hours: float  # the same in hours
    age: float  # hours since the first step
    horizon: float  # hours from now to the horizon
    at: int  # position of the horizon among those that were prepared


class Estimate(NamedTuple):
    """Probability of failure from now to the horizon."""

    low: float  # in the best case of what is unknown, or was when it mattered
    high: float  # in the worst case; equal to ``low`` when nothing was missed
    reliability: float  # probability of no failure in the worst case
    mttf: float  # remaining mean time to failure in hours; NaN: not computed
    unknown: tuple[str, ...] = ()  # inputs on which the result depends and that are not known
    reason: str = ""  # why the result cannot be trusted for another reason; empty otherwise


Known = Mapping[str, Estimate]
"""Model -> what it reported in this step."""

_new = tuple.__new__


def sure(p: float, reliability: float, mttf: float, reason: str = "") -> Estimate:
    """Return an estimate of which all inputs are known; twice as fast as the class."""
    return _new(Estimate, (p, p, reliability, mttf, (), reason))


def reader(names: Sequence[str]) -> Callable[[Values], tuple[object, ...]]:
    """Return what reads the values of some inputs as a tuple."""
    if len(names) == 1:
        (name,) = names
        return lambda values: (values[name],)
    return itemgetter(*names) if names else lambda _: ()


class Importance(NamedTuple):
    """How much one event matters for the top event, at present probabilities."""

    event: str  # its name
    probability: float  # of the event
    birnbaum: float  # p(top | event) - p(top | not event)
    criticality: float  # share of the top's probability in which the event decides
    achievement: float  # risk achievement worth: p(top | event) / p(top)
    reduction: float  # risk reduction worth: p(top) / p(top | not event)


class Component:
    """One model of a monitor; it is asked once a step, behind those that it uses."""

    grows: bool = True  # what lies ahead never gets less probable with the horizon
    latched: int = 0  # how often a claim was ignored that something failed works again
    # input id -> what is wrong with its value, since the monitor took this over
    said: Mapping[str, str] = NOTHING

    def report_fault(self, name: str, text: str) -> None:
        """Say what is wrong with the value of an input."""
        said: dict[str, str] = {**self.said, name: text}
        self.said = said

    def has_failed(
        self, name: str, now: bool | None, *, before: bool, repair: bool
    ) -> bool | None:
        """Return what an input says now, of which a failure stays one unless there is repair."""
        if not before or now or repair:
            return now
        if now is False:
            self.latched += 1
            self.report_fault(name, AGAIN)
        return True

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        """Let time pass, take the observations, look ahead."""
        raise NotImplementedError

    def doubt(self) -> str:
        """Return what was missed before and is still open, in words; empty for nothing."""
        return ""

    def importances(self) -> tuple[Importance, ...]:
        """Return how much each event of a fault tree matters now; empty for other models."""
        return ()

    def reset(self) -> None:
        """Return to the start of the mission."""
        self.latched, self.said = 0, NOTHING

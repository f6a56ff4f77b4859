"""What every model of a monitor can do, and what it reports in a step."""

from __future__ import annotations

from operator import itemgetter
from types import MappingProxyType
from typing import Any, Callable, Dict, Mapping, NamedTuple, Optional, Sequence, Tuple

Values = Mapping[str, Any]
"""Input id -> bool, float, list of them with None, or None where nothing is known."""

NAN = float("nan")
NOTHING: Mapping[str, str] = MappingProxyType({})
AGAIN = "it reports that a failed part works again; ignored without `repair: true`"


class Moment(NamedTuple):
    """When a step is.

    Attributes:
        quanta: how many quanta have passed since the last step.
        hours: the same in hours.
        age: hours since the first step.
        horizon: hours from now to the horizon.
        at: position of the horizon among those that were prepared.
    """

    quanta: int
    hours: float
    age: float
    horizon: float
    at: int


class Estimate(NamedTuple):
    """Probability of failure from now to the horizon.

    Attributes:
        low: in the best case of what is unknown, or was when it mattered.
        high: in the worst case; equal to ``low`` when nothing was missed.
        reliability: probability of no failure in the worst case.
        mttf: remaining mean time to failure in hours; NaN: not computed.
        unknown: inputs on which the result depends and that are not known.
        reason: why the result cannot be trusted for another reason; empty otherwise.
    """

    low: float
    high: float
    reliability: float
    mttf: float
    unknown: Tuple[str, ...] = ()
    reason: str = ""


Known = Mapping[str, Estimate]
"""Model -> what it reported in this step."""

_new = tuple.__new__


def sure(p: float, reliability: float, mttf: float, reason: str = "") -> Estimate:
    """Return an estimate of which all inputs are known; twice as fast as the class."""
    return _new(Estimate, (p, p, reliability, mttf, (), reason))


def reader(names: Sequence[str]) -> Callable[[Values], Tuple[object, ...]]:
    """Return what reads the values of some inputs as a tuple."""
    if len(names) == 1:
        (name,) = names
        return lambda values: (values[name],)
    return itemgetter(*names) if names else lambda _: ()


class Importance(NamedTuple):
    """How much one event matters for the top event, at present probabilities.

    Attributes:
        event: its name.
        probability: of the event.
        birnbaum: p(top | event) - p(top | not event).
        criticality: share of the top's probability in which the event decides.
        achievement: risk achievement worth: p(top | event) / p(top).
        reduction: risk reduction worth: p(top) / p(top | not event).
    """

    event: str
    probability: float
    birnbaum: float
    criticality: float
    achievement: float
    reduction: float


class Component:
    """One model of a monitor; it is asked once a step, behind those that it uses.

    Attributes:
        grows: what lies ahead never gets less probable with the horizon.
        latched: how often a claim was ignored that something failed works again.
        said: input id -> what is wrong with its value, since the monitor took this over.
    """

    grows: bool = True
    latched: int = 0
    said: Mapping[str, str] = NOTHING

    def report_fault(self, name: str, text: str) -> None:
        """Say what is wrong with the value of an input."""
        said: Dict[str, str] = {**self.said, name: text}
        self.said = said

    def has_failed(
        self, name: str, now: Optional[bool], *, before: bool, repair: bool
    ) -> Optional[bool]:
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

    def importances(self) -> Tuple[Importance, ...]:
        """Return how much each event of a fault tree matters now; empty for other models."""
        return ()

    def reset(self) -> None:
        """Return to the start of the mission."""
        self.latched, self.said = 0, NOTHING

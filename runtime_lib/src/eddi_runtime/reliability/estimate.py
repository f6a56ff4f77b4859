"""Result of each model in a step, and the time of the step."""

from __future__ import annotations

from typing import Any, Mapping, NamedTuple, Tuple

Values = Mapping[str, Any]
"""Input id -> bool, float, list of them with None, or None where nothing is known."""


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


def known(p: float, reliability: float, mttf: float, reason: str = "") -> Estimate:
    """Return an estimate of which all inputs are known; twice as fast as the class."""
    return _new(Estimate, (p, p, reliability, mttf, (), reason))


_new = tuple.__new__

"""What a step of a reliability monitor gives."""

from __future__ import annotations

from typing import Mapping, NamedTuple


class ReliabilityResult(NamedTuple):
    """The reliability over the horizon."""

    valid: bool  # everything on which the result depends is known, and no error occurred
    # probability of failure from now to the horizon; the worst case of what is unknown, and of
    # what was missed before
    p_fail: float
    p_fail_low: float  # in the best case of that
    p_fail_high: float  # in the worst case
    reliability: float  # probability of no failure from now to the horizon
    mttf: float  # remaining mean time to failure in hours; inf; NaN: not computed
    horizon: float  # hours from now
    evidence: Mapping[str, bool]  # id of a threshold -> active
    unknown: tuple[str, ...]  # inputs that are not known
    # why the result is not valid; of a valid one, what was missed before and is still open, so
    # that the bounds differ
    reason: str
    contributions: Mapping[str, float]  # model -> its p_fail_high

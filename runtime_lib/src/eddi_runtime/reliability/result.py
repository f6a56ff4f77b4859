"""What a step of a reliability monitor gives."""

from __future__ import annotations

from typing import Mapping, NamedTuple, Tuple


class ReliabilityResult(NamedTuple):
    """The reliability over the horizon.

    Attributes:
        valid: everything on which the result depends is known, and no error occurred.
        p_fail: probability of failure from now to the horizon; the worst case of what is unknown,
            and of what was missed before.
        p_fail_low: in the best case of that.
        p_fail_high: in the worst case.
        reliability: probability of no failure from now to the horizon.
        mttf: remaining mean time to failure in hours; inf; NaN: not computed.
        horizon: hours from now.
        evidence: id of a threshold -> active.
        unknown: inputs that are not known.
        reason: why the result is not valid; of a valid one, what was missed before and is still
            open, so that the bounds differ.
        contributions: model -> its p_fail_high.
    """

    valid: bool
    p_fail: float
    p_fail_low: float
    p_fail_high: float
    reliability: float
    mttf: float
    horizon: float
    evidence: Mapping[str, bool]
    unknown: Tuple[str, ...]
    reason: str
    contributions: Mapping[str, float]

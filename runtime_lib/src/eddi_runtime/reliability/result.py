"""Result of a step, and its form for programs, plots and ROS."""

from __future__ import annotations

import math
from typing import Dict, List, Mapping, NamedTuple, Sequence, Tuple, Union

from ..monitor import Field, Json, Tree

Value = Union[bool, float, str, None]


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
        reason: why the result is not valid; empty when it is.
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


_NUMBERS = ("p_fail", "p_fail_low", "p_fail_high", "reliability", "mttf")


def as_json(result: ReliabilityResult) -> Dict[str, Json]:
    """Return a result as ``json`` can write it; what is not finite becomes None."""
    numbers = {name: _finite(getattr(result, name)) for name in _NUMBERS}
    return {
        "valid": result.valid,
        **numbers,
        "horizon": result.horizon,
        "evidence": dict(result.evidence),
        "unknown": list(result.unknown),
        "reason": result.reason,
        "contributions": {k: _finite(v) for k, v in result.contributions.items()},
    }


def series(result: ReliabilityResult) -> Dict[str, Value]:
    """Return the values that a plot shows."""
    numbers: Dict[str, Value] = {name: _finite(getattr(result, name)) for name in _NUMBERS}
    return {**numbers, "valid": result.valid, **result.evidence}


def output_message(model: str, result: ReliabilityResult, accepted: Sequence[str]) -> Tree:
    """Return a result as a ``ReliabilityOutput`` tree without header.

    Args:
        model: its id.
        result: of the last step.
        accepted: acceptances in use.
    """
    evidence: List[Tree] = [
        ("ReliabilityEvidence", {"id": name, "active": active})
        for name, active in result.evidence.items()
    ]
    fields: Dict[str, Field] = {
        "model": model,
        "valid": result.valid,
        "p_fail": result.p_fail,
        "p_fail_low": result.p_fail_low,
        "p_fail_high": result.p_fail_high,
        "reliability": result.reliability,
        "mttf_hours": result.mttf,
        "horizon_seconds": result.horizon * 3600.0,
        "unknown_inputs": list(result.unknown),
        "reason": result.reason,
        "evidence": evidence,
        "accepted": list(accepted),
    }
    return "ReliabilityOutput", fields


def _finite(value: float) -> Union[float, None]:
    return value if math.isfinite(value) else None

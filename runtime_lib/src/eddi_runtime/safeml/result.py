"""What a step of a SafeML monitor gives, and its messages."""

from __future__ import annotations

import math
from typing import Any, Dict, List, NamedTuple, Sequence, Tuple, Union

from ..monitor import Tree

FILLING = "filling"
STALE = "stale"
OMITTED = -1
"""Index of no test."""


class SafeMLResult(NamedTuple):
    """The verdict of one step. Numbers that do not exist are NaN.

    Attributes:
        omission: there is no verdict now: the window is not full, or an input was not usable.
        odd_violation: some distance is significant; while ``omission``, the last verdict.
        significance_level: probability of a false violation in one step.
        statistic: the largest distance of all tests (D for Kolmogorov-Smirnov).
        threshold: from which on it is a violation.
        threshold_theoretical: the same for independent samples.
        component: index of the test with the largest distance; -1 while ``omission``.
        p_value_bound: bound on its probability in all tests, asymptotic and for independent
            samples: for information only.
        accepted: samples so far that could be used.
        rejected: samples so far that could not.
        reason: of the omission: ``filling``, ``empty``, ``not_finite``, ``wrong_length`` or
            ``stale``; empty when there is a verdict.
    """

    omission: bool
    odd_violation: bool
    significance_level: float
    statistic: float
    threshold: float
    threshold_theoretical: float
    component: int
    p_value_bound: float
    accepted: int
    rejected: int
    reason: str = ""


class OneTest(NamedTuple):
    """One test of the last verdict.

    Attributes:
        test: index.
        label: ``feature 3``, ``component 0`` or ``residual``.
        statistic: distance of window and reference.
        threshold: from which on it is a violation.
        violated: whether it is reached.
        p_value: asymptotic, for this test alone and independent samples.
        weights: of a component: the features that weigh most in it, with their weights.
    """

    test: int
    label: str
    statistic: float
    threshold: float
    violated: bool
    p_value: float
    weights: Tuple[Tuple[int, float], ...] = ()

    def __str__(self) -> str:
        """Return one line for people."""
        relation = ">=" if self.violated else "<"
        features = ", ".join(f"feature {k} ({weight:+.2f})" for k, weight in self.weights)
        mostly = f"; mostly {features}" if features else ""
        return (
            f"{self.label}: distance {self.statistic:.4g} {relation} threshold "
            f"{self.threshold:.4g}, p {self.p_value:.2g}{mostly}"
        )


def as_json(result: SafeMLResult) -> Dict[str, Union[bool, int, float, str, None]]:
    """Return a result as ``json`` can write it; NaN becomes None."""
    return {
        name: None if isinstance(value, float) and not math.isfinite(value) else value
        for name, value in result._asdict().items()
    }


def series(result: SafeMLResult) -> Dict[str, Union[bool, float, str, None]]:
    """Return the values that a plot shows."""
    known = as_json(result)
    names = ("statistic", "threshold", "odd_violation", "omission")
    return {name: known[name] for name in names}


def output_message(result: Any, significance_level: float) -> Tuple[Tree, List[str]]:
    """Return the ``SafeMLOutput`` tree and what was wrong with a result; never raises.

    What is no result is published as an omission.
    """
    omission = getattr(result, "omission", None)
    violation = getattr(result, "odd_violation", None)
    faults = []
    if not isinstance(omission, bool) or not isinstance(violation, bool):
        faults.append("the output has no Booleans omission and odd_violation; it is an omission")
        omission, violation = True, violation is True
    fields = {
        "omission": omission,
        "odd_violation": violation,
        "significance_level": significance_level,
    }
    return ("SafeMLOutput", fields), faults


def status_message(
    result: SafeMLResult,
    metric: str,
    filled: int,
    window_size: int,
    *,
    held: bool,
    acceptances: Sequence[str],
) -> Tree:
    """Return the facts behind a result as a ``SafeMLStatus`` tree without header.

    Args:
        result: of the last step.
        metric: its name in the configuration.
        filled: samples in the window.
        window_size: samples in a full one.
        held: ``odd_violation`` is the verdict of a former step.
        acceptances: in use, as ``input: key``.
    """
    fields = {
        "omission": result.omission,
        "odd_violation": result.odd_violation,
        "held": held,
        "metric": metric,
        "statistic": result.statistic,
        "threshold": result.threshold,
        "threshold_theoretical": result.threshold_theoretical,
        "component": result.component,
        "p_value_bound": result.p_value_bound,
        "accepted": result.accepted,
        "rejected": result.rejected,
        "filled": filled,
        "window_size": window_size,
        "reason": result.reason,
        "in_scope": not result.omission and not result.odd_violation,
        "acceptances": list(acceptances),
    }
    return "SafeMLStatus", fields

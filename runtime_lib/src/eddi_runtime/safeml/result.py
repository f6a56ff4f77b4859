"""What a step of a SafeML monitor gives."""

from __future__ import annotations

from typing import NamedTuple, Tuple

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

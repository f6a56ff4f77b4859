"""What a step of a SafeML monitor gives."""

from __future__ import annotations

from typing import NamedTuple

FILLING = "filling"
STALE = "stale"
OMITTED = -1
"""Index of no test."""


class SafeMLResult(NamedTuple):
    """The verdict of one step. Numbers that do not exist are NaN."""

    omission: bool  # there is no verdict now: the window is not full, or an input was not usable
    odd_violation: bool  # some distance is significant; while ``omission``, the last verdict
    significance_level: float  # probability of a false violation in one step
    statistic: float  # the largest distance of all tests (D for Kolmogorov-Smirnov)
    threshold: float  # from which on it is a violation
    threshold_theoretical: float  # the same for independent samples
    component: int  # index of the test with the largest distance; -1 while ``omission``
    # bound on its probability in all tests, asymptotic and for independent samples: for
    # information only
    p_value_bound: float
    accepted: int  # samples so far that could be used
    rejected: int  # samples so far that could not
    # of the omission: ``filling``, ``empty``, ``not_finite``, ``wrong_length`` or ``stale``; empty
    # when there is a verdict
    reason: str = ""


class OneTest(NamedTuple):
    """One test of the last verdict."""

    test: int  # index
    label: str  # ``feature 3``, ``component 0`` or ``residual``
    statistic: float  # distance of window and reference
    threshold: float  # from which on it is a violation
    violated: bool  # whether it is reached
    p_value: float  # asymptotic, for this test alone and independent samples
    # of a component: the features that weigh most in it, with their weights
    weights: tuple[tuple[int, float], ...] = ()

    def __str__(self) -> str:
        """Return one line for people."""
        relation = ">=" if self.violated else "<"
        features = ", ".join(f"feature {k} ({weight:+.2f})" for k, weight in self.weights)
        mostly = f"; mostly {features}" if features else ""
        return (
            f"{self.label}: distance {self.statistic:.4g} {relation} threshold "
            f"{self.threshold:.4g}, p {self.p_value:.2g}{mostly}"
        )

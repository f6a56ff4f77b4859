"""Dynamic reliability: Markov chains and fault trees that follow what is observed (D7.2 3.3)."""

from ..thresholds import Threshold
from .component import Explanation, Importance, ReliabilityResult, Rule
from .monitor import Reliability

FORMAT = 2

__all__ = [
    "FORMAT", "Explanation", "Importance", "Reliability", "ReliabilityResult", "Rule",
    "Threshold",
]  # fmt: skip

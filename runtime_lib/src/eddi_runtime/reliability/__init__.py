"""Dynamic reliability: Markov chains and fault trees that follow what is observed (D7.2 3.3)."""

from ..thresholds import Threshold
from .component import Importance, ReliabilityResult, Rule
from .monitor import Reliability

FORMAT = 3

__all__ = ["FORMAT", "Importance", "Reliability", "ReliabilityResult", "Rule", "Threshold"]

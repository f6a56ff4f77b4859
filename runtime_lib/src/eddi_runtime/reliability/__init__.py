"""Dynamic reliability: Markov chains and fault trees that follow what is observed (D7.2 3.3)."""

from .explain import Explanation
from .monitor import ReliabilityMonitor, build
from .result import ReliabilityResult
from .tree import Importance

__all__ = ["Explanation", "Importance", "ReliabilityMonitor", "ReliabilityResult", "build"]

"""SafeML: does the running window of inputs still look like its reference? (SESAME D7.2 3.4)."""

from .comparison import Comparison
from .monitor import SafeMLMonitor, build
from .result import OneTest, SafeMLResult

__all__ = ["Comparison", "OneTest", "SafeMLMonitor", "SafeMLResult", "build"]

"""SafeML: does the running window of inputs still look like its reference? (SESAME D7.2 3.4)."""

from .arrays import Axes, Table
from .comparison import Interpolated, Kolmogorov
from .monitor import OneTest, SafeML, SafeMLResult

FORMAT = 1

__all__ = [
    "FORMAT", "Axes", "Interpolated", "Kolmogorov", "OneTest", "SafeML", "SafeMLResult", "Table",
]  # fmt: skip

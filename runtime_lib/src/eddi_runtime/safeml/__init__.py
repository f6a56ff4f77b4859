"""SafeML: does the running window of inputs still look like its reference? (SESAME D7.2 3.4)."""

from .arrays import Axes, Table
from .monitor import OneTest, SafeML, SafeMLResult
from .statistics import Interpolated, Kolmogorov

FORMAT = 1

__all__ = [
    "FORMAT", "Axes", "Interpolated", "Kolmogorov", "OneTest", "SafeML", "SafeMLResult", "Table",
]  # fmt: skip

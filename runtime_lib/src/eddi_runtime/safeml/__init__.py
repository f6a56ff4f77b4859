"""SafeML: does the running window of inputs still look like its reference? (SESAME D7.2 3.4)."""

from .arrays import Axes, Table
from .comparison import Interpolated, Kolmogorov
from .monitor import SafeML, SafeMLResult

FORMAT = 1

__all__ = [
    "FORMAT", "Axes", "Interpolated", "Kolmogorov", "SafeML", "SafeMLResult", "Table",
]  # fmt: skip

"""ConSerts: conditional safety certificates, evaluated at run time (SESAME D7.2 section 3.1)."""

from .monitor import ConSert
from .verdicts import Binary, Categorical, Explanation, Guarantee, Numeric

FORMAT = 3

__all__ = [
    "FORMAT", "Binary", "Categorical", "ConSert", "Explanation", "Guarantee", "Numeric",
]  # fmt: skip

"""ConSerts: conditional safety certificates, evaluated at run time (SESAME D7.2 section 3.1)."""

from .explain import Explanation, Guarantee, Reason
from .monitor import ConSert
from .values import Binary, Categorical, Numeric

FORMAT = 3

__all__ = [
    "FORMAT",
    "Binary",
    "Categorical",
    "ConSert",
    "Explanation",
    "Guarantee",
    "Numeric",
    "Reason",
]

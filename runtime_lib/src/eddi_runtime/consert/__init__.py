"""ConSerts: conditional safety certificates, evaluated at run time (SESAME D7.2 section 3.1)."""

from .explain import Explanation, Reason
from .monitor import ConSert, Guarantee
from .values import Binary, Categorical, Numeric

FORMATS = (2,)

__all__ = [
    "FORMATS",
    "Binary",
    "Categorical",
    "ConSert",
    "Explanation",
    "Guarantee",
    "Numeric",
    "Reason",
]

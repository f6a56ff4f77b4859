"""ConSerts: conditional safety certificates, evaluated at run time (SESAME D7.2 section 3.1)."""

from .explain import Explanation, Reason
from .filters import Debounce, Majority
from .monitor import ConSert, Guarantee
from .values import Binary, Categorical, Numeric

FORMATS = (1,)

__all__ = [
    "FORMATS",
    "Binary",
    "Categorical",
    "ConSert",
    "Debounce",
    "Explanation",
    "Guarantee",
    "Majority",
    "Numeric",
    "Reason",
]

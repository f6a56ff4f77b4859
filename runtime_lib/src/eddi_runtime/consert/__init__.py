"""ConSerts: conditional safety certificates, evaluated at run time (SESAME D7.2 section 3.1)."""

from .explain import Explanation, Reason
from .monitor import ConSertMonitor, build

__all__ = ["ConSertMonitor", "Explanation", "Reason", "build"]

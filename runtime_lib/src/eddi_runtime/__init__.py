"""Runtime monitors generated from Executable Digital Dependability Identities (SESAME D7.2).

``load("config/model.json")`` compiles a model and returns its monitor; ``execute_step`` evaluates
it once. Pure Python 3.8; only the parts below ``eddi_runtime.transports`` know ROS.
"""

from .access import by_id, by_key, by_name, joined
from .compatibility import needs
from .documents import ModelError
from .inputs import EDDIInputBase, InputSpec, InputState
from .monitor import Monitor, load
from .version import __version__

FORMATS = (1,)
"""Formats of compiled monitors that the core of this runtime runs."""

__all__ = [
    "FORMATS",
    "EDDIInputBase",
    "InputSpec",
    "InputState",
    "ModelError",
    "Monitor",
    "__version__",
    "by_id",
    "by_key",
    "by_name",
    "joined",
    "load",
    "needs",
]

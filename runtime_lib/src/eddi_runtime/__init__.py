"""Runtime monitors of Executable Digital Dependability Identities (SESAME D7.2).

``compiled.py`` of a package inherits from the part of its kind; ``execute_step`` evaluates once.
Pure Python 3.8; only what is below ``eddi_runtime.transports`` knows ROS.
"""

from .inputs import EDDIInputBase, InputSpec, InputState, look_again
from .monitor import ModelError, Monitor, __version__, needs
from .plain_values import by_id, by_key, by_name, given, joined

FORMAT = 1
"""Of compiled monitors that the core of this runtime runs."""

__all__ = [
    "FORMAT", "EDDIInputBase", "InputSpec", "InputState", "ModelError", "Monitor", "__version__",
    "by_id", "by_key", "by_name", "given", "joined", "look_again", "needs",
]  # fmt: skip

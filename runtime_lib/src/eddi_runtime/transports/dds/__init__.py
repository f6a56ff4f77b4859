"""DDS adapter of the runtime: the only part that imports cyclonedds (Python 3.10 or newer)."""

from ...node.start import reported
from ...node.topics import Input, Output
from .messages import message_classes
from .node import MonitorNode

__all__ = ["Input", "MonitorNode", "Output", "message_classes", "reported"]

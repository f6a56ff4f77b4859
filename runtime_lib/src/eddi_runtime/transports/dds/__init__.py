"""DDS adapter of the runtime: the only part that imports cyclonedds (Python 3.10 or newer)."""

from ...node.outputs import Output
from ...node.receipts import Input
from ...node.start import reported
from .messages import message_classes
from .node import MonitorNode

__all__ = ["Input", "MonitorNode", "Output", "message_classes", "reported"]

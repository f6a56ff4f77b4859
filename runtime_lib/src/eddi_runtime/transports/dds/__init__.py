"""DDS adapter of the runtime: monitors that join a ROS 2 graph by themselves.

The only part of the runtime that imports cyclonedds, which needs Python 3.10 or newer.
"""

from ...node.outputs import Output
from ...node.receipts import Input
from ...node.start import reported
from .messages import message_classes
from .node import MonitorNode

__all__ = ["Input", "MonitorNode", "Output", "message_classes", "reported"]

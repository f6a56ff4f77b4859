"""Where generated nodes find the ROS 1 adapter, also those of earlier releases."""

from .node.outputs import Output
from .node.receipts import Input
from .node.start import reported
from .transports.ros1.node import MonitorNode

__all__ = ["Input", "MonitorNode", "Output", "reported"]

"""ROS 1 adapter of the runtime: the only part of it that imports rospy."""

from ...node.outputs import Output
from ...node.receipts import Input
from ...node.start import reported
from .node import MonitorNode

__all__ = ["Input", "MonitorNode", "Output", "reported"]

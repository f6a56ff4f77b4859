"""ROS 1 adapter of the runtime: the only part of it that imports rospy."""

from ...node.start import reported
from ...node.topics import Input, Output
from .node import MonitorNode

__all__ = ["Input", "MonitorNode", "Output", "reported"]

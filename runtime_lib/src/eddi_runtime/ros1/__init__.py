"""ROS 1 adapter of the runtime: the only part of it that imports rospy."""

from .node import MonitorNode
from .topics import Input, Output

__all__ = ["Input", "MonitorNode", "Output"]

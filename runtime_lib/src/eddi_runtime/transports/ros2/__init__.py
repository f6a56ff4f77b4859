"""ROS 2 adapter of the runtime: the only part of it that imports rclpy (Humble or newer)."""

import rclpy  # noqa: F401 - first: of all that may be missing, this tells most

from ...node.topics import Input, Output
from .node import MonitorNode

__all__ = ["Input", "MonitorNode", "Output"]

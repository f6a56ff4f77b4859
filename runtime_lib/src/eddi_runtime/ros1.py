"""Where generated nodes find the ROS 1 adapter, also those of earlier releases."""

from .transports.ros1 import Input, MonitorNode, Output, reported

__all__ = ["Input", "MonitorNode", "Output", "reported"]

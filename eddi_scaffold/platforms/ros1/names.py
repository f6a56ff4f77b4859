"""Package names that would break a ROS 1 workspace."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import rospkg

from eddi_scaffold.ros import package_names

METAPACKAGE = "eddi_monitor"
_IMPORTED_BY_ROSPY = (
    "catkin", "catkin_pkg", "defusedxml", "diagnostic_msgs", "genmsg", "genpy", "numpy", "rosclean",
    "rosgraph", "rosgraph_msgs", "roscpp", "roslaunch", "roslib", "roslz4", "rosmaster", "rosnode",
    "rospkg", "rospy", "rosservice", "rostopic", "setuptools", "std_msgs", "std_srvs", "yaml",
)  # fmt: skip


def taken_names(root: Path | None) -> Mapping[str, str]:
    """Return package names that must not be used, with the reason."""
    return package_names.taken_names(
        root, rospkg.get_ros_paths(), "CATKIN_IGNORE", _IMPORTED_BY_ROSPY, [METAPACKAGE]
    )

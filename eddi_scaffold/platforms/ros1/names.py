"""Package names that would break a ROS 1 workspace.

A package name is also a top-level Python module of every node, and ``PYTHONPATH`` comes before the
standard library: a monitor called ``json`` stops every Python node of the workspace.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path

import rospkg

from eddi_scaffold.identifiers import RESERVED

OWN = ("eddi_monitor", "eddi_messages", "eddi_monitor_launcher", "eddi_runtime")
_IMPORTED_BY_ROSPY = (
    "catkin", "catkin_pkg", "defusedxml", "diagnostic_msgs", "genmsg", "genpy", "numpy", "rosclean",
    "rosgraph", "rosgraph_msgs", "roscpp", "roslaunch", "roslib", "roslz4", "rosmaster", "rosnode",
    "rospkg", "rospy", "rosservice", "rostopic", "setuptools", "std_msgs", "std_srvs", "yaml",
)  # fmt: skip


def taken_names(root: Path) -> Mapping[str, str]:
    """Return package names that must not be used, with the reason.

    Packages of the ROS environment (``ROS_PACKAGE_PATH``) and of the workspace count, those below
    ``root`` do not: they are our own.
    """
    found = rospkg.RosPack([*rospkg.get_ros_paths(), str(root.parent)])
    places = {name: Path(found.get_path(name)).resolve() for name in found.list()}
    taken = {
        name: f"the ROS package {name} is in {place}"
        for name, place in places.items()
        if not place.is_relative_to(root.resolve())
    }
    taken |= dict.fromkeys(
        sys.stdlib_module_names, "it would hide a module of Python's standard library"
    )
    taken.update(
        dict.fromkeys(_IMPORTED_BY_ROSPY, "it would hide a module that every ROS node imports")
    )
    taken.update(dict.fromkeys(RESERVED, "it is a word of Python"))
    taken.update(dict.fromkeys(OWN, "eddi-scaffold generates a package of this name itself"))
    return taken

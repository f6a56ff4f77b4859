"""Lets the log of the process write by rospy.

Every ``rospy.log*`` asks the ROS master for a parameter before it writes (ros_comm 1.15.15, unless
that parameter is set), and writes to a pipe that roslaunch has to read.
"""

from typing import Any

import rospy
import rospy.impl.paramserver

from ...node.logs import LOG

_ROSOUT_SWITCH = "/rosout_disable_topics_generation"


def start_log() -> None:
    """Begin to write; ``rospy.init_node`` has been called."""
    # With a value in rospy's cache the log works without the master, and is faster.
    cache: Any = rospy.impl.paramserver.get_param_server_cache()
    cache.set(_ROSOUT_SWITCH, bool(rospy.get_param(_ROSOUT_SWITCH, default=False)))
    LOG.start({"info": rospy.loginfo, "warn": rospy.logwarn, "error": rospy.logerr})

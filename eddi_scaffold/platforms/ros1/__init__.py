"""ROS 1: catkin packages below ``src/eddi_monitor`` of a workspace."""

from eddi_scaffold.platforms import Platform
from eddi_scaffold.platforms.ros1.answers import monitor_answers, support_answers
from eddi_scaffold.platforms.ros1.names import taken_names

PLATFORM = Platform(
    name="ros1",
    root="src/eddi_monitor",
    needs_config=True,
    monitor=monitor_answers,
    support=support_answers,
    taken_names=taken_names,
)

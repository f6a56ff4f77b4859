"""What the packages of a ROS 1 workspace are rendered from."""

from eddi_scaffold.platforms import Templates

MONITOR = "ros1_monitor"
MESSAGES = "ros1_messages"
METAPACKAGE = "ros1_metapackage"
LAUNCHER = "ros1_launcher"
RUNTIME = "ros1_runtime"

ALL = Templates(MONITOR, (MESSAGES, METAPACKAGE, LAUNCHER, RUNTIME))

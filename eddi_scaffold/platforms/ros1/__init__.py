"""ROS 1: catkin packages below ``src/eddi_monitor`` of a workspace."""

from collections.abc import Sequence
from pathlib import Path
from shlex import quote

from eddi_scaffold.platforms import Platform, Workspace
from eddi_scaffold.platforms.ros1 import templates
from eddi_scaffold.platforms.ros1.names import LAUNCHER, taken_names
from eddi_scaffold.platforms.ros1.package_answers import monitor_answers, support_answers


def _next_steps(place: Path, _monitors: Sequence[str]) -> Sequence[str]:
    return [
        f"cd {quote(str(place))} && catkin_make -DPYTHON_EXECUTABLE=/usr/bin/python3",
        "source devel/setup.bash",
        f"roslaunch {LAUNCHER} eddi.launch",
    ]


PLATFORM = Platform(
    name="ros1",
    templates=templates.ALL,
    workspace=Workspace("catkin workspace", "src/eddi_monitor"),
    needs_config=True,
    monitor=monitor_answers,
    support=support_answers,
    taken_names=taken_names,
    next_steps=_next_steps,
)

"""Messages of the ROS packages on this machine: they serve checks, never what is generated.

The contents of a package must not depend on the machine that generated it.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import rospkg

from eddi_scaffold.common.files import read_regular
from eddi_scaffold.config.field_types import Fields, fields_of

_PARTS = (
    "Action", "ActionFeedback", "ActionGoal", "ActionResult", "Feedback", "Goal", "Result",
)  # fmt: skip
"""What the name of an action becomes in those of its messages."""


@cache
def installed_message(name: str) -> Fields | None:
    """Return the fields of ``package/Type``; ``None`` when this machine does not have it.

    Debian keeps ``.msg`` files apart from the ``package.xml`` by which rospkg finds a package, so
    the folders of the ROS path are looked into as well.
    """
    package, _, message = name.partition("/")
    for folder in _folders(package):
        file = folder / "msg" / f"{message}.msg"
        try:
            return fields_of(read_regular(file).decode("utf-8", "replace"), package)
        except OSError:
            continue
    return None


@cache
def installed_types(package: str) -> frozenset[str]:
    """Return the message types of a package, also of its actions; none where it is not installed.

    The first folder with messages counts: it is the one that Python would import.
    """
    for folder in _folders(package):
        try:
            names = {file.stem for file in folder.glob("msg/*.msg")}
            actions = [file.stem for file in folder.glob("action/*.action")]
        except OSError:  # no file can have such a name
            continue
        names |= {f"{action}{part}" for action in actions for part in _PARTS}
        if names:
            return frozenset(f"{package}/{name}" for name in names)
    return frozenset()


@cache
def _folders(package: str) -> tuple[Path, ...]:
    paths = [Path(path) for path in rospkg.get_ros_paths()]
    try:
        own = [Path(_packages().get_path(package))]
    except rospkg.ResourceNotFound:
        own = []
    return (*own, *(path / package for path in [*paths, Path("/usr/share")]))


@cache
def _packages() -> rospkg.RosPack:
    return rospkg.RosPack()

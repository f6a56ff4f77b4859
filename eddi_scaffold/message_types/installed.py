"""Messages of the ROS packages on this machine: they serve checks, never what is generated.

What stands in a package must not depend on the machine that made it.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import rospkg

from eddi_scaffold.message_types.definitions import Fields, fields_of


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
            return fields_of(file.read_text("utf-8", "replace"), package)
        except OSError:
            continue
    return None


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

"""The message types that are known: names of fields with their types.

The common messages travel with eddi-scaffold, so that the same configuration gives the same package
on a machine with ROS and on one without.
"""

from __future__ import annotations

from contextlib import suppress
from functools import cache
from importlib.resources import files
from pathlib import Path

import rospkg

from eddi_scaffold.common.files import read_regular
from eddi_scaffold.common.toml_tables import read_toml
from eddi_scaffold.config.field_types import TIMES, Fields, MessageFields, element, fields_of
from eddi_scaffold.kinds import texts_of_messages


@cache
def common_messages() -> MessageFields:
    """Return message type -> fields of std_msgs, common_msgs and geometry2 of ROS 1."""
    lines = (files(__package__) / "common.txt").read_text("utf-8").splitlines()
    messages: dict[str, Fields] = {}
    for line in lines:
        if line and not line.startswith("#"):
            name, _, text = line.partition(":")
            pairs = (part.split() for part in text.split(",") if part.strip())
            messages[name] = {field: of for of, field in pairs}
    return messages


@cache
def known_messages() -> MessageFields:
    """Return the fields of the common messages of ROS 1 and of our own ``eddi_messages``."""
    own = {
        f"eddi_messages/{name}": fields_of(text, "eddi_messages")
        for name, text in texts_of_messages().items()
    }
    return {**TIMES, **common_messages(), **own}


_WORDS = {"time": "builtin_interfaces/Time", "duration": "builtin_interfaces/Duration"}


def ros2_messages(known: dict[str, Fields]) -> dict[str, Fields]:
    """Return message types as ROS 2 has them, of those of ROS 1; some it does not have."""
    table = read_toml(Path(__file__).with_name("ros2.toml"))
    messages: dict[str, Fields] = dict(table["changed"])
    for name, fields in known.items():
        if name not in (*messages, *TIMES) and not name.startswith(tuple(table["gone"])):
            is_lower = name in table["lower_case"]
            renamed = {f.lower() if is_lower else f: of for f, of in fields.items()}
            messages[name] = ros2_fields(renamed)
    return messages


def ros2_fields(fields: Fields) -> dict[str, str]:
    """Return fields with the times of ROS 2."""
    items = {name: element(of) or of for name, of in fields.items()}
    return {
        name: _WORDS.get(items[name], items[name]) + of[len(items[name]) :]
        for name, of in fields.items()
    }


_packages = cache(rospkg.RosPack)


@cache
def installed_message(name: str) -> Fields | None:
    """Return the fields of ``package/Type``; ``None`` when this machine does not have it."""
    package, _, message = name.partition("/")
    # Debian keeps `.msg` files apart from the `package.xml` by which rospkg finds a package
    folders = [Path(path, package) for path in (*rospkg.get_ros_paths(), "/usr/share")]
    with suppress(rospkg.ResourceNotFound):
        folders.insert(0, Path(_packages().get_path(package)))
    for folder in folders:
        with suppress(OSError):
            text = read_regular(folder / "msg" / f"{message}.msg").decode("utf-8", "replace")
            return fields_of(text, package)
    return None

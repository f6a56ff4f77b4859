"""The common messages of ROS 1, from a table that travels with eddi-scaffold.

So the same configuration gives the same package on a machine with ROS and on one without.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib.resources import files

from eddi_scaffold.config.message_types.definitions import Fields


@cache
def common_messages() -> Mapping[str, Fields]:
    """Return message type -> fields of std_msgs, common_msgs and geometry2."""
    text = (files(__package__) / "common.txt").read_text("utf-8")
    return dict(_read(line) for line in text.splitlines() if line and not line.startswith("#"))


def line_of(name: str, fields: Fields) -> str:
    """Return the line of the table for one message."""
    return f"{name}: {', '.join(f'{of} {field}' for field, of in fields.items())}".rstrip()


def _read(line: str) -> tuple[str, Fields]:
    name, _, text = line.partition(":")
    pairs = (part.split() for part in text.split(",") if part.strip())
    return name, {field: of for of, field in pairs}

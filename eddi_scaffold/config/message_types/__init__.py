"""Message types of a configuration: which fields they have."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache

from eddi_scaffold.config.message_types.common import common_messages
from eddi_scaffold.config.message_types.definitions import (
    EITHER_TIMES,
    TIMES,
    Fields,
    declared,
    element,
    fields_of,
    is_primitive,
    packages_of,
    python_type,
)
from eddi_scaffold.kinds import kinds

__all__ = [
    "EITHER_TIMES",
    "TIMES",
    "Fields",
    "MessageFields",
    "declared",
    "element",
    "fields_of",
    "is_primitive",
    "known_messages",
    "packages_of",
    "python_type",
    "used",
]

MessageFields = Mapping[str, Fields]
"""Message type (``std_msgs/Bool``) -> field -> type as in a ``.msg`` file."""


@cache
def known_messages() -> MessageFields:
    """Return the fields of the common messages of ROS 1 and of our own ``eddi_messages``."""
    own = {
        f"eddi_messages/{name}": fields_of(text, "eddi_messages")
        for kind in kinds().values()
        for name, text in kind.all_messages.items()
    }
    return {**TIMES, **common_messages(), **own}


def used(types: Iterable[str], known: MessageFields) -> dict[str, dict[str, str]]:
    """Return those of the known messages that are needed to follow any path into some types."""
    found: dict[str, dict[str, str]] = {}
    waiting = list(types)
    while waiting:
        name = waiting.pop()
        name = element(name) or name
        if name in known and name not in found:
            found[name] = dict(known[name])
            waiting += known[name].values()
    return dict(sorted(found.items()))

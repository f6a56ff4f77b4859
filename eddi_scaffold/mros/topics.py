"""From the name of an interface and its namespace to the topic that a running system has.

Rules of graph resource names in ROS 1, with what real models need in addition.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

_ILLEGAL = re.compile(r"[^A-Za-z0-9_/]")


TopicKind = Literal["published", "action", "subscribed"]


@dataclass(frozen=True)
class Topic:
    """One entry of ``SimulatorOutputs``.

    Attributes:
        id: a Python name.
        type: ``package.Type``.
        topic: absolute name.
        components: who provides it (or, of kind ``subscribed``, who waits for it).
        file: of the system that names it first.
        line: of the interface there, or of its component.
        deadlines: of those who publish it, as they are written; empty for none.
    """

    id: str
    type: str
    topic: str
    kind: TopicKind
    components: tuple[str, ...]
    file: str
    line: int
    deadlines: tuple[str, ...] = ()


@dataclass(frozen=True)
class TopicName:
    """A topic.

    Attributes:
        text: absolute name; ``/`` when nothing is left of it.
        glued: the relative name began with the namespace without a ``/`` between.
    """

    text: str
    glued: bool = False

    @property
    def is_empty(self) -> bool:
        """Whether nothing but ``/`` is left."""
        return self.text == "/"

    @property
    def illegal(self) -> str:
        """The characters that no ROS name may have."""
        return "".join(sorted(set(_ILLEGAL.findall(self.text))))


def topic_name(name: str, namespace: str | None, component: str) -> TopicName:
    """Resolve a name as ROS does.

    Args:
        name: absolute (``/x``), private (``~x``) or relative.
        namespace: of the interface, else of its component.
        component: name of the component; its last segment is the name of the node.

    A relative name that already begins with the namespace and a ``/`` is not given it twice.
    """
    space = (namespace or "").strip("/")
    if name.startswith("~"):
        node = component.rstrip("/").rpartition("/")[2]
        return TopicName(_joined(space, node, name[1:]))
    if name.startswith("/"):
        return TopicName(_joined(name))
    carries = bool(space) and (name == space or name.startswith(f"{space}/"))
    if carries:
        return TopicName(_joined(name))
    glued = bool(space) and name.startswith(space)
    return TopicName(_joined(space, name), glued)


def _joined(*parts: str) -> str:
    return "/" + "/".join(part for part in "/".join(parts).split("/") if part)


_NAME = r"[A-Za-z][A-Za-z0-9_]*"
_TYPE = re.compile(rf"({_NAME})(?:\.|/(?:(?:msg|srv|action)/)?)({_NAME})")


def type_of(written: str) -> tuple[str, str] | None:
    """Return package and name of a type; ``None`` when it is none."""
    match = _TYPE.fullmatch(written)
    return (match[1], match[2]) if match else None

"""To which robot a topic belongs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from eddi_scaffold.problems import EddiError, error

BESIDE = ("status", "evidence")
"""Last parts of the topics beside that of a result."""


def base_topic(topic: str) -> str:
    """Return the topic of the result, of one that is beside it."""
    head, _, last = topic.rpartition("/")
    return head if last in BESIDE and head else topic


def namespace_of(topic: str, node: str) -> str:
    """Return the namespace of a robot: that of the node, else what is before a monitor's topic.

    Topics of a monitor are named as in ``cart/guarantees``, so that all before them is the robot's.
    """
    if node:
        return node.rpartition("/")[0] or "/"
    return "/".join(base_topic(topic).split("/")[:-2]) or "/"


def is_below(name: str, namespace: str) -> bool:
    """Return whether a name is in a namespace."""
    return namespace == "/" or f"{name}/".startswith(f"{namespace}/")


def wanted_robots(words: Sequence[str]) -> dict[str, str]:
    """Return namespace -> name of each ``NAME`` or ``NAME=/namespace``.

    Raises:
        EddiError: a word is neither (V001).
    """
    found: dict[str, str] = {}
    for word in words:
        name, equals, namespace = word.partition("=")
        namespace = (namespace if equals else f"/{name.strip('/')}").rstrip("/") or "/"
        if not name or not namespace.startswith("/"):
            hint = "such as `--robot robot1`, or `--robot arm=/cell/arm`"
            message = f"--robot {word}: NAME or NAME=/namespace is expected"
            raise EddiError(error("V001", message, hint=hint))
        found[namespace] = name if equals else namespace
    return found


def robot_of(topic: str, node: str, wanted: Mapping[str, str]) -> str | None:
    """Return the name of the robot; ``None`` where others are wanted.

    Args:
        topic: of a message.
        node: that published it, empty where that is not known.
        wanted: namespace -> name; empty: every robot, by its namespace.
    """
    if not wanted:
        return namespace_of(topic, node)
    fitting = [one for one in wanted if is_below(topic, one) or (node and is_below(node, one))]
    return wanted[max(fitting, key=len)] if fitting else None

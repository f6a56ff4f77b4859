"""The messages that are watched, and what they tell of a robot and of a node."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple, Protocol

from eddi_scaffold.common.claims import Listen
from eddi_scaffold.common.escaping import one_line
from eddi_scaffold.common.problems import EddiError, problem
from eddi_scaffold.kinds import WHY, kinds
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE

DIAGNOSTICS = "diagnostic_msgs/DiagnosticArray"
DIAGNOSTICS_TOPIC = "/diagnostics"
GATHER_S = 0.03
"""Seconds in which messages are gathered once one has come: to wake up for each costs more than to
read it."""
# Whoever sends, and whatever: what is kept is limited.
MAX_TEXT = 300
MAX_VERDICTS = 10_000  # of all robots together
MAX_MONITORS = 2_000
MAX_INPUTS = 500  # of one monitor
MAX_REASONS = 20  # of one verdict


@dataclass(frozen=True)
class Message:
    """One message as it was received."""

    topic: str  # its full name
    type: str  # `package/Name`
    content: Any  # its fields as attributes, under the names of the `.msg` file
    t: float  # seconds on the clock of the receiver
    node: str = ""  # full name of the node that published it, empty where that is not known
    kept: bool = False  # the publisher had kept it for who comes later: it may be of any age


class Source(Protocol):
    """Where messages come from."""

    def receive(self, seconds: float) -> tuple[float, Sequence[Message]] | None:
        """Wait for messages for some seconds at most, and return the time and what came.

        ``None``: there is no more.
        """

    def notes(self) -> Sequence[str]:
        """Return what hinders the source now, as sentences."""

    def close(self) -> None:
        """End it."""


@cache
def status_messages() -> Mapping[str, tuple[str, Listen]]:
    """Return type of message -> title of its kind of monitor, and how it is understood."""
    return {
        f"{MESSAGE_PACKAGE}/{name}": (kind.title, listen)
        for kind in kinds().values()
        for name, listen in kind.verdicts.items()
    }


def is_watched(topic: str, type_: str) -> bool:
    """Return whether messages of a topic are read."""
    return type_ in (*status_messages(), WHY) or (
        type_ == DIAGNOSTICS and topic == DIAGNOSTICS_TOPIC
    )


def base_topic(topic: str) -> str:
    """Return the topic of the result, of one that is a companion of it."""
    head, _, last = topic.rpartition("/")
    return head if last in ("status", "evidence", "why") and head else topic


def is_below(name: str, namespace: str) -> bool:
    """Return whether a name is in a namespace."""
    return namespace == "/" or f"{name}/".startswith(f"{namespace}/")


def requested_robots(values: Sequence[str]) -> dict[str, str]:
    """Return namespace -> name of each ``NAME`` or ``NAME=/namespace``.

    Raises:
        EddiError: a value is neither (G008).
    """
    robots: dict[str, str] = {}
    for value in values:
        name, equals, namespace = value.partition("=")
        namespace = (namespace if equals else f"/{name.strip('/')}").rstrip("/") or "/"
        if not name or not namespace.startswith("/"):
            raise EddiError(problem("G008.robot", value=value))
        robots[namespace] = name if equals else namespace
    return robots


def robot_of(topic: str, node: str, requested: Mapping[str, str]) -> str | None:
    """Return the name of the robot that a message is of; ``None`` where others are requested.

    Args:
        topic: of the message.
        node: that published it, empty where that is not known.
        requested: namespace -> name; empty: every robot, by the namespace of the node, else by
            what is before the topic of a monitor, as in ``cart/guarantees``.
    """
    if requested:
        fitting = [n for n in requested if is_below(topic, n) or (node and is_below(node, n))]
        return requested[max(fitting, key=len)] if fitting else None
    return (node.rpartition("/")[0] if node else base_topic(topic).rsplit("/", 2)[0]) or "/"


def plain(text: object) -> str:
    """Return a text of others as one line of limited length."""
    line = one_line(str(text)[: MAX_TEXT + 1])
    return line if len(line) <= MAX_TEXT else f"{line[: MAX_TEXT - 1]}…"


_AGE, _FROM = ".age_s", ".from"
_OURS = "runtime_version"  # A value that the status of no other node has


class InputReport(NamedTuple):
    """One input of a monitor."""

    id: str
    state: str  # in a word: ok, waiting, latched, missing, stale or invalid
    age: float | None  # seconds of its oldest message, if there is one and it is known
    sources: tuple[str, ...] = ()  # topics, each with the claim that is read there, if one is


@dataclass(frozen=True)
class NodeReport:
    """One node, as it reported itself last."""

    t: float  # when, in seconds on the clock of the receiver
    node: str  # its full name
    model: str  # id of its model
    message: str  # what is wrong, or that all is in order
    inputs: tuple[InputReport, ...] = ()
    steps: int = 0  # so far
    overruns: int = 0  # steps that were left out so far
    longest_step: float = 0.0  # seconds


def reports_of(array: Any, t: float, prefix: str = "") -> Iterator[NodeReport]:
    """Yield the reports of monitors in a ``diagnostic_msgs/DiagnosticArray``.

    A prefix stands before all names of its graph, where several are watched.

    Raises:
        AttributeError, TypeError: it is none.
    """
    for status in array.status:
        values = {str(value.key): str(value.value) for value in status.values}
        if _OURS not in values:
            continue
        read = {key: plain(text).split(", ") for key, text in values.items() if key.endswith(_FROM)}
        inputs = [key.removesuffix(_AGE) for key in values if key.endswith(_AGE)]
        yield NodeReport(
            t,
            node=plain(f"{prefix}{status.hardware_id}"),
            model=plain(str(status.name).rpartition(": ")[2]),
            message=plain(status.message),
            inputs=tuple(
                InputReport(
                    plain(id_),
                    plain(values.get(id_, "")),
                    _number(values[id_ + _AGE]),
                    tuple(f"{prefix}{source}" for source in read.get(id_ + _FROM, ())),
                )
                for id_ in inputs[:MAX_INPUTS]
            ),
            steps=int(_number(values.get("steps")) or 0),
            overruns=int(_number(values.get("overruns")) or 0),
            longest_step=(_number(values.get("longest_step_ms")) or 0.0) / 1e3,
        )


def _number(text: str | None) -> float | None:
    try:
        number = float(text or "")
    except ValueError:
        return None
    return number if math.isfinite(number) else None

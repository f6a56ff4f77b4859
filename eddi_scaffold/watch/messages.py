"""The messages that are watched, and what they say of a node."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any, Protocol

from eddi_scaffold.common.claims import Listen
from eddi_scaffold.common.escaping import one_line
from eddi_scaffold.common.problems import EddiError, problem
from eddi_scaffold.kinds import kinds
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE

DIAGNOSTICS = "diagnostic_msgs/DiagnosticArray"
DIAGNOSTICS_TOPIC = "/diagnostics"
GATHER_S = 0.03
"""Seconds in which messages are gathered once one has come: to wake up for each costs more than to
read it."""


@dataclass(frozen=True)
class Message:
    """One message as it was received.

    Attributes:
        topic: its full name.
        type: ``package/Name``.
        content: its fields as attributes, under the names of the ``.msg`` file.
        t: seconds on the clock of the receiver.
        node: full name of the node that published it, empty where that is not known.
        kept: the publisher had kept it for who comes later: it may be of any age.
    """

    topic: str
    type: str
    content: Any
    t: float
    node: str = ""
    kept: bool = False


class Source(Protocol):
    """Where messages come from."""

    def receive(self, seconds: float) -> tuple[float, Sequence[Message]] | None:
        """Wait for messages, and return the time and what came; ``None``: there is no more.

        Args:
            seconds: to wait at most when there are none.
        """

    def notes(self) -> Sequence[str]:
        """Return what hinders the source now, as sentences."""

    def close(self) -> None:
        """End it."""


@dataclass(frozen=True)
class KnownMessage:
    """How messages of one type are understood.

    Attributes:
        title: of the kind of monitor.
        listen: what a message says.
    """

    title: str
    listen: Listen


@cache
def heard() -> Mapping[str, KnownMessage]:
    """Return type of message -> how it is understood, for every kind."""
    return {
        f"{MESSAGE_PACKAGE}/{name}": KnownMessage(kind.title, listen)
        for kind in kinds().values()
        for name, listen in kind.verdicts.items()
    }


def is_watched(topic: str, type_: str) -> bool:
    """Return whether messages of a topic are read."""
    return type_ in heard() or (type_ == DIAGNOSTICS and topic == DIAGNOSTICS_TOPIC)


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
        EddiError: a word is neither (G008).
    """
    found: dict[str, str] = {}
    for word in words:
        name, equals, namespace = word.partition("=")
        namespace = (namespace if equals else f"/{name.strip('/')}").rstrip("/") or "/"
        if not name or not namespace.startswith("/"):
            raise EddiError(problem("G008.robot", value=word))
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


MAX_TEXT = 300
MAX_VERDICTS = 10_000
"""Of all robots together."""
MAX_MONITORS = 2_000
MAX_INPUTS = 500
"""Of one monitor."""
MAX_REASONS = 20
"""Of one verdict."""


def plain(text: object) -> str:
    """Return a text of others as one line of limited length."""
    line = one_line(str(text)[: MAX_TEXT + 1])
    return line if len(line) <= MAX_TEXT else f"{line[: MAX_TEXT - 1]}…"


_AGE = ".age_s"
_OURS = "runtime_version"
"""A value that the status of no other node has."""
_INACTIVE = "inactive: "
_STANDINGS = ("guarantee", "threshold", "event", "in_scope")


@dataclass(frozen=True)
class InputReport:
    """One input of a monitor.

    Attributes:
        id: as in the model.
        state: in a word: ok, waiting, latched, missing, stale or invalid.
        age: of its oldest message in seconds, ``None``: not known, or there is none.
        reason: why it is not ok.
    """

    id: str
    state: str
    age: float | None
    reason: str


@dataclass(frozen=True)
class NodeReport:
    """One node, as it reported itself last.

    Attributes:
        t: when, in seconds on the clock of the receiver.
        node: its full name.
        model: id of its model.
        message: what is wrong, or that all is in order.
        inputs: in the order of the model.
        reasons: guarantee, threshold or event that is inactive -> why, in words.
        steps: so far.
        overruns: steps that were left out so far.
        longest_step: seconds.
    """

    t: float
    node: str
    model: str
    message: str
    inputs: tuple[InputReport, ...] = ()
    reasons: Mapping[str, str] = field(default_factory=dict)
    steps: int = 0
    overruns: int = 0
    longest_step: float = 0.0


def reports_of(array: Any, t: float) -> Iterator[NodeReport]:
    """Yield the reports of monitors in a ``diagnostic_msgs/DiagnosticArray``.

    Raises:
        AttributeError, TypeError: it is none.
    """
    for status in array.status:
        values = {str(value.key): str(value.value) for value in status.values}
        if _OURS not in values:
            continue
        inputs = [key.removesuffix(_AGE) for key in values if key.endswith(_AGE)]
        yield NodeReport(
            t=t,
            node=plain(status.hardware_id),
            model=plain(str(status.name).rpartition(": ")[2]),
            message=plain(status.message),
            inputs=tuple(_input(name, values) for name in inputs[:MAX_INPUTS]),
            reasons=dict(_reasons(values)),
            steps=int(_number(values.get("steps"))),
            overruns=int(_number(values.get("overruns"))),
            longest_step=_number(values.get("longest_step_ms")) / 1e3,
        )


def _input(name: str, values: Mapping[str, str]) -> InputReport:
    age = _number(values[f"{name}{_AGE}"], math.nan)
    return InputReport(
        plain(name),
        plain(values.get(name, "")),
        None if math.isnan(age) else age,
        plain(values.get(f"{name}.reason", "")),
    )


def _reasons(values: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Yield id and words of what is inactive: ``guarantee.ID``, or ``in_scope`` by itself."""
    for key, text in values.items():
        what, _, id_ = key.partition(".")
        if text.startswith(_INACTIVE) and what in _STANDINGS:
            yield plain(id_ or what), plain(text.removeprefix(_INACTIVE))


def _number(text: str | None, otherwise: float = 0.0) -> float:
    try:
        found = float(text or "")
    except ValueError:
        return otherwise
    return found if math.isfinite(found) else otherwise

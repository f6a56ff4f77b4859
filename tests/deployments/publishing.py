"""What a monitor publishes on which topic, and what of it claims something good."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from eddi_runtime import Monitor as RunningMonitor

from eddi_scaffold.config.fields import FieldPath
from eddi_scaffold.monitors.binding import Monitor
from eddi_scaffold.monitors.publications import publications
from tests.deployments.messages import Message, message_of, read

Published = Sequence[tuple[str, Message]]


def resolved(topic: str, namespace: str = "") -> str:
    """Return the full name of a topic, as ROS finds it for a node of a namespace."""
    if topic.startswith("/"):
        return topic
    return f"/{namespace}/{topic}".replace("//", "/")


@dataclass(frozen=True)
class _Topic:
    """One publication: a message, or one event or one value of it.

    Attributes:
        of: empty for the result, else what stands beside it: ``status``, ``evidence``.
        only: id of the one message of several that goes here.
    """

    name: str
    of: str
    only: str | None
    path: FieldPath


class Publisher:
    """The publications of one monitor in one namespace.

    Attributes:
        topics: their full names.
        hazards: events whose `active` claims nothing, and whose absence does.
    """

    def __init__(self, monitor: Monitor, rename: Mapping[str, str], namespace: str = "") -> None:
        """Take over the outputs of the configuration.

        Args:
            rename: topic in the configuration -> another one, as a launch file remaps it.
        """
        assert monitor.config is not None
        found, problems = publications(monitor, monitor.config)
        assert not problems, problems
        self._topics: list[_Topic] = []
        for one in found:
            base, slash, rest = one.output.topic.partition("/evidence")
            topic = resolved(rename.get(base, base), namespace) + slash + rest
            of = getattr(one, "of", "")
            self._topics.append(_Topic(topic, of, one.output.event, one.path))
            if _has_status(monitor) and not one.path and not of:
                self._topics.append(_Topic(f"{topic}/status", "status", None, ()))
        self.hazards = _hazards(monitor)
        self.topics: frozenset[str] = frozenset(one.name for one in self._topics)
        self._claims = {"safeml": "status", "bayesian_network": "evidence"}.get(
            monitor.kind.name, ""
        )

    def messages(self, running: RunningMonitor, output: Any, wanted: Collection[str]) -> Published:
        """Return the messages of a step that somebody reads, and those that claim something."""
        said: dict[str, Sequence[Message]] = {}
        told: list[tuple[str, Message]] = []
        for topic in self._topics:
            if topic.name not in wanted and topic.of != self._claims:
                continue
            if topic.of not in said:
                said[topic.of] = _said(running, output, topic.of)
            told += [
                (topic.name, _picked(message, topic.path))
                for message in said[topic.of]
                if topic.only in (None, getattr(message, "id", None))
            ]
        return told

    def claims(self, told: Published) -> Mapping[str, bool]:
        """Return output -> whether what was published claims something good."""
        found: dict[str, bool] = {}
        for _, message in told:
            kind = message.message_type.partition("/")[2]
            if kind == "ConSertOutput":
                found.update((one.id, one.active) for one in message.guarantees)
            elif kind == "EventOutput":
                hazard = message.id in self.hazards
                found[message.id] = not message.active if hazard else message.active
            elif kind in ("ReliabilityOutput", "BayesianNetworkEvidence"):
                found.update((one.id, one.active) for one in message.evidence)
            elif kind == "SafeMLStatus":
                found["in_scope"] = message.in_scope
        return found


def _has_status(monitor: Monitor) -> bool:
    return "status" in monitor.kind.functions.beside(monitor.model)


def _said(running: RunningMonitor, output: Any, of: str) -> Sequence[Message]:
    """Return the result of a step as messages, or what stands beside it."""
    trees = getattr(running, f"{of}_message")() if of else running.message(output)
    listed = trees if isinstance(trees, list) else [] if trees is None else [trees]
    return [message_of(tree) for tree in listed]


def _hazards(monitor: Monitor) -> frozenset[str]:
    if monitor.kind.name != "event":
        return frozenset()
    events = monitor.model.data.analysis.events
    return frozenset(event.id for event in events if event.polarity == "HAZARD")


def _picked(message: Message, path: FieldPath) -> Message:
    if not path:
        return message
    value = read(message, path)
    name = {bool: "Bool", float: "Float64", int: "Int64", str: "String"}[type(value)]
    return Message(message_type=f"std_msgs/{name}", data=value)

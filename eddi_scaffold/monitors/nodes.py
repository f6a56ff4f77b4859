"""A monitor as a node of a robot, on any transport: what it hears, what it publishes, when."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

from eddi_runtime.node.topics import why_topic

from eddi_scaffold.common.escaping import markdown_code, python_literal
from eddi_scaffold.common.problems import Problem, problem
from eddi_scaffold.config.field_paths import plain_step
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import InputQos, SimulatorOutput
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE, STATUS, Publication, publications
from eddi_scaffold.monitors.robots import check_fleet, fleet_answers, fleet_message


@dataclass(frozen=True)
class MonitorNode:
    """The node of a monitor with a configuration."""

    monitor: BoundMonitor
    config: ConfigFile
    publications: list[Publication]

    @cached_property
    def published(self) -> list[Publication]:
        """Return the topics that have a row of their own: all but the status of a result."""
        return [topic for topic in self.publications if topic.of != STATUS or topic.path]

    @cached_property
    def subscribed(self) -> list[SimulatorOutput]:
        """Return the topics of this robot that an input requires, in the configuration's order."""
        return [source for source in self._required if source.peers is None]

    @cached_property
    def between_robots(self) -> dict[str, str]:
        """Return the topic on which robots tell each other, with its type; none for one alone."""
        fleet, type_ = self.config.config.Fleet, fleet_message(self.monitor.kind)
        return {} if fleet is None or type_ is None else {fleet.topic: type_}

    @cached_property
    def reasons(self) -> tuple[list[str], list[str]]:
        """Return the topics on which it tells and reads why claims are as they are."""
        results = [topic for topic in self.publications if not (topic.of or topic.path)]
        own = [topic.output.topic for topic in results or self.publications[:1]]
        reading = {source for binding in self.monitor.inputs for source, _ in binding.claims}
        heard = [source.topic for source in self.subscribed if source.id in reading]
        told, read = (list(dict.fromkeys(map(why_topic, names))) for names in (own, heard))
        return told, read

    @cached_property
    def _required(self) -> list[SimulatorOutput]:
        used = {source.id for binding in self.monitor.inputs for source in binding.requires}
        entries = self.config.config.SimulatorOutputs
        first = {entry.id: entry for entry in reversed(entries)}
        return [first[name] for name in dict.fromkeys(e.id for e in entries) if name in used]

    def answers(
        self, class_of: Callable[[str], str], *, has_qos: bool = False
    ) -> dict[str, JsonValue]:
        """Return the answers for all nodes; ``class_of``: message type -> name of its class."""
        taken_each = {  # some input takes every message of these topics, not the latest one
            binding.requires[0].id
            for binding in self.monitor.inputs
            if binding.model.every_message and binding.requires
        }
        fleet, answers_of_fleet = self.config.config.Fleet, {}
        if fleet is not None and self.between_robots:
            class_ = class_of(self.between_robots[fleet.topic])
            others = [source for source in self._required if source.peers is not None]
            answers_of_fleet = fleet_answers(fleet, class_, others)
        return {
            "subscriptions": [
                {
                    "id": python_literal(source.id),
                    "topic": python_literal(source.topic),
                    "message_class": class_of(source.type),
                    "more": (", every_message=True" if source.id in taken_each else "")
                    + (_qos(source.qos, ", ") if has_qos else ""),
                }
                for source in self.subscribed
            ],
            "publications": [
                self._publication(publication, class_of, has_qos) for publication in self.published
            ],
            "fleet": answers_of_fleet,
        }

    def _publication(
        self, publication: Publication, class_of: Callable[[str], str], has_qos: bool
    ) -> dict[str, JsonValue]:
        output, is_result = publication.output, not (publication.path or publication.of)
        status = self.monitor.model.companion_messages().get(STATUS) if is_result else None
        return {
            "id": python_literal(output.id),
            "title": markdown_code(output.id),
            "topic": python_literal(output.topic),
            "topic_text": output.topic,
            "type_text": publication.type,
            "message_class": class_of(publication.type),
            "status_topic": python_literal(f"{output.topic}/{STATUS}" if status else None),
            "status_class": class_of(f"{MESSAGE_PACKAGE}/{status}") if status else "None",
            "more": _more(publication)
            + (_qos(output.qos, "\n            ", ",") if has_qos else ""),
        }


def node_of(monitor: BoundMonitor) -> tuple[MonitorNode, list[Problem]]:
    """Return the node of a monitor, and what is wrong with it; its configuration is there."""
    assert monitor.config is not None, "a node needs a configuration"
    topics, problems = publications(monitor, monitor.config)
    node = MonitorNode(monitor, monitor.config, topics)
    return node, [*problems, *_check(node)]


def _more(publication: Publication) -> str:
    """Return the arguments that only some publications have."""
    event, of, more = publication.output.event, publication.of, ""
    if publication.path:
        steps = (plain_step(step) for step in publication.path)
        texts = (python_literal(tuple(step) if isinstance(step, list) else step) for step in steps)
        more += f"\n            field=({', '.join(texts)},),"
    more += f"\n            only={python_literal(event)}," if event is not None else ""
    return more + (f"\n            of={python_literal(of)}," if of else "")


def _qos(qos: InputQos, start: str, end: str = "") -> str:
    """Return the argument for the quality of service that a configuration gives."""
    pairs = [
        f"{python_literal(name)}: {python_literal(value)}"
        for name, value in qos.model_dump(exclude_none=True).items()
    ]
    return f"{start}qos={{{', '.join(pairs)}}}{end}" if pairs else ""


def _check(node: MonitorNode) -> Iterator[Problem]:
    """Find outputs that their own monitor hears, or of one topic (K031); and all among robots.

    Topics are compared as a node outside of any namespace resolves them: `a/b` is `/a/b` there.
    """
    monitor, config = node.monitor, node.config
    yield from check_fleet(monitor, config)
    read = {monitor.topic(entry.topic) for entry in config.config.SimulatorOutputs}
    first: dict[str, Publication] = {}
    for publication in node.published:
        written, place = publication.output.topic, publication.place
        topic = monitor.topic(written)
        if topic in read:
            yield problem("K031.own_output", place, written=written)
        other = first.setdefault(topic, publication)
        is_below = publication.of and not publication.path
        if other.type != publication.type:
            types = {"type": other.type, "other": publication.type}
            yield problem("K031.two_types", place, written=written, **types)
        # A reader takes them for one: messages of two events have ids. What is published below
        # the topic of a result is reported there.
        events = {other.output.event, publication.output.event}
        is_mixed = (len(events) == 1 or None in events) and not is_below
        if other.type == publication.type and other is not publication and is_mixed:
            names = {"first": other.output.id, "second": publication.output.id}
            yield problem("K031.two_outputs", place, written=written, **names)

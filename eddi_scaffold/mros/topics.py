"""From a system and its node models to the topics that a monitor can listen to."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from eddi_scaffold.common.identifiers import RESERVED, free_name, is_identifier
from eddi_scaffold.common.problems import Place, Problem, in_order, problem
from eddi_scaffold.mros.model import InterfaceKind, System
from eddi_scaffold.mros.resolving import LOST_TOPICS, Models, ResolvedInterface, Resolver, flattened

TopicKind = Literal["published", "action", "subscribed"]
_SOURCES = ("publisher", "serviceserver", "actionserver")
_ILLEGAL = re.compile(r"[^A-Za-z0-9_/]")


@dataclass(frozen=True)
class TopicEntry:
    """One entry of ``SimulatorOutputs``."""

    id: str
    type: str  # `package.Type`
    topic: str
    place: Place = field(default=Place())  # where it is written


@dataclass(frozen=True)
class Topic(TopicEntry):
    """A topic of a system, its name absolute, its id a Python name; its place is the first one."""

    kind: TopicKind = "published"
    components: tuple[str, ...] = ()  # who provides it or, of kind `subscribed`, waits for it


@dataclass(frozen=True)
class Outputs:
    """What a system gives to listen to."""

    topics: tuple[Topic, ...]  # in the order of the system
    # errors and warnings of the system, not of the files it is made of
    problems: tuple[Problem, ...]
    components: int  # number of nodes of the system itself
    publishers: int  # number of publishers whose topic and type are known
    services: int  # number of services, which cannot be listened to
    actions: int  # number of actions; their topics come with `include`
    is_complete: bool  # nothing was in the way of a topic; else the system may have more of them


def simulator_outputs(
    system: System,
    models: Models,
    *,
    include: Collection[str] = (),
    existing: Sequence[TopicEntry] = (),
    names: Literal["label", "model"] = "label",
) -> Outputs:
    """Join a system with its node models.

    Args:
        system: what runs.
        models: what the nodes are.
        include: further topics: `subscribed` by the system only, those of its `actions`.
        existing: entries of a configuration, whose ids stay.
        names: those of the system, or of the node models.

    References that do not resolve are problems, and the rest is returned all the same. The id of an
    existing entry that may be among what did not resolve is given to nothing else.
    """
    systems, problems = flattened(system, models.systems)
    kinds: list[InterfaceKind] = ["publisher"]
    kinds += ["actionserver"] if "actions" in include else []
    kinds += ["subscriber"] if "subscribed" in include else []
    resolver = Resolver(models, systems, kinds)
    problems += resolver.problems
    known = (*models.problems, *system.problems, *problems)
    is_complete = not any(fault.level == "error" or fault.case in LOST_TOPICS for fault in known)
    collector = _Collector(systems if names == "label" else (), resolver.interfaces)
    for kind in kinds:
        for resolved in resolver.interfaces:
            if resolved.interface.kind == kind:
                collector.add(resolved)
    topics = collector.topics
    names_of = collector.names
    published = {name: names_of[name] for name in topics if topics[name].kind == "published"}
    reserved = () if is_complete else [old.id for old in existing if old.topic not in topics]
    ids, about_ids = give_ids(published, names_of, existing, reserved)
    listed = Counter(
        interface.kind
        for part in systems
        for component in part.components
        for interface in component.interfaces
    )
    return Outputs(
        tuple(replace(topic, id=ids[name]) for name, topic in topics.items()),
        tuple(in_order([*problems, *collector.problems, *about_ids])),
        len(system.components),
        collector.publishers,
        listed["serviceserver"],
        listed["actionserver"],
        is_complete,
    )


def silent_problems(system: System, models: Models) -> list[Problem]:
    """Return what is wrong with the services and actions of a system, which give no topics."""
    systems, _ = flattened(system, models.systems)
    kinds: Sequence[InterfaceKind] = ("serviceserver", "serviceclient", "actionclient")
    return Resolver(models, systems, kinds).problems


class _Collector:
    """Topics of interfaces, by connections, labels and namespaces."""

    def __init__(self, named: Sequence[System], resolved: Sequence[ResolvedInterface]) -> None:
        """Read the connections of systems whose names count; none where the models' do."""
        self.topics: dict[str, Topic] = {}
        self.names: dict[str, str] = {}
        self.publishers = 0
        self.problems: list[Problem] = []
        self._uses_labels = bool(named)
        self._connection_names: dict[str, str] = {}  # of each end
        self._sources: dict[str, ResolvedInterface] = {}  # who gives what an end takes
        publishers: dict[str, ResolvedInterface] = {}
        for publisher in resolved:
            if publisher.interface.kind == "publisher":
                publishers.setdefault(publisher.end, publisher)
        used = Counter(
            (interface.kind in _SOURCES, interface.name)
            for part in named
            if part.dialect == "indent"
            for component in part.components
            for interface in component.interfaces
        )
        for part in named:
            for connection in part.connections:
                if connection.kind not in ("topic", ""):
                    continue
                for is_source, ends in ((True, connection.sources), (False, connection.targets)):
                    for end in ends:
                        if (count := used[is_source, end]) > 1:
                            self.problems.append(
                                problem("M018", connection.place, label=end, count=count)
                            )
                        if connection.name:
                            self._connection_names.setdefault(end, connection.name)
                sources = [publishers[end] for end in connection.sources if end in publishers]
                for end in connection.targets if sources else ():
                    self._sources.setdefault(end, sources[0])

    def add(self, resolved: ResolvedInterface) -> None:
        """Add the topic of an interface; those of an action server of ROS 1 (actionlib)."""
        kind, name = resolved.interface.kind, resolved.interface.name
        type_ = str(resolved.interface.ros_type)
        if kind == "actionserver" and resolved.model.file.endswith(".ros2"):
            self.problems.append(problem("M019", resolved.place, name=resolved.name))
            return
        topic = self._topic(resolved)
        if topic is None:
            return
        if kind == "actionserver":
            for part, part_type in (
                ("feedback", f"{type_}ActionFeedback"),
                ("status", "actionlib_msgs/GoalStatusArray"),
                ("result", f"{type_}ActionResult"),
            ):
                self._add(f"{topic}/{part}", resolved, f"{name}/{part}", part_type, "action")
        elif kind == "publisher":
            self.publishers += 1
            self._add(topic, resolved, name, type_, "published")
        else:
            self._add(topic, resolved, name, type_, "subscribed")

    def _topic(self, resolved: ResolvedInterface) -> str | None:
        """Return the topic of an interface; ``None``, and a problem, where it has none."""
        is_subscriber = resolved.interface.kind == "subscriber"
        source = self._sources.get(resolved.end) if is_subscriber else None
        named = source or resolved
        written = named.interface.name
        if self._uses_labels:
            connection = named.interface.kind != "actionserver" and self._connection_names.get(
                named.end
            )
            written = connection or named.name
        topic, is_glued = topic_name(written, named.namespace, named.component.name)
        illegal = "".join(sorted({*_ILLEGAL.findall(topic)}))
        faults = [
            ("M015.empty", topic == "/", {"name": written}),
            ("M015.namespace", is_glued, {"name": written, "corrected": topic}),
            ("M015.illegal", illegal, {"name": topic, "illegal": illegal}),
        ]
        if source is None:  # else its problems are those of the source
            self.problems += [problem(case, named.place, **f) for case, is_so, f in faults if is_so]
        return topic if topic != "/" else None

    def _add(
        self, topic: str, resolved: ResolvedInterface, name: str, type_: str, kind: TopicKind
    ) -> None:
        component = resolved.component.name
        known = self.topics.get(topic)
        if known is None:
            self.names[topic] = name
            self.topics[topic] = Topic("", type_, topic, resolved.place, kind, (component,))
            return
        if known.type != type_:
            case = "M012.subscribed_types" if kind == "subscribed" else "M012.two_types"
            fields = {"topic": topic, "type": known.type, "component": known.components[0]}
            more = {"other": type_, "other_component": component}
            self.problems.append(problem(case, resolved.place, **fields, **more))
        if known.kind == kind and component not in known.components:
            components = (*known.components, component)
            self.topics[topic] = replace(known, components=components)


def topic_name(name: str, namespace: str | None, component: str) -> tuple[str, bool]:
    """Resolve a name (``/x``, ``~x`` or relative) as ROS 1 does, with what real models need.

    A relative name that begins with the namespace is not given it twice; returned is as well
    whether it did so without a ``/`` between. The last segment of a component names its node.
    """
    space = (namespace or "").strip("/")
    glued = False
    parts = [name]
    if name.startswith("~"):
        parts = [space, component.rstrip("/").rpartition("/")[2], name[1:]]
    elif space and not name.startswith("/") and not f"{name}/".startswith(f"{space}/"):
        parts, glued = [space, name], name.startswith(space)
    return "/" + "/".join(filter(None, "/".join(parts).split("/"))), glued


def slug(name: str) -> str:
    """Return a Python name for a name of ROS."""
    text = re.sub(r"[^A-Za-z0-9_]+", "_", name).strip("_") or "topic"
    if text[0].isdigit():
        text = f"_{text}"
    return f"{text}_" if text in RESERVED else text


def give_ids(
    published: Mapping[str, str],
    names: Mapping[str, str],
    existing: Sequence[TopicEntry],
    reserved: Collection[str] = (),
) -> tuple[dict[str, str], list[Problem]]:
    """Give each topic an id, the published ones first; ``names`` are those in the node models.

    A topic that has an id already keeps it. Otherwise it is the name in the model if no other
    topic has the same one, else the topic; and a number behind what is taken or reserved.
    """
    counts = Counter(entry.id for entry in existing)
    ids: dict[str, str] = {}
    for entry in existing:
        if entry.topic in names and counts[entry.id] == 1 and is_identifier(entry.id):
            ids.setdefault(entry.topic, entry.id)
    taken = {*ids.values(), *reserved}
    others = {topic: name for topic, name in names.items() if topic not in published}
    new: dict[str, str] = {}
    for group in (published, others):
        slugs = {topic: slug(name) for topic, name in group.items()}
        common = Counter(slugs.values())
        unnamed = [topic for topic in group if topic not in ids]
        free = {name for name, count in common.items() if count == 1} - taken
        new |= {topic: slugs[topic] for topic in unnamed if slugs[topic] in free}
        taken |= {*new.values()}
        for topic in unnamed:
            if topic not in new:
                new[topic] = free_name(slug(topic), taken)
                taken.add(new[topic])
    problems = []
    by_id = {entry.id: entry for entry in existing}
    for topic, name in new.items():
        former = by_id.get(name)
        if former is not None and former.topic != topic and former.topic not in names:
            fields = {"name": name, "former": former.topic, "topic": topic}
            problems.append(problem("M020.used_before", former.place, **fields))
    problems += [
        problem("M020.changed", entry.place, id=entry.id, topic=entry.topic, new=new[entry.topic])
        for entry in existing
        if entry.topic in new and new[entry.topic] != entry.id
    ]
    return {**ids, **new}, problems

"""From a system and its node models to the topics that a monitor can listen to."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from eddi_scaffold.common.problems import Problem, in_order, problem
from eddi_scaffold.mros.filters import Criterion, Existing, Filters, Wish, give_ids
from eddi_scaffold.mros.interface_definitions import Models, SystemFile, noticed
from eddi_scaffold.mros.model import InterfaceKind
from eddi_scaffold.mros.naming import Naming
from eddi_scaffold.mros.resolving import (
    LOST_TOPICS,
    ResolvedInterface,
    flattened,
    resolve,
)
from eddi_scaffold.mros.topics import Topic, TopicKind

Include = Literal["subscribed", "actions"]


@dataclass(frozen=True)
class Outputs:
    """What a system gives to listen to.

    Attributes:
        topics: in the order of the system.
        left_out: topics that the filters keep out, and which of them does.
        problems: errors and warnings of the system, not of the files it is made of.
        components: number of nodes of the system itself.
        publishers: number of publishers whose topic and type are known.
        services: number of services, which cannot be listened to.
        actions: number of actions; their topics come with ``include``.
        is_complete: nothing was in the way of a topic; else the system may have more of them.
    """

    topics: tuple[Topic, ...]
    left_out: Mapping[str, Criterion]
    problems: tuple[Problem, ...]
    components: int
    publishers: int
    services: int
    actions: int
    is_complete: bool


def simulator_outputs(
    system: SystemFile,
    models: Models,
    *,
    include: Collection[Include] = (),
    existing: Iterable[Existing] = (),
    filters: Filters | None = None,
    names: Literal["label", "model"] = "label",
) -> Outputs:
    """Join a system with its node models.

    Args:
        system: what runs.
        models: what the nodes are.
        include: topics in addition to the published ones: those that the system only subscribes,
            those of its action servers.
        existing: entries of a configuration, whose ids stay.
        filters: which topics to keep; they never change an id.
        names: the names of the system, or of the node models where the system's are not used.

    References that do not resolve are problems, and the rest is returned all the same. The id of an
    existing entry that may be among what did not resolve is given to nothing else.
    """
    flat = flattened(system, models.systems)
    kinds: set[InterfaceKind] = {"publisher"}
    kinds |= {"subscriber"} if "subscribed" in include else set()
    kinds |= {"actionserver"} if "actions" in include else set()
    problems = list(flat.problems)
    found: list[ResolvedInterface] = []
    counts: dict[str, int] = {"serviceserver": 0, "actionserver": 0}
    for part in flat.systems:
        for component in part.system.components:
            resolved, more = resolve(
                component, part.system.dialect, part.file, models.definitions, kinds
            )
            found += resolved
            problems += more
            for kind in counts:
                counts[kind] += sum(1 for listed in component.interfaces if listed.kind == kind)
    naming = Naming(flat.systems, found, names)
    collected = _Collected(naming)
    for kind, take in (
        ("publisher", collected.published),
        ("actionserver", collected.action),
        ("subscriber", collected.subscribed),
    ):
        for one in found:
            if one.kind == kind:
                take(one)
    read = [*models.problems, *noticed(system.system.notices, system.file)]
    is_complete = not any(_loses_topics(problem) for problem in (*read, *problems))
    topics, more = _with_ids(collected.topics, list(existing), is_complete=is_complete)
    left_out: dict[str, Criterion] = {}
    for topic in topics:
        criterion = filters.leaves_out(topic) if filters is not None else None
        if criterion is not None:
            left_out[topic.topic] = criterion
    return Outputs(
        tuple(topic for topic in topics if topic.topic not in left_out),
        left_out,
        tuple(in_order([*problems, *naming.problems, *collected.problems, *more])),
        len(system.system.components),
        collected.publishers,
        counts["serviceserver"],
        counts["actionserver"],
        is_complete,
    )


def silent_problems(system: SystemFile, models: Models) -> list[Problem]:
    """Return what is wrong with the services and actions of a system, which give no topics."""
    kinds: tuple[InterfaceKind, ...] = ("serviceserver", "serviceclient", "actionclient")
    problems: list[Problem] = []
    for part in flattened(system, models.systems).systems:
        for component in part.system.components:
            problems += resolve(
                component, part.system.dialect, part.file, models.definitions, kinds
            )[1]
    return problems


@dataclass
class _Entry:
    """A topic that has no id yet."""

    first: ResolvedInterface
    model_name: str
    type: str
    kind: TopicKind
    components: list[str]
    deadlines: list[str]


@dataclass
class _Collected:
    """The topics so far; one entry each."""

    naming: Naming
    topics: dict[str, _Entry] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)
    publishers: int = 0

    def published(self, one: ResolvedInterface) -> None:
        topic = self.naming.topic(one)
        if topic is None:
            return
        self.publishers += 1
        self._add(topic, one, one.model_name, f"{one.package}.{one.type}", "published")

    def action(self, one: ResolvedInterface) -> None:
        """Add the topics of an action server of ROS 1 (actionlib)."""
        if one.definition.of.file.endswith(".ros2"):
            self.problems.append(problem("M019", one.place, name=one.name))
            return
        topic = self.naming.topic(one)
        if topic is None:
            return
        of = f"{one.package}.{one.type}"
        for part, type_ in (
            ("feedback", f"{of}ActionFeedback"),
            ("status", "actionlib_msgs.GoalStatusArray"),
            ("result", f"{of}ActionResult"),
        ):
            self._add(f"{topic}/{part}", one, f"{one.model_name}/{part}", type_, "action")

    def subscribed(self, one: ResolvedInterface) -> None:
        topic = self.naming.topic(one)
        if topic is not None:
            self._add(topic, one, one.model_name, f"{one.package}.{one.type}", "subscribed")

    def _add(
        self, topic: str, one: ResolvedInterface, name: str, type_: str, kind: TopicKind
    ) -> None:
        known = self.topics.get(topic)
        provider, deadline = one.component.name, one.definition.interface.deadline
        if known is None:
            self.topics[topic] = _Entry(one, name, type_, kind, [provider], [deadline])
            return
        if known.type != type_:
            fault = problem(
                "M012.subscribed_types" if kind == "subscribed" else "M012.two_types",
                one.place,
                topic=topic,
                type=known.type,
                component=known.first.component.name,
                other=type_,
                other_component=provider,
            )
            self.problems.append(fault)
        if known.kind == kind and provider not in known.components:
            known.components.append(provider)
            known.deadlines.append(deadline)


def _loses_topics(problem: Problem) -> bool:
    """Return whether a system may have topics that are not found because of a problem."""
    return problem.level == "error" or problem.case in LOST_TOPICS


def _with_ids(
    entries: dict[str, _Entry], existing: Sequence[Existing], *, is_complete: bool
) -> tuple[list[Topic], list[Problem]]:
    order = list(entries.items())
    wishes = [Wish(entry.model_name, topic) for topic, entry in order]
    first = next((i for i, (_, one) in enumerate(order) if one.kind != "published"), len(order))
    reserved = [] if is_complete else [old.id for old in existing if old.topic not in entries]
    ids, problems = give_ids(wishes[:first], wishes[first:], existing, reserved)
    topics = [
        Topic(
            name,
            entry.type,
            topic,
            entry.kind,
            tuple(entry.components),
            entry.first.place.file,
            entry.first.place.line or 0,
            tuple(entry.deadlines),
        )
        for name, (topic, entry) in zip(ids, order, strict=True)
    ]
    return topics, problems

"""What each claim rests on, where less is accepted, and rings of claims.

Two ConSerts that feed each other keep each other active for ever after their sources have died:
the messages are fresh, and ages do not help. A ring is one of claims, not of topics: two ConSerts
may well read different guarantees of each other.

Works on what a package remembers of itself, so that a new monitor can be compared with those that
a workspace has already.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from eddi_scaffold.common.claims import Acceptance, Claim, Meanings
from eddi_scaffold.common.graphs import cycles, reached, reversed_graph
from eddi_scaffold.common.identifiers import attribute, full_topic
from eddi_scaffold.common.problems import Place, Problem, problem
from eddi_scaffold.config.field_paths import ByKey, FieldPath, parse_field
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.file import from_json as config_of
from eddi_scaffold.kinds import JsonValue, Kind, kinds
from eddi_scaffold.monitors.expression_names import head_of, path_behind
from eddi_scaffold.monitors.facts import MonitorFacts, from_json


@dataclass(frozen=True)
class WiredMonitor:
    """A monitor, as far as rings are concerned.

    Attributes:
        name: for people.
        package: its package, which private topics are below.
        namespace: of its robot, empty for none.
        kind: its kind.
        config: its configuration, given or remembered.
        facts: what its package remembers of it.
        model_file: of its model, for places.
        alone: topic with one value of its message -> that field, for people.
    """

    name: str
    package: str
    namespace: str
    kind: Kind
    config: ConfigFile
    facts: MonitorFacts
    model_file: str = ""
    alone: Mapping[str, str] = field(default_factory=dict)

    @property
    def frequency(self) -> float:
        """Steps per second."""
        return self.config.config.Model.frequency

    @cached_property
    def claims(self) -> Mapping[str, Claim]:
        """Its claims; the whole result, of the id ``""``, where it names none."""
        return {claim.id: claim for claim in self.facts.claims}

    def meanings(self, part: str | None) -> Meanings:
        """Return what the fields of its messages mean on a topic of one claim, or of all."""
        return self.kind.model_class.meanings(self.facts.claims_on(part))

    @property
    def by_words(self) -> Sequence[str]:
        """Its claims that rest on words of other robots."""
        words = {source.id for source in self.config.config.SimulatorOutputs if source.peers}
        fed = {input_.id for input_ in self.facts.inputs if words & set(input_.requires)}
        return [self.claim(one.id) for one in self.facts.claims if fed & one.rests_on]

    def claim(self, output: str) -> str:
        """Return the name of one of its claims among all: its own name, and the output's."""
        return f"{self.name}.{output}" if output else self.name

    def published(self) -> Sequence[str]:
        """Return the full names of the topics that it publishes."""
        return [topic for topic, _ in topics_published(self)]

    def topics(self, input_: str) -> Sequence[str]:
        """Return the full names of the topics that an input reads."""
        return list(dict.fromkeys(topic for topic, _ in topics_read(self).get(input_, ())))

    def topic(self, name: str) -> str:
        """Return the full name of a topic of this monitor's node."""
        return full_topic(name, self.namespace, self.package)


@dataclass(frozen=True)
class PublishedTopic:
    """What a participant publishes on one topic: a part of its result, one value, or all."""

    of: WiredMonitor
    part: str | None
    path: FieldPath


def facts_of_package(package: str, answers: Mapping[str, Any]) -> WiredMonitor | None:
    """Return a monitor as the answers of its package have it; ``None`` for other packages."""
    if not answers.get("facts_json") or not answers.get("config_json"):
        return None
    try:
        config = config_of(answers["config_json"], package)
        facts = from_json(answers["facts_json"])
        kind, file = kinds()[answers["kind"]], str(answers["model_file"])
        outputs = [output for output in answers.get("outputs") or () if "topic_text" in output]
        bare = [
            output["topic_text"]
            for output in outputs
            if output["type_text"].startswith("std_msgs/")
        ]
        alone = dict.fromkeys(bare, "the same field")
        found = WiredMonitor(config.config.Model.id, package, "", kind, config, facts, file, alone)
        supports([found])  # what it reads can be followed
    except (AttributeError, LookupError, RecursionError, TypeError, ValueError):
        return None
    return found


def check_rings(participants: Sequence[WiredMonitor]) -> Iterator[Problem]:
    """Report each ring of claims once (D003)."""
    owners = {
        participant.claim(output): participant
        for participant in participants
        for output in participant.claims
    }
    for ring in cycles(supports(participants)):
        first, *others = ring  # in the direction of support
        chain = ", which needs ".join([*reversed(others), first])
        yield problem(
            "D003.cycle", owners[first].config.place("EDDIInputs"), first=first, chain=chain
        )


def supports(participants: Sequence[WiredMonitor]) -> Mapping[str, tuple[str, ...]]:
    """Return for each claim the claims of other monitors that it rests on."""
    by_topic: dict[str, list[PublishedTopic]] = {}
    for participant in participants:
        for topic, item in topics_published(participant):
            by_topic.setdefault(topic, []).append(item)
    graph: dict[str, tuple[str, ...]] = {}
    for participant in participants:
        below = {
            name: _below(participant, read, by_topic)
            for name, read in topics_read(participant).items()
        }
        for claim in participant.facts.claims:
            rests = [claims for name, claims in below.items() if name in claim.rests_on]
            graph[participant.claim(claim.id)] = tuple(
                dict.fromkeys(c for claims in rests for c in claims)
            )
    return graph


def topics_published(of: WiredMonitor) -> Iterator[tuple[str, PublishedTopic]]:
    """Yield the full names of the topics of a participant, with what is on them."""
    for output in of.config.config.EDDIOutputs:
        path = parse_field(output.field) if output.field is not None else ()
        item = PublishedTopic(of, output.event, path)
        yield of.topic(output.topic), item
        for name in ("status", "evidence"):
            yield of.topic(f"{output.topic}/{name}"), item


def topics_read(of: WiredMonitor) -> Mapping[str, Sequence[tuple[str, FieldPath]]]:
    """Return for each input the topics that it reads, with the path into each message."""
    topics = {one.id: of.topic(one.topic) for one in of.config.config.SimulatorOutputs}
    entries = {one.id: one for one in of.config.config.EDDIInputs}
    found: dict[str, list[tuple[str, FieldPath]]] = {}
    for input_ in of.facts.inputs:
        entry = entries.get(input_.id)
        reads = found[input_.id] = []
        if entry is None:
            continue
        if input_.reads is None:
            path = parse_field(entry.field) if entry.field is not None else ()
            reads += [(topics[name], path) for name in input_.requires if name in topics]
            continue
        named = {attribute(id_): topics[id_] for id_ in topics}
        by_attribute = {attribute(id_): id_ for id_ in found}
        for name in input_.reads:
            word = head_of(name)
            if word in named:
                reads.append((named[word], path_behind(name)))
            elif word in by_attribute:  # another input, which is read by the same expression
                reads += found[by_attribute[word]]
    return found


def _below(
    user: WiredMonitor,
    reads: Sequence[tuple[str, FieldPath]],
    by_topic: Mapping[str, Sequence[PublishedTopic]],
) -> Sequence[str]:
    return [
        claim
        for topic, path in reads
        for item in by_topic.get(topic, ())
        if item.of is not user  # which is refused in any case (K031)
        for claim in _claims(item, path)
    ]


def _claims(item: PublishedTopic, path: FieldPath) -> Sequence[str]:
    """Return the claims that a field carries: the one that it names, else all of the monitor."""
    outputs = item.of.claims
    keys = [str(step.wanted) for step in (item.path or path) if isinstance(step, ByKey)]
    wanted = next(iter(keys), item.part)
    names = [wanted] if wanted in outputs else list(outputs)
    return [item.of.claim(str(name)) for name in names]


@dataclass(frozen=True)
class Accepted:
    """One acceptance in a deployment.

    Attributes:
        monitor: name of the participant.
        what: the acceptance.
        topics: what its input is read from.
        claims: those that rest on it, of any participant.
        place: its place.
    """

    monitor: str
    what: Acceptance
    topics: tuple[str, ...]
    claims: tuple[str, ...]
    place: Place

    def as_json(self) -> dict[str, JsonValue]:
        """Return a row of ``trace --json``."""
        return {
            "monitor": self.monitor,
            "input": self.what.input,
            "key": self.what.key,
            "accepts": self.what.accepts,
            "topics": list(self.topics),
            "claims": list(self.claims),
            "seconds": self.what.seconds,
        }

    def as_text(self) -> str:
        """Return one sentence."""
        who = f"input {self.what.input!r} of {self.monitor}" if self.what.input else self.monitor
        rest = "rests" if len(self.claims) == 1 else "rest"
        on = self.what.accepts + (f" of {', '.join(self.topics)}" if self.topics else "")
        claims = ", ".join(self.claims)
        return f"{who}, `{self.what.key}`: {claims} {rest} on {on} {self.what.lasts}"


def acceptances(participants: Sequence[WiredMonitor]) -> list[Accepted]:
    """Return every acceptance on which a claim rests; claims rest on no ring."""
    users = reversed_graph(supports(participants))
    found = []
    for participant in participants:
        for what in participant.facts.acceptances:
            above = reached(
                users, [participant.claim(name) for name in _outputs(participant, what)]
            )
            if above:
                claims = tuple(claim for claim in users if claim in above)
                topics = tuple(participant.topics(what.input)) if what.input else ()
                found.append(
                    Accepted(participant.name, what, topics, claims, _place(participant, what))
                )
    return found


def check_acceptances(participants: Sequence[WiredMonitor]) -> Iterator[Problem]:
    """Report each acceptance (D009)."""
    for acceptance in acceptances(participants):
        yield problem("D009", acceptance.place, reason=acceptance.as_text())


def _outputs(of: WiredMonitor, one: Acceptance) -> Sequence[str]:
    if one.outputs is not None:
        return one.outputs
    return [
        claim.id
        for claim in of.facts.claims
        if (one.input in claim.rests_on if one.input else claim.rests_on)
    ]


def _place(of: WiredMonitor, one: Acceptance) -> Place:
    if one.at is not None:
        return Place(of.model_file, *one.at)
    return of.config.place(*one.path)

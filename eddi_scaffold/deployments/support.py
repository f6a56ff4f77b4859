"""What each claim rests on, where less is accepted, and rings of claims.

Two ConSerts that feed each other keep each other active for ever after their sources have died:
the messages are fresh, and ages do not help. A ring is one of claims, not of topics: two ConSerts
may well read different guarantees of each other.

Works on what a package remembers of itself, so that a new monitor can be compared with those that
a workspace has already.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from eddi_scaffold.common.claims import Acceptance, Claim, Meanings
from eddi_scaffold.common.graphs import cycles, reached, reversed_graph
from eddi_scaffold.common.identifiers import attribute, full_topic
from eddi_scaffold.common.problems import Place, Problem, problem
from eddi_scaffold.config.field_paths import ByKey, FieldPath, parse_field
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.file import from_data as config_of
from eddi_scaffold.config.schema import SimulatorOutput
from eddi_scaffold.kinds import JsonValue, Kind, kinds
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.compiling import MonitorFacts, from_json
from eddi_scaffold.monitors.expressions import head_of, path_behind
from eddi_scaffold.monitors.publications import publications


@dataclass(frozen=True)
class WiredMonitor:
    """A monitor, as far as rings are concerned."""

    name: str  # for people
    package: str  # its package, which private topics are below
    namespace: str  # of its robot, empty for none
    kind: Kind  # its kind
    config: ConfigFile  # its configuration, given or remembered
    facts: MonitorFacts  # what its package remembers of it
    model_file: str = ""  # of its model, for places
    outputs: Sequence[Output] = ()  # what its node publishes
    bound: BoundMonitor | None = None  # where its model is at hand

    @property
    def frequency(self) -> float:
        """Steps per second."""
        return self.config.config.Model.frequency

    @cached_property
    def claims(self) -> Mapping[str, Claim]:
        """Its claims; the complete result, of the id ``""``, where it names none."""
        return {claim.id: claim for claim in self.facts.claims}

    def meanings(self, part: str | None) -> Meanings:
        """Return what the fields of its messages mean on a topic of one claim, or of all."""
        return self.kind.model_class.meanings(self.facts.claims_on(part))

    def claim(self, output: str) -> str:
        """Return the name of one of its claims among all: its own name, and the output's."""
        return f"{self.name}.{output}" if output else self.name

    def topic(self, name: str) -> str:
        """Return the full name of a topic of this monitor's node."""
        return full_topic(name, self.namespace, self.package)

    def claims_of(self, output: Output, path: FieldPath) -> Sequence[str]:
        """Return the claims that a field of an output carries: the named one, else all."""
        keys = [str(step.key) for step in (output.path or path) if isinstance(step, ByKey)]
        part = next(iter(keys), output.part)
        return [self.claim(str(name)) for name in ([part] if part in self.claims else self.claims)]

    @cached_property
    def topics_read(self) -> Mapping[str, Sequence[tuple[str, FieldPath]]]:
        """Input -> full names of the topics that it reads, with the path into each message."""
        sources = self.config.config.SimulatorOutputs
        topics = {source.id: self.topic(source.topic) for source in sources}
        topic_of = {attribute(id_): topic for id_, topic in topics.items()}
        entries = {entry.id: entry for entry in self.config.config.EDDIInputs}
        reads: dict[str, list[tuple[str, FieldPath]]] = {}
        reads_of: dict[str, list[tuple[str, FieldPath]]] = {}  # by attribute
        for input_ in self.facts.inputs:
            entry = entries.get(input_.id)
            own = reads[input_.id] = reads_of[attribute(input_.id)] = []
            if entry is not None and input_.reads is None:
                path = parse_field(entry.field) if entry.field is not None else ()
                own += [(topics[name], path) for name in input_.requires if name in topics]
            for name in (input_.reads or ()) if entry is not None else ():
                head = head_of(name)
                if head in topic_of:
                    own.append((topic_of[head], path_behind(name)))
                else:  # another input, which is read by the same expression
                    own += reads_of.get(head, [])
        return reads


@dataclass(frozen=True)
class Output:
    """One topic that a monitor publishes."""

    topic: str  # as it is configured
    place: Place
    part: str | None = None  # the only claim of which its messages are
    is_result: bool = True  # it has the result, or a value of its own, and no companion message
    value: str = ""  # the one value that goes there, for people; empty for whole messages
    path: FieldPath = ()  # to that value, where it is known
    type: str = ""  # of its messages, empty where the model is not at hand


Publishers = Mapping[str, Sequence[tuple[WiredMonitor, Output]]]
"""Full name of a topic -> who publishes it."""


def publishers_of(participants: Sequence[WiredMonitor]) -> Publishers:
    """Return who publishes what, in the order of the participants."""
    publishers: dict[str, list[tuple[WiredMonitor, Output]]] = {}
    for participant in participants:
        for output in participant.outputs:
            publishers.setdefault(participant.topic(output.topic), []).append((participant, output))
    return publishers


@dataclass(frozen=True)
class Deployment:
    """Monitors that run together."""

    members: Sequence[WiredMonitor]  # those that are at hand
    others: Sequence[WiredMonitor] = ()  # those that run with them

    @cached_property
    def publishers(self) -> Publishers:
        """Full name of a topic -> who publishes it, members first."""
        return publishers_of(self.participants)

    @property
    def participants(self) -> Sequence[WiredMonitor]:
        """All monitors, as far as a package remembers them."""
        return [*self.members, *self.others]

    def publisher(
        self, member: WiredMonitor, source: SimulatorOutput
    ) -> tuple[WiredMonitor, Output] | None:
        """Return who publishes what a member listens to, ``None`` when nobody does."""
        publishers = self.publishers.get(member.topic(source.topic), ())
        return next((of for of in publishers if of[1].type in ("", source.type)), None)


def wired(monitor: BoundMonitor, namespace: str = "") -> WiredMonitor:
    """Return a monitor that has a configuration, as one of a robot with a namespace."""
    config = monitor.config
    assert config is not None
    outputs = []
    for of in publications(monitor, config)[0]:
        # the topic of a threshold has no field of its own in the configuration
        field = of.output.field or f"evidence[{of.output.id}].active"
        value = f"`{field}` of {of.message}" if of.path else ""
        about = of.output.event, bool(of.path) or not of.of, value, of.path, of.type
        outputs.append(Output(of.output.topic, of.place, *about))
    id_, file = config.config.Model.id, monitor.model.source.name
    name = f"{namespace}/{id_}" if namespace else id_
    names = name, monitor.package, namespace
    return WiredMonitor(*names, monitor.kind, config, monitor.facts, file, outputs, monitor)


def facts_of_package(package: str, answers: Mapping[str, Any]) -> WiredMonitor | None:
    """Return a monitor as the answers of its package have it; ``None`` for other packages."""
    if not answers.get("facts") or not answers.get("config"):
        return None
    try:
        config = config_of(answers["config"], package)
        facts = from_json(answers["facts"])
        kind, file = kinds()[answers["kind"]], str(answers["model_file"])
        place = config.place("EDDIOutputs")
        outputs = [
            Output(f"{output.topic}{end}", place, output.event, not end)
            for output in config.config.EDDIOutputs
            if output.field is None
            for end in ("", "/status", "/evidence")
        ]
        outputs += [
            Output(output["topic_text"], place, value="the same field")
            for output in answers.get("publications") or ()
            if "topic_text" in output and output["type_text"].startswith("std_msgs/")
        ]
        name = config.config.Model.id
        monitor = WiredMonitor(name, package, "", kind, config, facts, file, outputs)
        supports([monitor])  # what it reads can be followed
    except (AttributeError, LookupError, RecursionError, TypeError, ValueError):
        return None
    return monitor


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


def claims_read(
    participants: Sequence[WiredMonitor],
) -> Iterator[tuple[WiredMonitor, Mapping[str, Sequence[str]]]]:
    """Yield each monitor with its inputs, and the claims of other monitors that each one reads."""
    publishers = publishers_of(participants)
    for participant in participants:
        below = {
            name: [
                claim
                for topic, path in reads
                for publisher, output in publishers.get(topic, ())
                if publisher is not participant  # which is refused in any case (K031)
                for claim in publisher.claims_of(output, path)
            ]
            for name, reads in participant.topics_read.items()
        }
        yield participant, below


def supports(participants: Sequence[WiredMonitor]) -> Mapping[str, tuple[str, ...]]:
    """Return for each claim the claims of other monitors that it rests on."""
    return {
        claim: tuple(dict.fromkeys(below for of in inputs.values() for below in of))
        for claim, inputs in supports_of_inputs(participants).items()
    }


def supports_of_inputs(
    participants: Sequence[WiredMonitor],
) -> Mapping[str, Mapping[str, Sequence[str]]]:
    """Return the same for each input that a claim rests on."""
    return {
        participant.claim(claim.id): {
            name: claims for name, claims in below.items() if name in claim.rests_on
        }
        for participant, below in claims_read(participants)
        for claim in participant.facts.claims
    }


@dataclass(frozen=True)
class Accepted:
    """One acceptance in a deployment."""

    monitor: str  # name of the participant
    what: Acceptance  # the acceptance
    topics: tuple[str, ...]  # what its input is read from
    claims: tuple[str, ...]  # those that rest on it, of any participant
    place: Place  # its place

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
    accepted = []
    for monitor in participants:
        for what in monitor.facts.acceptances:
            outputs = what.outputs
            if outputs is None:
                rests = {claim.id: claim.rests_on for claim in monitor.facts.claims}
                outputs = tuple(
                    id_ for id_, on in rests.items() if (what.input in on if what.input else on)
                )
            above = reached(users, map(monitor.claim, outputs))
            if not above:
                continue
            claims = tuple(claim for claim in users if claim in above)
            reads = monitor.topics_read.get(what.input, ()) if what.input else ()
            topics = tuple(dict.fromkeys(topic for topic, _ in reads))
            place = monitor.config.place(*what.path)
            if what.at is not None:
                place = Place(monitor.model_file, *what.at)
            accepted.append(Accepted(monitor.name, what, topics, claims, place))
    return accepted

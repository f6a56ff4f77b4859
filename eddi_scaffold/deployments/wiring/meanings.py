"""Check that each field that is read of a monitor's message depends only on what is known."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from eddi_scaffold.claims import Meaning, Meanings, ValidityField
from eddi_scaffold.config.fields import FieldPath, Index, pattern
from eddi_scaffold.deployments.wiring.deployment import Deployment, Member
from eddi_scaffold.deployments.wiring.readings import Field, FieldReading, readings
from eddi_scaffold.identifiers import attribute
from eddi_scaffold.monitors.knowledge import kind_of_message
from eddi_scaffold.monitors.publications import STATUS
from eddi_scaffold.problems import Problem, error, warning

_UNLISTED = Meaning()


def check_meanings(deployment: Deployment) -> Iterator[Problem]:
    """Report what gains from silence: D001, D002; D007, D008 and D020 are warnings."""
    for member in deployment.members:
        found = readings(member.monitor)
        for input_ in found.inverted:
            yield _inverted(member, input_)
        seen: set[tuple[object, ...]] = set()
        for reading in found.fields:
            for problem in _judge(deployment, member, reading):
                key = (problem.code, problem.message, problem.place)
                if key not in seen:
                    yield problem
                seen.add(key)


def _inverted(member: Member, input_: str) -> Problem:
    ids = [one.id for one in member.config.config.EDDIInputs]
    place = member.config.place("EDDIInputs", ids.index(input_), "polarity")
    message = f"input {input_!r}: `polarity: HAZARD` makes UNKNOWN true, and true is good here"
    hint = "leave `polarity: HAZARD` out: UNKNOWN then stays unknown"
    return error("D002", message, place, hint)


def _judge(deployment: Deployment, member: Member, reading: FieldReading) -> Iterator[Problem]:
    found = _read(deployment, member, (reading.source, reading.path))
    if found is None:
        return
    if any(isinstance(step, Index) for step in found.path):
        text = f"{reading.text!r} takes an element by its place, which may hold another one"
        yield warning("D007", text, reading.place, "take it by its name: [name]")
    meaning = _meaning(found)
    name = f"{attribute(reading.source.id)}{''.join(pattern(reading.path))}"
    if meaning.silent is not None and not any(reading.holds(value) for value in meaning.silent):
        if meaning.bad is not None and list(map(reading.holds, meaning.bad)) == [True, False]:
            text = f"input {reading.input!r} is good while a hazard is there, by {reading.text!r}"
            absent = f"`{name} == {meaning.bad[1]}`: it is known to be absent"
            yield warning("D020", text, reading.place, absent)
        return
    hint = f"read {meaning.instead.format(field=name)}" if meaning.instead else None
    given = [one for one in meaning.given if _is_given(deployment, member, reading, one, found)]
    if not given:
        text = f"input {reading.input!r} gains from silence by {reading.text!r}: {meaning.refused}"
        yield error("D001", text, reading.place, hint)
    elif all(one.message != found.message for one in given):
        text = f"{reading.text!r} and `{given[0].field}` are on two topics, maybe one step apart"
        yield warning("D008", text, reading.place, hint)


@dataclass(frozen=True)
class _Read:
    """A field of a message of ours that is read.

    Attributes:
        publisher: the monitor, or the topic where it is not at hand.
        message: that the field is in, also where its value alone is on the topic.
        path: into that message.
        meanings: what its fields mean.
    """

    publisher: object
    message: str
    path: FieldPath
    meanings: Meanings


def _read(deployment: Deployment, member: Member, field: Field) -> _Read | None:
    """Return which field of a monitor's message is read, ``None`` for other messages."""
    source, path = field
    publisher = deployment.publisher(member, source)
    if publisher is not None:
        one, of = publisher.publication, publisher.member.participant
        meanings = of.kind.functions.meanings(of.document["model"], one.output.event)
        return _Read(of.name, publisher.message, one.path or path, meanings)
    kind, message = kind_of_message(source.type), source.type.partition("/")[2]
    if kind is None:
        return None
    other = deployment.other(member, source)
    if other is not None and other.of.kind is kind:
        meanings = kind.functions.meanings(other.of.document["model"], other.part)
        return _Read(other.of.name, message, path, meanings)
    topic = member.topic(source.topic).removesuffix(f"/{STATUS}")
    return _Read(topic, message, path, kind.functions.meanings(None, None))


def _meaning(read: _Read) -> Meaning:
    """Return what a field means, or what the nearest field around it does."""
    fields = read.meanings.get(read.message, {})
    steps = pattern(read.path)
    for end in range(len(steps), 0, -1):
        name = "".join(steps[:end]).removeprefix(".")
        if name in fields:
            return fields[name]
    return _UNLISTED


def _is_given(
    deployment: Deployment, member: Member, reading: FieldReading, given: ValidityField, of: _Read
) -> bool:
    """Return whether an accompanying test ensures that a field has a meaning."""
    for field, holds in reading.beside:
        if not holds(given.value) or holds(not given.value):
            continue
        found = _read(deployment, member, field)
        if found is not None and _is_at(found, of.publisher, given):
            return True
    return False


def _is_at(read: _Read, publisher: object, given: ValidityField) -> bool:
    field = "".join(pattern(read.path))
    return (read.publisher, read.message, field) == (publisher, given.message, f".{given.field}")

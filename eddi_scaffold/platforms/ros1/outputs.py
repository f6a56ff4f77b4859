"""What a node publishes: the whole result, or one value of it as a message of ``std_msgs``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

from eddi_scaffold.answers import one_line
from eddi_scaffold.binding import Monitor
from eddi_scaffold.config import ConfigFile, Output
from eddi_scaffold.fields import Attribute, ById, FieldPath, Index, parse_field, type_at
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.message_types import FieldsOf, known_messages
from eddi_scaffold.problems import Place, Problem, did_you_mean, error

MESSAGE_PACKAGE = "eddi_messages"
_OF_STD_MSGS = {"bool": "Bool", "float": "Float64", "int": "Int64", "str": "String"}


@dataclass(frozen=True)
class Publication:
    """One topic that a node publishes.

    Attributes:
        output: the entry of ``EDDIOutputs``, or one that the model asks for.
        type: message type (``std_msgs/Bool``).
        place: where its topic is named.
        path: where the value stands in the result; empty for all of it.
    """

    output: Output
    type: str
    place: Place
    path: FieldPath = ()


def publications(monitor: Monitor, config: ConfigFile) -> tuple[list[Publication], list[Problem]]:
    """Return what the node publishes, and what is wrong with the paths (K034)."""
    whole = f"{MESSAGE_PACKAGE}/{monitor.kind.output_message}"
    known = known_messages([monitor.kind])
    found: list[Publication] = []
    problems: list[Problem] = []
    parts = list(monitor.kind.parts(monitor.model))
    for index, output in enumerate(config.config.EDDIOutputs):
        places = partial(config.place, "EDDIOutputs", index)
        if output.event is not None and output.event not in parts:
            hint = did_you_mean(output.event, parts) or f"there are: {', '.join(parts) or 'none'}"
            message = f"the monitor gives no message of {output.event!r} alone"
            problems.append(error("K045", message, places("event"), hint))
            continue
        if output.field is None:
            found.append(Publication(output, whole, places("topic")))
            continue
        try:
            path = parse_field(output.field)
            of = _type_at(path, whole, known)
        except ValueError as problem:
            problems.append(error("K034", str(problem), places("field")))
            continue
        found.append(Publication(output, f"std_msgs/{_OF_STD_MSGS[of]}", places("topic"), path))
    for one in monitor.kind.outputs(monitor.model):
        path = tuple(Attribute(s) if isinstance(s, str) else ById(s[1]) for s in one.path)
        of = _OF_STD_MSGS[_type_at(path, whole, known)]
        output = Output.model_construct(id=one.id, topic=one.topic, field=None, event=None)
        found.append(Publication(output, f"std_msgs/{of}", one.place, path))
    return found, problems


def publication_answers(
    publication: Publication, classes: Mapping[str, str], status: str | None
) -> dict[str, JsonValue]:
    """Return what the template of the node writes for one topic."""
    output, whole = publication.output, not publication.path
    return {
        "id": ascii(output.id),
        "title": one_line(output.id),
        "topic": ascii(output.topic),
        "topic_text": output.topic,
        "type_text": publication.type,
        "message_class": classes[publication.type],
        "status_topic": ascii(f"{output.topic}/status" if status and whole else None),
        "status_class": f"eddi_messages.msg.{status}" if status and whole else "None",
        "more": _more(publication),
    }


def _more(publication: Publication) -> str:
    """Return the arguments that only some publications have."""
    field = f"\n            field={_literal(publication.path)}," if publication.path else ""
    event = publication.output.event
    return field + (f"\n            only={event!a}," if event is not None else "")


def _type_at(path: FieldPath, message: str, known: FieldsOf) -> str:
    """Return the Python type of the value at the end of a path.

    Raises:
        ValueError: the message has no such field, or the path ends too early or too late.
    """
    of = type_at(path, message, known.get)
    if of not in _OF_STD_MSGS:
        raise ValueError(f"the path ends at {of}, not at a single value")
    return of


def _literal(path: FieldPath) -> str:
    return f"({', '.join(_step(step) for step in path)},)"


def _step(step: Attribute | Index | ById) -> str:
    if isinstance(step, Attribute):
        return ascii(step.name)
    return str(step.position) if isinstance(step, Index) else ascii(("id", step.id))

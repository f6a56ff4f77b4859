"""What the template of a ROS 1 node writes for each topic that the monitor publishes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from eddi_scaffold.config.fields import FieldPath, Step, plain_step
from eddi_scaffold.escaping import markdown_code, python_literal
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE, STATUS, Publication


def rows(published: Iterable[Publication]) -> list[Publication]:
    """Return the topics that have a row of their own: all but the status of a result."""
    return [one for one in published if one.of != STATUS or one.path]


def publication_answers(
    publication: Publication, classes: Mapping[str, str], beside: Mapping[str, str]
) -> dict[str, JsonValue]:
    """Return what the template of the node writes for one topic."""
    output, is_result = publication.output, not (publication.path or publication.of)
    status = beside.get(STATUS) if is_result else None
    return {
        "id": python_literal(output.id),
        "title": markdown_code(output.id),
        "topic": python_literal(output.topic),
        "topic_text": output.topic,
        "type_text": publication.type,
        "message_class": classes[publication.type],
        "status_topic": python_literal(f"{output.topic}/{STATUS}" if status else None),
        "status_class": f"{MESSAGE_PACKAGE}.msg.{status}" if status else "None",
        "more": _more(publication),
    }


def _more(publication: Publication) -> str:
    """Return the arguments that only some publications have."""
    event, of = publication.output.event, publication.of
    given = {
        "field": _literal(publication.path) if publication.path else "",
        "only": python_literal(event) if event is not None else "",
        "of": python_literal(of) if of else "",
    }
    return "".join(f"\n            {name}={text}," for name, text in given.items() if text)


def _literal(path: FieldPath) -> str:
    return f"({', '.join(_step(step) for step in path)},)"


def _step(step: Step) -> str:
    plain = plain_step(step)
    return python_literal(tuple(plain) if isinstance(plain, list) else plain)

"""What the packages say of themselves in the MROS languages (docs/reference/mros.md)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from eddi_scaffold.config.message_types import element, fields_of, is_primitive
from eddi_scaffold.config.schema import SimulatorOutput
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE, Publication

_DIAGNOSTICS = ("/diagnostics", "diagnostic_msgs/DiagnosticArray")
_ARROWS = {"publishers": "pub", "subscribers": "sub"}


def interfaces_of(
    published: Iterable[Publication],
    heard: Iterable[SimulatorOutput],
    between_robots: dict[str, str],
) -> list[JsonValue]:
    """Return the sections of a node that are not empty: its topics, each once, sorted."""
    sections = {
        "publishers": dict([*((one.output.topic, one.type) for one in published), _DIAGNOSTICS])
        | between_robots,
        "subscribers": {one.topic: one.type for one in heard} | between_robots,
    }
    return [
        {
            "section": section,
            "topics": [{"topic": name, "type": _named(of)} for name, of in sorted(topics.items())],
        }
        for section, topics in sections.items()
        if topics
    ]


def nodes_of(monitors: Mapping[str, Mapping[str, Any]]) -> list[JsonValue]:
    """Return the nodes of a workspace, but for those that an earlier release made."""
    return [
        {
            "name": name,
            "interfaces": [
                {"direction": _ARROWS[part["section"]], "topic": one["topic"]}
                for part in answers["interfaces"]
                for one in part["topics"]
            ],
        }
        for name, answers in sorted(monitors.items())
        if answers.get("interfaces")
    ]


def specs_of(messages: Mapping[str, str]) -> Sequence[JsonValue]:
    """Return the fields of messages, without comments and constants."""
    return [
        {"name": name, "fields": [_field(*one) for one in fields_of(text, MESSAGE_PACKAGE).items()]}
        for name, text in sorted(messages.items())
    ]


def _field(name: str, type_: str) -> str:
    item = element(type_) or type_
    if item == "std_msgs/Header":
        written = "Header"  # a word of the language, which needs no model of std_msgs
    else:
        written = item if is_primitive(item) else f"'{_named(item)}'"
    return f"{written}{type_.removeprefix(item)} {name}"


def _named(type_: str) -> str:
    """Return a type as in the models: ``std_msgs/msg/Bool``."""
    return type_.replace("/", "/msg/")

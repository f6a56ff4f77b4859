"""Field paths of a configuration: ``data``, ``pose.position.x``, ``guarantees[G0].active``.

A path is parsed here and becomes a Python expression in which only checked names and literals
occur, so text of a configuration never becomes code.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from eddi_scaffold.identifiers import is_identifier
from eddi_scaffold.message_types import Fields, element, is_primitive, python_type
from eddi_scaffold.problems import did_you_mean

_STEP = re.compile(r"\.?(?P<name>[A-Za-z][A-Za-z0-9_]*)|\[(?P<key>[^\[\]\r\n]+)\]")


@dataclass(frozen=True)
class Attribute:
    """Take the field ``name`` of a message."""

    name: str


@dataclass(frozen=True)
class Index:
    """Take one element of a list by position."""

    position: int


@dataclass(frozen=True)
class ById:
    """Take the element of a list whose field ``id`` equals ``id``."""

    id: str


FieldPath = tuple["Attribute | Index | ById", ...]


def parse_field(text: str) -> FieldPath:
    """Parse a field path.

    Raises:
        ValueError: the text is no field path; the message says where and what is expected.
    """
    steps: list[Attribute | Index | ById] = []
    position = 0
    while position < len(text):
        match = _STEP.match(text, position)
        dotted = text[position] == "."
        if match is None or (match["name"] is not None and dotted != bool(steps)):
            expected = "a field name, `.name`, `[index]` or `[id]`"
            raise ValueError(f"column {position + 1} of {text!r}: {expected} is expected")
        if match["key"] is not None:
            if not steps:
                raise ValueError(f"{text!r}: a path begins with a field name")
            key = match["key"]
            steps.append(Index(int(key)) if re.fullmatch(r"[0-9]{1,6}", key) else ById(key))
        else:
            name = match["name"]
            if not is_identifier(name):
                raise ValueError(f"{text!r}: {name!r} cannot be the name of a field")
            steps.append(Attribute(name))
        position = match.end()
    if not steps:
        raise ValueError("the path is empty")
    return tuple(steps)


def type_at(path: FieldPath, message: str, fields_of: Callable[[str], Fields | None]) -> str | None:
    """Return the Python type, or the message type, of the value at the end of a path.

    Args:
        path: into the message.
        message: type of the message.
        fields_of: message type -> its fields, ``None`` when they are not known.

    Returns:
        ``None`` where a type on the way is not known.

    Raises:
        ValueError: the path leads nowhere; the message says where it ends and lists the fields.
    """
    of = message
    for step in path:
        inner = element(of)
        if not isinstance(step, Attribute):
            if inner is None:
                raise ValueError(f"{of} is no list")
            of = inner
            continue
        if inner is not None:
            message = f"{of} is a list; one element of it is [0]"
            raise ValueError(f"{message}, or [id] where the elements have ids")
        if is_primitive(of):
            raise ValueError(f"a {of} has no field {step.name!r}: the path ends before")
        known = fields_of(of)
        if known is None:
            return None
        if step.name not in known:
            listed = ", ".join(known) or "none"
            near = did_you_mean(step.name, known)
            hint = f"{near} its fields: {listed}" if near else f"its fields: {listed}"
            raise ValueError(f"{of} has no field {step.name!r}; {hint}")
        of = known[step.name]
    return python_type(of)


def expression(variable: str, path: FieldPath) -> str:
    """Return the Python expression that takes ``path`` from the message in ``variable``."""
    text = variable
    for step in path:
        if isinstance(step, Attribute):
            text = f"{text}.{step.name}"
        elif isinstance(step, Index):
            text = f"{text}[{step.position}]"
        else:
            text = f"by_id({text}, {step.id!a})"
    return text

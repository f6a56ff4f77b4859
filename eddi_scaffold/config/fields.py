"""Field paths of a configuration: ``data``, ``pose.position.x``, ``guarantees[G0].active``.

A path is parsed here and becomes a Python expression in which only checked names and literals
occur, so text of a configuration never becomes code. What the messages define of it, such as which
field is the key of ``[G0]``, is found in ``field_types``.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from eddi_scaffold.escaping import python_literal
from eddi_scaffold.identifiers import is_identifier, key_text
from eddi_scaffold.problems import HintedError

_STEP = re.compile(
    r"""\.?(?P<name>[A-Za-z][A-Za-z0-9_]*)
      | \[(?:(?P<field>[A-Za-z][A-Za-z0-9_.]*)=)?
          (?:"(?P<quoted>[^"\r\n]+)"|(?P<key>[^\[\]"=\r\n]+))\]""",
    re.VERBOSE,
)
_PART = re.compile(r"([0-9]{1,6})\.\.([0-9]{1,6})")
_INDEX = re.compile(r"[0-9]{1,6}")


@dataclass(frozen=True)
class Attribute:
    """Take the field ``name`` of a message."""

    name: str


@dataclass(frozen=True)
class Index:
    """Take one element of a list by position."""

    position: int


@dataclass(frozen=True)
class ByKey:
    """Take the only element of a list whose key is ``wanted``.

    Attributes:
        wanted: text, or a number where the field is one.
        field: which field is the key (``title``, ``header.frame_id``); ``None``: not given.
    """

    wanted: str | int
    field: str | None = None


@dataclass(frozen=True)
class Beside:
    """Take the element of a list at the position of its name in a parallel list.

    Attributes:
        wanted: the name.
        values: the field with the numbers.
        names: the field with the names.
    """

    wanted: str
    values: str
    names: str


@dataclass(frozen=True)
class Every:
    """Take all elements of a list, or those from ``part[0]`` to ``part[1]``, both included."""

    part: tuple[int, int] | None = None


class FieldPathError(HintedError):
    """A text is not a field path, or the path leads nowhere in its message."""


Step = Attribute | Index | ByKey | Beside | Every
FieldPath = tuple[Step, ...]
PlainStep = str | int | list[str | int]
"""A step as ``eddi_runtime.access.follow`` takes it."""


def parse_field(text: str, *, lists: bool = False) -> FieldPath:
    """Parse a field path.

    Args:
        text: the path.
        lists: ``[*]`` and ``[2..5]`` are allowed in it.

    Raises:
        FieldPathError: the text is not a field path; the message has column and expectation.
    """
    steps: list[Step] = []
    position = 0
    while position < len(text):
        match = _STEP.match(text, position)
        dotted = text[position] == "."
        if match is None or (match["name"] is not None and dotted != bool(steps)):
            expected = "a field name, `.name`, `[index]` or `[key]`"
            raise FieldPathError(f"column {position + 1} of {text!r}: {expected} is expected")
        name = match["name"]
        if name is None:
            if not steps:
                raise FieldPathError(f"{text!r}: a path begins with a field name")
            steps.append(_element(match))
            if isinstance(steps[-1], Every) and not lists:
                hint = "reduce it in `expression:`, for example MIN(scan.ranges[*])"
                raise FieldPathError(f"{text!r} is a list, `field:` takes one value", hint)
        elif not is_identifier(name):
            raise FieldPathError(f"{text!r}: {name!r} cannot be the name of a field")
        else:
            steps.append(Attribute(name))
        position = match.end()
    if not steps:
        raise FieldPathError("the path is empty")
    return tuple(steps)


def _element(match: re.Match[str]) -> Index | ByKey | Every:
    field, key = match["field"], match["key"]
    if key is None:
        return ByKey(match["quoted"], field)
    part = _PART.fullmatch(key)
    if field is None and (part or key == "*"):
        return Every((int(part[1]), int(part[2])) if part else None)
    if _INDEX.fullmatch(key):
        return Index(int(key)) if field is None else ByKey(int(key), field)
    return ByKey(key, field)


def path_text(path: Sequence[Step]) -> str:
    """Return a path as a person writes it, keys in quotes where they are not words."""
    return "".join(_step_text(step) for step in path).removeprefix(".")


def _step_text(step: Step) -> str:
    if isinstance(step, Attribute):
        return f".{step.name}"
    if isinstance(step, Index):
        return f"[{step.position}]"
    if isinstance(step, Every):
        return "[*]" if step.part is None else f"[{step.part[0]}..{step.part[1]}]"
    if isinstance(step, Beside):
        return f".{step.values}[{key_text(step.wanted)}]"
    return f"[{f'{step.field}=' if step.field else ''}{key_text(step.wanted)}]"


def pattern(path: FieldPath) -> list[str]:
    """Return a path without the keys of its lists: ``.guarantees``, ``[]``, ``.active``."""
    steps: list[str] = []
    for step in path:
        if isinstance(step, Attribute):
            steps.append(f".{step.name}")
        elif isinstance(step, Beside):
            steps += [f".{step.values}", "[]"]
        else:
            steps.append("[]")
    return steps


def expression(variable: str, path: FieldPath) -> str:
    """Return the Python expression that takes ``path`` from the message in ``variable``."""
    text = variable
    for step in path:
        if isinstance(step, Attribute):
            text = f"{text}.{step.name}"
        elif isinstance(step, Index):
            text = f"{text}[{step.position}]"
        elif isinstance(step, Every):
            raise TypeError("a list is not a single value")
        elif isinstance(step, Beside):
            text = (
                f"by_name({text}.{step.values}, {text}.{step.names}, {python_literal(step.wanted)})"
            )
        elif step.field in (None, "id"):
            text = f"by_id({text}, {python_literal(step.wanted)})"
        else:
            text = f"by_key({text}, {python_literal(step.field)}, {python_literal(step.wanted)})"
    return text


def plain_step(step: Step) -> PlainStep:
    """Return a step as plain data."""
    if isinstance(step, Attribute):
        return step.name
    if isinstance(step, Index):
        return step.position
    if isinstance(step, Every):
        return ["*", *(step.part or ())]
    if isinstance(step, Beside):
        return [step.values, step.names, step.wanted]
    return [step.field or "id", step.wanted]

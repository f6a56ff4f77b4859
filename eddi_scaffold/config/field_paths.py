"""Field paths of a configuration, by themselves and against the messages they lead into.

In the Python expression of a path only checked names and literals occur, so text of a configuration
never becomes code.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace

from eddi_scaffold.common.escaping import python_literal
from eddi_scaffold.common.identifiers import is_identifier
from eddi_scaffold.common.problems import HintedError
from eddi_scaffold.config.field_types import Fields, element, is_primitive, python_type

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
    """Take the only element of a list that has a key."""

    key: str | int  # text, or a number where the field is one
    # which field is the key (`title`, `header.frame_id`); `None`: not given
    field: str | None = None


@dataclass(frozen=True)
class ByName:
    """Take the element of a list at the position of its name in a parallel list."""

    key: str  # the name
    values: str  # the field with the numbers
    names: str  # the field with the names


@dataclass(frozen=True)
class Every:
    """Take all elements of a list, or those from ``part[0]`` to ``part[1]``, both included."""

    part: tuple[int, int] | None = None


class FieldPathError(HintedError):
    """A text is not a field path, or the path leads nowhere in its message."""


Step = Attribute | Index | ByKey | ByName | Every
FieldPath = tuple[Step, ...]
PlainStep = str | int | list[str | int]  # a step as `eddi_runtime.plain_values.follow` takes it


def parse_field(text: str, *, lists: bool = False) -> FieldPath:
    """Parse a field path; ``lists``: ``[*]`` and ``[2..5]`` are allowed in it.

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
                hint = "reduce it in a condition, for example MIN(scan.ranges[*])"
                raise FieldPathError(f"{text!r} is a list, one value is expected", hint)
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


def pattern(path: FieldPath) -> list[str]:
    """Return a path without the keys of its lists: ``.guarantees``, ``[]``, ``.active``."""
    parts: list[str] = []
    for step in path:
        if isinstance(step, Attribute):
            parts.append(f".{step.name}")
        else:
            parts += [f".{step.values}", "[]"] if isinstance(step, ByName) else ["[]"]
    return parts


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
        elif isinstance(step, ByName):
            text = f"by_name({text}.{step.values}, {text}.{step.names}, {python_literal(step.key)})"
        elif step.field in (None, "id"):
            text = f"by_id({text}, {python_literal(step.key)})"
        else:
            text = f"by_key({text}, {python_literal(step.field)}, {python_literal(step.key)})"
    return text


def plain_step(step: Step) -> PlainStep:
    """Return a step as plain data."""
    if isinstance(step, Attribute):
        return step.name
    if isinstance(step, Index):
        return step.position
    if isinstance(step, Every):
        return ["*", *(step.part or ())]
    if isinstance(step, ByName):
        return [step.values, step.names, step.key]
    return [step.field or "id", step.key]


KEYS = (
    *("id", "name", "title", "outcome_name", "key", "joint_name", "label"),
    *("child_frame_id", "header.frame_id"),
)
"""Fields that name an element: the first of them that is a text counts."""
NAME_LISTS = ("name", "names", "joint_names", "labels")
"""Fields that name the numbers in a list of the same message."""
_INTEGERS = ("int", "uint", "byte", "char")
FieldsOf = Callable[[str], Fields | None]


@dataclass(frozen=True)
class ResolvedPath:
    """A path with its keys, and what is at its end."""

    path: FieldPath  # each key names its field, as far as the messages are known
    # the Python type, or the message type; `None` where a type on the way is not known
    type: str | None


def resolve(path: FieldPath, message: str, fields_of: FieldsOf) -> ResolvedPath:
    """Return the path with its keys, and the type at its end.

    Raises:
        FieldPathError: the path leads nowhere; the message reports where it ends, with the fields.
    """
    taken: list[Step] = []
    of, parent = message, message
    for number, step in enumerate(path):
        inner = element(of)
        if isinstance(step, Attribute):
            if inner is not None:
                hint = "one element of it is [0], or [key] where the elements have names"
                raise FieldPathError(f"{of} is a list", hint)
            if is_primitive(of):
                raise FieldPathError(f"a {of} has no field {step.name!r}: the path ends before")
            known = fields_of(of)
            if known is None:
                return ResolvedPath((*taken, *path[number:]), None)
            if step.name not in known:
                raise _no_field(of, step.name, known)
            of, parent = known[step.name], of
            taken.append(step)
            continue
        if inner is None:
            raise FieldPathError(f"{of} is not a list")
        if isinstance(step, ByKey):
            keyed = _keyed(step, inner, parent, taken[-1], fields_of)
            # The list of numbers and the name in it are one step.
            taken[len(taken) - isinstance(keyed, ByName) :] = [keyed]
        else:
            taken.append(step)
        of = inner
    return ResolvedPath(tuple(taken), python_type(of))


def _no_field(of: str, name: str, known: Fields) -> FieldPathError:
    hint = f"its fields: {', '.join(known) or 'none'}"
    return FieldPathError(f"{of} has no field {name!r}", hint)


def _keyed(step: ByKey, inner: str, parent: str, before: Step, fields_of: FieldsOf) -> Step:
    """Return the step with its key; the elements are messages, or numbers with a list of names."""
    assert isinstance(before, Attribute)  # ROS has no lists of lists
    if is_primitive(inner):
        known = fields_of(parent) or {}
        names = [name for name in NAME_LISTS if (known.get(name) or "").startswith("string[")]
        if step.field is None and len(names) == 1 and names[0] != before.name:
            return ByName(str(step.key), before.name, names[0])
        message = f"{parent} has no list of names ({', '.join(NAME_LISTS)}) for {before.name!r}"
        raise FieldPathError(message, f"one element is [0]; its fields: {', '.join(known)}")
    fields = fields_of(inner)
    if fields is None:
        return step
    if step.field is None:
        for key in KEYS:
            if _type_of(key, inner, fields_of) == "string":
                return replace(step, field=key)
        message = f"the elements are {inner}, which have no name that [{step.key}] could be"
        hint = f'name the field, [field="{step.key}"], of: {", ".join(fields)}'
        raise FieldPathError(message, hint)
    of = _type_of(step.field, inner, fields_of)  # of the field that a person names as the key
    if of is None:
        raise _no_field(inner, step.field, fields)
    if of == "string":
        return replace(step, key=str(step.key))
    if isinstance(step.key, str) or not of.startswith(_INTEGERS) or of.endswith("]"):
        raise FieldPathError(f"{step.field!r} of {inner} is a {of}, {step.key!r} is no such key")
    return step


def _type_of(path: str, message: str, fields_of: FieldsOf) -> str | None:
    """Return the type of a field, ``a.b`` of a field's field; ``None`` when there is none."""
    of: str | None = message
    for name in path.split("."):
        of = (fields_of(of) or {}).get(name) if of is not None else None
    return of

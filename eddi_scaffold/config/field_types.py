"""Field paths against messages: what is at their end, and which field the key of ``[G0]`` is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from eddi_scaffold.config.fields import (
    Attribute,
    Beside,
    ByKey,
    FieldPath,
    FieldPathError,
    Index,
    Step,
)
from eddi_scaffold.config.message_types import Fields, element, is_primitive, python_type
from eddi_scaffold.config.message_types.documented import Documented, documented
from eddi_scaffold.problems import did_you_mean

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
    """A path with its keys, and what is at its end.

    Attributes:
        path: each key names its field, as far as the messages are known.
        type: the Python type, or the message type; ``None`` where a type on the way is not known.
    """

    path: FieldPath
    type: str | None


def resolve(path: FieldPath, message: str, fields_of: FieldsOf) -> ResolvedPath:
    """Return the path with its keys, and the type at its end.

    Args:
        path: into the message.
        message: type of the message.
        fields_of: message type -> its fields, ``None`` when they are not known.

    Raises:
        FieldPathError: the path leads nowhere; the message reports where it ends, with the fields.
    """
    taken: list[Step] = []
    of, parent = message, message
    for number, step in enumerate(path):
        if isinstance(step, Attribute):
            known = _fields_at(of, step.name, fields_of)
            if known is None:
                return ResolvedPath((*taken, *path[number:]), None)
            of, parent = known[step.name], of
            taken.append(step)
            continue
        inner = element(of)
        if inner is None:
            raise FieldPathError(f"{of} is not a list")
        if isinstance(step, ByKey):
            found = _keyed(step, inner, parent, taken[-1], fields_of)
            # The list of numbers and the name in it are one step.
            taken[len(taken) - isinstance(found, Beside) :] = [found]
        else:
            taken.append(step)
        of = inner
    return ResolvedPath(tuple(taken), python_type(of))


def documented_at(path: FieldPath, message: str, fields_of: FieldsOf) -> Documented | None:
    """Return the documentation of the field at the end of a path that has its keys."""
    names: list[str] = []
    for step in path:
        if isinstance(step, Attribute):
            names.append(step.name)
        elif isinstance(step, Beside):
            names.append(f"{step.values}[]")
        else:
            names[-1] += f"[{step.position}]" if isinstance(step, Index) else "[]"
    return documented(message, names, fields_of)


def _fields_at(of: str, name: str, fields_of: FieldsOf) -> Fields | None:
    """Return the fields of a message that has this one, ``None`` when they are not known."""
    if element(of) is not None:
        hint = "one element of it is [0], or [key] where the elements have names"
        raise FieldPathError(f"{of} is a list", hint)
    if is_primitive(of):
        raise FieldPathError(f"a {of} has no field {name!r}: the path ends before")
    known = fields_of(of)
    if known is not None and name not in known:
        raise FieldPathError(f"{of} has no field {name!r}", _listed(name, known))
    return known


def _keyed(step: ByKey, inner: str, parent: str, before: Step, fields_of: FieldsOf) -> Step:
    """Return the step with its key; the elements are messages, or numbers with a list of names."""
    assert isinstance(before, Attribute)  # ROS has no lists of lists
    if is_primitive(inner):
        return _beside(step, parent, before, fields_of)
    known = fields_of(inner)
    if known is None:
        return step
    if step.field is not None:
        return _with_key_of(step, inner, fields_of)
    for key in KEYS:
        if _type_of(key, inner, fields_of) == "string":
            return replace(step, field=key)
    message = f"the elements are {inner}, which have no name that [{step.wanted}] could be"
    hint = f'name the field, [field="{step.wanted}"], of: {", ".join(known)}'
    raise FieldPathError(message, hint)


def _with_key_of(step: ByKey, inner: str, fields_of: FieldsOf) -> ByKey:
    """Check the field that a person names as the key."""
    assert step.field is not None
    of = _type_of(step.field, inner, fields_of)
    if of is None:
        known = fields_of(inner) or {}
        raise FieldPathError(f"{inner} has no field {step.field!r}", _listed(step.field, known))
    if of == "string":
        return replace(step, wanted=str(step.wanted))
    if not of.startswith(_INTEGERS) or of.endswith("]"):
        raise FieldPathError(
            f"{step.field!r} of {inner} is a {of}: a key is a text or a whole number"
        )
    if type(step.wanted) is str:
        raise FieldPathError(
            f"{step.field!r} of {inner} is a {of}, {step.wanted!r} is not a whole number"
        )
    return step


def _beside(step: ByKey, parent: str, before: Attribute, fields_of: FieldsOf) -> Beside:
    known = fields_of(parent) or {}
    names = [name for name in NAME_LISTS if (known.get(name) or "").startswith("string[")]
    if step.field is None and len(names) == 1 and names[0] != before.name:
        return Beside(str(step.wanted), before.name, names[0])
    message = f"{parent} has no list of names ({', '.join(NAME_LISTS)}) for {before.name!r}"
    raise FieldPathError(message, f"one element is [0]; its fields: {', '.join(known)}")


def _type_of(path: str, message: str, fields_of: FieldsOf) -> str | None:
    """Return the type of a field, ``a.b`` of a field's field; ``None`` when there is none."""
    of: str | None = message
    for name in path.split("."):
        of = (fields_of(of) or {}).get(name) if of is not None else None
    return of


def _listed(name: str, known: Fields) -> str:
    listed = f"its fields: {', '.join(known) or 'none'}"
    near = did_you_mean(name, known)
    return f"{near} {listed}" if near else listed

"""The digest of all that decides what a monitor computes: robots know models by it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import MISSING, Field, fields, is_dataclass
from enum import Enum
from fractions import Fraction
from functools import cache
from typing import Any

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Place, Problem

_FOR_PEOPLE = {"about", "at", "description"}  # Fields that nothing computes with


def digest_of(*parts: object) -> str:
    """Return the SHA-256 of values: id, kind, typed model, options and bound inputs of a monitor.

    It is not over the lines that are compiled of them. Places, files, callables and descriptions
    are left out, and so are fields with ``compare=False`` and those with their default value. So a
    release that adds a field, or compiles to other lines, gives the same digest; one that renames a
    field or class of a typed model does not.

    Raises:
        TypeError: a value has no text.
    """
    return hashlib.sha256(_text(parts).encode()).hexdigest()


def _text(value: Any) -> str:
    """Return a text that differs for values that differ; empty for what decides nothing."""
    if hasattr(value, "dtype"):  # of numpy, which is not imported for it
        if value.shape:
            return f"array({value.shape}, {value.dtype.str}, {_text(value.tobytes())})"
        value = value.item()
    if isinstance(value, Enum):
        return f"{type(value).__name__}.{value.name}"
    if isinstance(value, str):
        return json.dumps(value)
    if value is None or isinstance(value, bool | int | float | Fraction):
        return repr(value)
    if isinstance(value, bytes):
        return f"bytes({hashlib.sha256(value).hexdigest()})"
    if isinstance(value, Place | Source | Problem) or callable(value):
        return ""
    if is_dataclass(value) or hasattr(value, "_fields"):
        texts = [
            (name, _text(getattr(value, name)), usual) for name, usual in _fields(value.__class__)
        ]
        decisive = (f"{name}={text}" for name, text, usual in texts if text not in ("", usual))
        return f"{type(value).__name__}({', '.join(decisive)})"
    if isinstance(value, Mapping):
        rows = value.items()  # the order is that of every output
        return f"{{{', '.join(f'{_text(key)}: {_text(item)}' for key, item in rows)}}}"
    if isinstance(value, AbstractSet):
        return f"{{{', '.join(sorted(map(_text, value)))}}}"
    if isinstance(value, list | tuple):
        if {*map(type, value)} == {float}:  # a table of a network has up to 262,144
            return repr(tuple(value))
        return f"({', '.join(map(_text, value))})"
    raise TypeError(f"a model has a value of the type {type(value).__name__}")


@cache
def _fields(type_: Any) -> Sequence[tuple[str, str]]:
    """Return the fields that decide, by name, each with the text of its default."""
    if is_dataclass(type_):
        usual = {field.name: _default(field) for field in fields(type_) if field.compare}
    else:
        usual = {name: type_._field_defaults.get(name, MISSING) for name in type_._fields}
    return [
        (name, "" if default is MISSING else _text(default))
        for name, default in sorted(usual.items(), key=lambda item: item[0])
        if name not in _FOR_PEOPLE
    ]


def _default(field: Field[Any]) -> Any:
    return field.default if field.default_factory is MISSING else field.default_factory()

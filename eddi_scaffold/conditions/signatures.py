"""Types of what operations and functions take and give."""

from __future__ import annotations

from collections.abc import Mapping

from eddi_scaffold.conditions.scope import BOOL, NUMBER, TEXT, Type
from eddi_scaffold.conditions.syntax import REDUCTIONS
from eddi_scaffold.program.builder import SIGNATURES
from eddi_scaffold.program.lists import TRUTHS

_KINDS = {"number": NUMBER, "bool": BOOL}
_NUMBERS = (NUMBER, NUMBER, NUMBER)
_MORE: Mapping[str, tuple[tuple[Type, ...], Type]] = {
    "hypot": (_NUMBERS[:2], NUMBER),
    "clamp": (_NUMBERS, NUMBER),
    "number_of": ((TEXT,), NUMBER),
    **{
        op: ((BOOL, NUMBER, NUMBER), NUMBER if op == "list_count" else BOOL)
        if op in TRUTHS
        else (_NUMBERS, NUMBER)
        for op in REDUCTIONS.values()
    },
}
"""What the text has and the intermediate form has not; limits follow a list."""


def arguments_of(op: str) -> tuple[Type, ...]:
    """Return the types of the arguments of an operation with values of one type each."""
    if op in _MORE:
        return _MORE[op][0]
    return tuple(_KINDS[kind] for kind in SIGNATURES[op][0]) if op in SIGNATURES else ()


def result_of(op: str) -> Type:
    """Return the type of an operation's value."""
    return _MORE[op][1] if op in _MORE else _KINDS[SIGNATURES[op][1]]

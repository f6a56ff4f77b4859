"""Violations of the schema as problems: with a place, and in words for people."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from pydantic import ValidationError

from eddi_scaffold.config.file import KEY
from eddi_scaffold.config.schema import known_keys
from eddi_scaffold.problems import HintedError, Place, Problem, did_you_mean, error

_TEXTS = {
    "bool_type": "true or false is expected",
    "dict_type": "a map is expected",
    "int_type": "a whole number is expected",
    "list_type": "a list is expected, such as [first, second]",
    "model_type": "a map is expected",
    "string_type": "a text is expected",
    "too_short": "a text is expected, not nothing",
}
"""Messages in place of pydantic's, which address programmers."""


def violations(
    failed: ValidationError, places: Mapping[tuple[str | int, ...], Place], file: str
) -> Iterable[Problem]:
    """Turn pydantic's findings into problems with a place, one per value."""
    seen: set[tuple[str | int, ...]] = set()
    for found in failed.errors():
        path = tuple(found["loc"])
        while path and path not in places:
            path = path[:-1]
        if path in seen and found["type"] != "missing":
            continue
        seen.add(path)
        place = places.get(path, Place(file))
        key = str(found["loc"][-1])
        if found["type"] == "missing":
            yield error("K003", f"{_named_path(path) or 'the file'} has no {key!r}", place)
        elif found["type"] == "extra_forbidden":
            known = known_keys(path[:-1])
            hint = did_you_mean(key, known) or f"known keys: {', '.join(sorted(known))}"
            if not key.isidentifier() and (*path[:-1], "expression") in places:
                hint = "put the expression in quotes: inside { } a comma ends it"
            yield error("K004", f"unknown key {key!r}", places.get((*path, KEY), place), hint)
        else:
            raised = found.get("ctx", {}).get("error")  # by our own checks
            own, hint = _TEXTS.get(found["type"]) or str(raised or found["msg"]), None
            if len(found["loc"]) > len(path):  # one of several types that would do
                own = "true, false, a number or a text is expected"
            elif isinstance(raised, HintedError):
                hint = raised.hint
            own = own.replace("Input should be", "must be")  # of pydantic, for a literal
            yield error("K005", f"{_named_path(path) or 'the file'}: {own}", place, hint)


def _named_path(path: Sequence[str | int]) -> str:
    """Name a value by its keys; the place identifies the entry of a list."""
    return ".".join(part for part in path if isinstance(part, str))

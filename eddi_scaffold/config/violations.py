"""Violations of the schema as problems: with a place, and in words for people."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

from pydantic import ValidationError

from eddi_scaffold.config.file import KEY
from eddi_scaffold.config.schema import known_keys
from eddi_scaffold.positioned_yaml.typography import advice
from eddi_scaffold.problems import HintedError, Place, Problem, did_you_mean, error, nearest

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
    failed: ValidationError,
    places: Mapping[tuple[str | int, ...], Place],
    file: str,
    keys_of: Callable[[tuple[str | int, ...]], set[str]] = known_keys,
) -> Iterable[Problem]:
    """Turn pydantic's findings into problems with a place, one per value.

    Args:
        failed: the findings.
        places: of the values.
        file: for what has no place.
        keys_of: path of a section -> the keys that it has.
    """
    seen: set[tuple[str | int, ...]] = set()
    extra = [one["loc"] for one in failed.errors() if one["type"] == "extra_forbidden"]
    meant = {(*loc[:-1], nearest(str(loc[-1]), keys_of(loc[:-1]))) for loc in extra}
    for found in failed.errors():
        path = tuple(found["loc"])
        while path and path not in places:
            path = path[:-1]
        if found["type"] == "missing" and found["loc"] in meant:
            continue  # told where it is misspelt
        if path in seen and found["type"] != "missing":
            continue
        seen.add(path)
        place = places.get(path, Place(file))
        key = str(found["loc"][-1])
        if found["type"] == "missing":
            yield error("K003", f"{_named_path(path) or 'the file'} has no {key!r}", place)
        elif found["type"] == "extra_forbidden":
            known = keys_of(path[:-1])
            hint = did_you_mean(key, known) or f"known keys: {', '.join(sorted(known))}"
            if not key.isidentifier() and _key_before(path, places) == "expression":
                hint = "put the expression in quotes: inside { } a comma ends it"
            else:
                hint = hint_for_decimals(key) or advice(key) or hint
            yield error("K004", f"unknown key {key!r}", places.get((*path, KEY), place), hint)
        else:
            raised = found.get("ctx", {}).get("error")  # by our own checks
            own, hint = _TEXTS.get(found["type"]) or str(raised or found["msg"]), None
            if len(found["loc"]) > len(path):  # one of several types that would do
                own = "true, false, a number or a text is expected"
            elif isinstance(raised, HintedError):
                hint = raised.hint
            hint = hint or advice(str(found["input"]))
            own = own.replace("Input should be", "must be")  # of pydantic, for a literal
            yield error("K005", f"{_named_path(path) or 'the file'}: {own}", place, hint)


def hint_for_decimals(key: str) -> str | None:
    """Return the hint for a key that is what stood behind the comma of a number."""
    if not key[:1].isdecimal():
        return None
    return "a number has a decimal point: inside { } a comma ends it"


def _key_before(
    path: tuple[str | int, ...], places: Mapping[tuple[str | int, ...], Place]
) -> str | int | None:
    """Return the key that stands before one of the same map, passing over what has no name."""
    keys = [one[-2] for one in places if one[-1:] == (KEY,) and one[:-2] == path[:-1]]
    before = keys[: keys.index(path[-1])] if path[-1] in keys else []
    return next((key for key in reversed(before) if str(key).isidentifier()), None)


def _named_path(path: Sequence[str | int]) -> str:
    """Name a value by its keys; the place identifies the entry of a list."""
    return ".".join(part for part in path if isinstance(part, str))

"""Values of a YAML file with their places, and what a form finds wrong with them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from eddi_scaffold.common.identifiers import TODO
from eddi_scaffold.common.problems import (
    HintedError,
    Place,
    Problem,
    did_you_mean,
    most_similar,
    problem,
)
from eddi_scaffold.yaml_text.nodes import Items, Map, Node, as_text, value_11

KEY = -1  # last part of the path under which the place of a key is noted, not that of its value
Path = tuple[str | int, ...]  # keys and numbers of entries that lead to a value
Places = dict[Path, Place]  # path of a value -> its place; with KEY at the end, that of its key
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
_AGE = "write seconds, about 2.5 periods of the topic, or give `connect` a recording: --bag"
_OTHER = "write it in place of TODO; comments of `connect` say what fits"


def plain_values(node: Node, places: Places, path: Path = ()) -> Any:
    """Turn a node graph into plain values of YAML 1.1; note the place of each."""
    places[path] = node.place
    if isinstance(node, Items):
        return [plain_values(item, places, (*path, k)) for k, item in enumerate(node.items)]
    if not isinstance(node, Map):
        return value_11(node)
    result = {}
    for key, value in node.entries:
        inner = (*path, key.text)
        result[key.text] = plain_values(value, places, inner)
        places[(*inner, KEY)] = key.place
        if isinstance(value, Map | Items):
            places[inner] = key.place
    return result


def place_of(places: Mapping[Path, Place], path: Path, file: str) -> Place:
    """Return the place of a part, or of the smallest part that holds it."""
    held = (places[path[:end]] for end in range(len(path), -1, -1) if path[:end] in places)
    return next(held, Place(file))


def keys_at(form: type[BaseModel], path: Path) -> dict[str, Any]:
    """Return the keys of the section at a path with their types; none where there is no section."""
    forms = [form]
    for part in path:
        if isinstance(part, str):
            inner = [keys[part] for of in forms if part in (keys := keys_at(of, ()))]
            forms = [section for type_ in inner for section in _sections(type_)]
    fields = forms[0].model_fields if forms else {}
    return {field.alias or name: field.annotation for name, field in fields.items()}


def _sections(type_: Any) -> Iterator[type[BaseModel]]:
    if isinstance(type_, type) and issubclass(type_, BaseModel):
        yield type_
    for part in get_args(type_):
        yield from _sections(part)


def violations(
    failed: ValidationError, places: Mapping[Path, Place], file: str, form: type[BaseModel]
) -> Iterator[Problem]:
    """Turn pydantic's findings into problems with a place, one per value (K003)."""
    errors = failed.errors()
    unknown = [error["loc"] for error in errors if error["type"] == "extra_forbidden"]
    misspelt = {(*loc[:-1], most_similar(str(loc[-1]), keys_at(form, loc[:-1]))) for loc in unknown}
    seen: set[Path] = set()
    for error in errors:
        path = loc = tuple(error["loc"])
        while path and path not in places:
            path = path[:-1]
        is_missing = error["type"] == "missing"
        if (is_missing and loc in misspelt) or (path in seen and not is_missing):
            continue  # a missing key is told where it is misspelt
        seen.add(path)
        place, key = places.get(path, Place(file)), str(loc[-1])
        named = ".".join(part for part in path if isinstance(part, str)) or "the file"
        if is_missing:
            yield problem("K003.missing_key", place, section=named, key=key)
        elif error["type"] == "extra_forbidden":
            place = places.get((*path, KEY), place)
            hint = _hint_for_key(key, path, places, keys_at(form, path[:-1]))
            yield problem("K003.unknown_key", place, hint=hint, key=key)
        else:
            raised = error.get("ctx", {}).get("error")  # by our own checks
            reason, hint = _TEXTS.get(error["type"]) or str(raised or error["msg"]), None
            if len(loc) > len(path):  # one of several types that would do
                reason = "true, false, a number or a text is expected"
            elif isinstance(raised, HintedError):
                hint = raised.hint
            reason = reason.replace("Input should be", "must be")  # of pydantic, for a literal
            yield problem("K003.value", place, hint=hint, key=named, reason=reason)


def _hint_for_key(
    key: str, path: Path, places: Mapping[Path, Place], known: Mapping[str, Any]
) -> str:
    if not key.isidentifier():  # a part of an expression, whose key stands before it?
        siblings = [at[-2] for at in places if at[-1:] == (KEY,) and at[:-2] == path[:-1]]
        before = siblings[: siblings.index(path[-1])] if path[-1:] and path[-1] in siblings else []
        if [name for name in before if str(name).isidentifier()][-1:] == ["expression"]:
            return "put the expression in quotes: inside { } a comma ends it"
    known_keys = f"known keys: {', '.join(sorted(known))}"
    return hint_for_decimals(key) or did_you_mean(key, known) or known_keys


def hint_for_decimals(key: str) -> str | None:
    """Return the hint for a key that is what stood behind the comma of a number."""
    if not key[:1].isdecimal():
        return None
    return "a number has a decimal point: inside { } a comma ends it"


def undecided(node: Node, names: Sequence[str] = ()) -> Iterator[Problem]:
    """Yield an error for each value that is still the word TODO of ``connect``'s drafts (K059)."""
    if isinstance(node, Map):
        for key, value in node.entries:
            yield from undecided(value, [*names, key.text])
    elif isinstance(node, Items):
        for item in node.items:  # an entry of a list is called by its id
            id_ = as_text(item.get("id") or item) if isinstance(item, Map) else None
            yield from undecided(item, [*names, id_] if id_ else names)
    elif node.plain and node.text == TODO:
        hint = _AGE if names and names[-1] == "max_age" else _OTHER
        yield problem("K059", node.place, hint=hint, name=".".join(names))

"""Options of a configuration for the kind of its model, as plain values with places."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from eddi_scaffold.common.problems import (
    HintedError,
    Place,
    Problem,
    SimilarNames,
    did_you_mean,
    most_similar,
    problem,
)
from eddi_scaffold.config.file import KEY, MODEL_KEYS, ConfigFile
from eddi_scaffold.config.schema import INPUT_TYPES, ModelSection, known_keys
from eddi_scaffold.kinds import DeclaredInput, Options, kinds
from eddi_scaffold.yaml_text.nodes import (
    Items,
    Map,
    Node,
    differs_between_versions,
    number_for_11,
    value_11,
)

Places = dict[tuple[str | int, ...], Place]
"""Path of a value -> its place; with KEY at the end, that of its key."""


def plain_values(
    node: Node, places: Places, problems: list[Problem], path: tuple[str | int, ...] = ()
) -> Any:
    """Turn a node graph into plain values of YAML 1.1; note the place of each.

    Args:
        node: where to begin.
        places: gets the places.
        problems: gets what YAML 1.1 and 1.2 read differently (K008).
        path: of the node.
    """
    places[path] = node.place
    if isinstance(node, Map):
        result = {}
        for key, value in node.entries:
            inner = (*path, key.text)
            result[key.text] = plain_values(value, places, problems, inner)
            places[(*inner, KEY)] = key.place
            if isinstance(value, Map | Items):
                places[inner] = key.place
        return result
    if isinstance(node, Items):
        return [
            plain_values(item, places, problems, (*path, i)) for i, item in enumerate(node.items)
        ]
    if differs_between_versions(node):
        value = value_11(node)
        number = number_for_11(node) if isinstance(value, str) else None
        read = repr(value) if number is None else f"the text {value!r}"
        hint = "write it in quotes if a text is meant"
        hint = hint if number is None else f"write {number} for the number, or quotes for the text"
        problems.append(problem("K008", node.place, hint=hint, text=node.text, meaning=read))
    return value_11(node)


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
    meant = {(*loc[:-1], most_similar(str(loc[-1]), keys_of(loc[:-1]))) for loc in extra}
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
            yield problem(
                "K003.missing_key", place, section=_named_path(path) or "the file", key=key
            )
        elif found["type"] == "extra_forbidden":
            known = keys_of(path[:-1])
            hint = did_you_mean(key, known) or f"known keys: {', '.join(sorted(known))}"
            if not key.isidentifier() and _key_before(path, places) == "expression":
                hint = "put the expression in quotes: inside { } a comma ends it"
            else:
                hint = hint_for_decimals(key) or hint
            yield problem("K003.unknown_key", places.get((*path, KEY), place), hint=hint, key=key)
        else:
            raised = found.get("ctx", {}).get("error")  # by our own checks
            own, hint = _TEXTS.get(found["type"]) or str(raised or found["msg"]), None
            if len(found["loc"]) > len(path):  # one of several types that would do
                own = "true, false, a number or a text is expected"
            elif isinstance(raised, HintedError):
                hint = raised.hint
            own = own.replace("Input should be", "must be")  # of pydantic, for a literal
            yield problem(
                "K003.value", place, hint=hint, key=_named_path(path) or "the file", reason=own
            )


def hint_for_decimals(key: str) -> str | None:
    """Return the hint for a key that is what stood behind the comma of a number."""
    if not key[:1].isdecimal():
        return None
    return "a number has a decimal point: inside { } a comma ends it"


def _key_before(
    path: tuple[str | int, ...], places: Mapping[tuple[str | int, ...], Place]
) -> str | int | None:
    """Return the key that stands before one of the same map, passing over what has no name."""
    keys = [place[-2] for place in places if place[-1:] == (KEY,) and place[:-2] == path[:-1]]
    before = keys[: keys.index(path[-1])] if path[-1] in keys else []
    return next((key for key in reversed(before) if str(key).isidentifier()), None)


def _named_path(path: Sequence[str | int]) -> str:
    """Name a value by its keys; the place identifies the entry of a list."""
    return ".".join(part for part in path if isinstance(part, str))


def options_of(file: ConfigFile | None) -> Options:
    """Return the options of a configuration for the kind of its model."""
    if file is None:
        return Options()
    config, section = file.config, file.config.Model
    values = {**(section.model_extra or {}), "parameters": section.parameters}
    types = {source.id: source.type for source in config.SimulatorOutputs}
    inputs = tuple(
        DeclaredInput(
            id=item.id,
            type=INPUT_TYPES[item.type] if item.type is not None else None,
            unit=item.unit,
            default=item.default,
            place=file.place("EDDIInputs", index),
            messages=tuple(types[name] for name in item.requires),
        )
        for index, item in enumerate(config.EDDIInputs)
    )
    return Options(
        id=section.id,
        values={key: value for key, value in values.items() if value is not None},
        inputs=inputs,
        frequency=section.frequency,
        parts=tuple(output.event for output in config.EDDIOutputs),
        place=lambda *path: file.place("Model", *path),
        read=file.read,
    )


def _options_for(section: object) -> set[str]:
    """Return the keys that the kind of this section understands; of all kinds if it is unknown."""
    name = section.get("type") if isinstance(section, Mapping) else None
    wanted = name.casefold() if isinstance(name, str) else None
    fitting = [
        kind for kind in kinds().values() if wanted in {t.casefold() for t in kind.config_types}
    ]
    return {key for kind in fitting or kinds().values() for key in kind.options}


def unknown_options(
    section: object, places: Mapping[tuple[str | int, ...], Place], file: str
) -> Iterable[Problem]:
    """Find keys of the section ``Model`` that the kind of its model does not understand (K003)."""
    if not isinstance(section, Mapping):
        return
    known = {*ModelSection.model_fields, *_options_for(section)}
    near = SimilarNames(sorted(known), "known keys")
    for key in section:
        if key not in known:
            place = places.get(("Model", key, KEY), Place(file))
            hint = hint_for_decimals(key) or near.hint(key)
            if key in MODEL_KEYS and isinstance(section[key], str):
                hint = (
                    f"the file of the model is named so: `parameters: [{{{key}: {section[key]}}}]`"
                )
            yield problem("K003.unknown_key", place, hint=hint, key=key)

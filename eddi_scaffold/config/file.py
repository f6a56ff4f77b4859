"""A configuration and the values of its file, with their places; the files that it names."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from eddi_scaffold.common.files import Source, next_to
from eddi_scaffold.common.identifiers import TODO
from eddi_scaffold.common.problems import (
    EddiError,
    HintedError,
    Place,
    Problem,
    did_you_mean,
    problem,
)
from eddi_scaffold.config.schema import Config, Section
from eddi_scaffold.yaml_text.nodes import Items, Map, Node, as_text, read_map, value_11
from eddi_scaffold.yaml_text.spans import inside_scalar

KEY = -1
ValuePath = tuple[str | int, ...]  # keys and numbers of entries that lead to a value
Places = dict[ValuePath, Place]  # with KEY at the end of a path, the place of its key
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
_AGE = (
    "write a duration such as `0.5 s`, about 2.5 periods of the topic, "
    "or give `connect` a recording: --bag"
)
_OTHER = "write it in place of TODO; comments of `connect` say what fits"


def plain_values(node: Node, places: Places, path: ValuePath = ()) -> Any:
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


@dataclass(frozen=True)
class Placed:
    """A YAML file whose values have their places."""

    name: str  # path as the user gave it
    # path such as `("EDDIInputs", 0, "id")` -> place of the value
    places: Mapping[ValuePath, Place]

    def place(self, *path: str | int) -> Place:
        """Return the place of a part, or of the smallest part that holds it."""
        ends = (path[:end] for end in range(len(path), -1, -1))
        return next((self.places[end] for end in ends if end in self.places), Place(self.name))


def keys_at(form: type[BaseModel], path: ValuePath) -> dict[str, Any]:
    """Return the keys of the section at a path with their types; none where there is no section."""
    forms = [form]
    for part in path:
        if isinstance(part, str):
            inner = [keys[part] for of in forms if part in (keys := keys_at(of, ()))]
            forms = [section for type_ in inner for section in _sections(type_)]
    fields = forms[0].model_fields if forms else {}
    spelt = {"from": str} if "requires" in fields else {}  # read before: monitors/spellings.py
    return {**spelt, **{field.alias or name: field.annotation for name, field in fields.items()}}


def _sections(type_: Any) -> Iterator[type[BaseModel]]:
    if isinstance(type_, type) and issubclass(type_, BaseModel):
        yield type_
    for part in get_args(type_):
        yield from _sections(part)


def violations(
    failed: ValidationError, places: Mapping[ValuePath, Place], file: str, form: type[BaseModel]
) -> Iterator[Problem]:
    """Turn pydantic's findings into problems with a place, one per value (K003)."""
    seen: set[ValuePath] = set()
    for error in failed.errors():
        path = loc = tuple(error["loc"])
        while path and path not in places:
            path = path[:-1]
        is_missing = error["type"] == "missing"
        if path in seen and not is_missing:
            continue
        seen.add(path)
        place, key = places.get(path, Place(file)), str(loc[-1])
        named = ".".join(part for part in path if isinstance(part, str)) or "the file"
        if is_missing:
            yield problem("K003.missing_key", place, section=named, key=key)
        elif error["type"] == "extra_forbidden":
            place = places.get((*path, KEY), place)
            known = keys_at(form, path[:-1])
            hint = did_you_mean(key, known) or f"known keys: {', '.join(sorted(known))}"
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


def has_section(source: Source, names: AbstractSet[str]) -> bool:
    """Return whether a YAML file has one of some sections; in a damaged one their lines show it."""
    keys = [name.encode() for name in names if name.encode() in source.data]
    if not keys or source.data.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<"):  # XML
        return False
    node, _ = read_map(source, "K001")
    if node is None:
        return any(line.partition(b":")[0].rstrip() in keys for line in source.data.splitlines())
    return not names.isdisjoint(node.keys())


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


_EVENT_FILES, _TYPES = "event_files", "MessageTypes"
"""Keys of what is remembered: the texts of other files, and message types."""
MODEL_KEYS = ("model", "config", "file")  # keys by which `parameters` names the file of the model


@dataclass(frozen=True)
class ConfigFile(Placed):
    """A configuration with the place of each of its parts."""

    config: Config
    remembered: bool = False  # it comes from the answers of a package, not from its file
    text: str = ""  # of the file
    # name of each `expression_file` as it is written there -> its text
    event_files: Mapping[str, str] = field(default_factory=dict)

    def as_data(self) -> dict[str, Any]:
        """Return configuration and files of events as plain data: what the answers remember."""
        document = self.config.model_dump(exclude_defaults=True)
        if named := named_model(self):  # D7.2 names it in several ways
            document["Model"]["parameters"] = [{"model": named[0]}]
        if self.event_files:
            document[_EVENT_FILES] = dict(self.event_files)
        return dict(_sorted(document))

    def path(self, name: str) -> str:
        """Return the path of a file that is named relative to this configuration, for places."""
        return name if self.remembered else str(Path(self.name).parent / name)

    def inside(self, *path: str | int) -> Callable[[int], Place]:
        """Return offset in the text of a value -> its place in the file."""
        value: Any = self.config
        for part in path:
            value = getattr(value, str(part)) if isinstance(value, Section) else value[part]
        place = self.place(*path)
        # what a deployment file overrides is not in this text
        text = self.text if place.file == self.name and isinstance(value, str) else ""
        return inside_scalar(text, place, value)


def from_data(data: object, name: str) -> ConfigFile:
    """Read back what ``ConfigFile.as_data`` returned (ValueError: it is damaged)."""
    document = dict(data) if isinstance(data, Mapping) else {}
    files = document.pop(_EVENT_FILES, {})
    if not isinstance(files, dict) or not all(isinstance(file, str) for file in files.values()):
        raise ValueError(f"{_EVENT_FILES} is not a map of texts")
    config = Config.model_validate(document)
    return ConfigFile(name, {}, config, remembered=True, event_files=files)


def _sorted(value: Any, key: str = "") -> Any:
    """Return maps with sorted keys; the order of the fields of a message is a part of its type."""
    if isinstance(value, list | tuple):
        return [_sorted(item) for item in value]
    if not isinstance(value, dict):
        return value
    return {
        name: inner if key == _TYPES else _sorted(inner, name)
        for name, inner in sorted(value.items())
    }


def existing_file(of: str, name: str, place: Place) -> Path:
    """Return where a file is that another one names at a place.

    Raises:
        EddiError: there is no such file (F001), or it is not below the folder of the other (F009).
    """
    try:
        path = next_to(of, name)
        path.stat()
    except EddiError as failure:
        about = (p.about(repr(name)) for p in failure.problems)  # at the place where it is named
        raise EddiError(*(replace(fault, place=place) for fault in about)) from None
    except (OSError, ValueError):
        hint = f"a name is relative to the folder of {Path(of).name}"
        raise EddiError(problem("F001.no_file", place, hint=hint, name=name)) from None
    return path


def named_model(file: ConfigFile) -> tuple[str, Place] | None:
    """Return the file that ``parameters`` names as the model, as written there, and its place."""
    parameters = file.config.Model.parameters
    for key in MODEL_KEYS:
        for number, entries in enumerate(parameters if isinstance(parameters, list) else ()):
            name = entries.get(key) if isinstance(entries, dict) else None
            if isinstance(name, str) and name:
                return name, file.place("Model", "parameters", number, key)
    return None


def named_model_path(file: ConfigFile) -> Path | None:
    """Return where the named model is, ``None`` for none (EddiError as `existing_file`)."""
    named = named_model(file)
    return None if named is None else existing_file(file.name, *named)

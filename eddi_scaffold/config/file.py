"""One configuration as it was read, the model that it names, and what a robot overrides."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from eddi_scaffold.common.files import Source, near_file, next_to, read_source
from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.config.schema import Config
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.yaml_text.nodes import Items, Map, Node, as_text
from eddi_scaffold.yaml_text.spans import inside_scalar

KEY = -1
"""Last part of the path under which the place of a key is noted, not that of its value."""
_EVENT_FILES, _TYPES = "event_files", "MessageTypes"
"""Key of the remembered texts of other files."""


@dataclass(frozen=True)
class ConfigFile:
    """A configuration with the place of each of its parts.

    Attributes:
        places: path such as ``("EDDIInputs", 0, "id")`` -> place of the value.
        remembered: it comes from the answers of a package, not from its file.
        text: of the file.
        event_files: name of each ``expression_file`` as it is written there -> its text.
    """

    config: Config
    name: str
    places: Mapping[tuple[str | int, ...], Place]
    remembered: bool = False
    text: str = ""
    event_files: Mapping[str, str] = field(default_factory=dict)

    def as_json(self) -> str:
        """Return configuration and files of events as canonical JSON: what the answers remember."""
        document = self.config.model_dump(exclude_defaults=True)
        if self.event_files:
            document[_EVENT_FILES] = dict(self.event_files)
        return json.dumps(_sorted(document), indent=1)

    def path(self, name: str) -> str:
        """Return the path of a file that is named relative to this configuration, for places."""
        return name if self.remembered else str(Path(self.name).parent / name)

    def read(self, name: str) -> Source:
        """Open a file that is named relative to this configuration.

        Raises:
            EddiError: it cannot be read (F001), it is not below the folder of the configuration
                (F009), or the configuration is a remembered one (K033).
        """
        if self.remembered:
            raise EddiError(problem("K033.remembered", name=name))
        return read_source(next_to(self.name, name))

    def inside(self, *path: str | int) -> Callable[[int], Place]:
        """Return offset in the text of a value -> its place in the file."""
        place = self.place(*path)
        # what a deployment file overrides is not in this text
        return inside_scalar(self.text if place.file == self.name else "", place)

    def place(self, *path: str | int) -> Place:
        """Return the place of a part, or of the nearest part around it."""
        for end in range(len(path), -1, -1):
            if path[:end] in self.places:
                return self.places[path[:end]]
        return Place(self.name)


def from_json(text: str, name: str) -> ConfigFile:
    """Read back what ``ConfigFile.as_json`` wrote.

    Raises:
        ValueError: a person or a merge has damaged it.
    """
    document = json.loads(text)
    files = document.pop(_EVENT_FILES, {}) if isinstance(document, dict) else {}
    if not isinstance(files, dict) or not all(isinstance(file, str) for file in files.values()):
        raise ValueError(f"{_EVENT_FILES} is not a map of texts")
    config = Config.model_validate(document)
    return ConfigFile(config, name, {}, remembered=True, event_files=files)


def about_file(problem: Problem, name: str, place: Place) -> Problem:
    """Report the file of a problem at the place where it is named."""
    return replace(problem, message=f"{name!r}: {problem.message}", place=place)


def _sorted(value: JsonValue, key: str = "") -> JsonValue:
    """Return maps with sorted keys; the order of the fields of a message is a part of its type."""
    if isinstance(value, list):
        return [_sorted(one) for one in value]
    if not isinstance(value, dict):
        return value
    inner = {name: one if key == _TYPES else _sorted(one, name) for name, one in value.items()}
    return dict(sorted(inner.items()))


MODEL_KEYS = ("model", "config", "file")
_Keys = tuple[str | int, ...]


def named_model(file: ConfigFile) -> str | None:
    """Return the file that ``parameters`` names as the model, relative to the configuration.

    SESAME D7.2 writes ``parameters: [{config: safeml_config.yml}]``.
    """
    found = _named_model(file)
    return None if found is None else found[0]


def named_model_path(file: ConfigFile) -> Path | None:
    """Return where the file is that ``parameters`` names, ``None`` where it names none.

    Raises:
        EddiError: there is no such file (F001), or it is not below the folder of the configuration
            (F009); the place is that of its name.
    """
    found = _named_model(file)
    if found is None:
        return None
    name, where = found
    try:
        path = next_to(file.name, name)
        path.stat()
    except EddiError as failure:
        raise EddiError(
            *(about_file(p, name, file.place(*where)) for p in failure.problems)
        ) from None
    except (OSError, ValueError):
        near = near_file(path, name, Path(file.name).name)
        hint = near or "a name is relative to the folder of the configuration"
        raise EddiError(problem("F001.no_file", file.place(*where), hint=hint, name=name)) from None
    return path


def _named_model(file: ConfigFile) -> tuple[str, _Keys] | None:
    """Return the name of the model's file and the keys under which it is given."""
    given = file.config.Model.parameters
    where: _Keys = ("Model", "parameters")
    maps = [((*where, k), one) for k, one in enumerate(given)] if isinstance(given, list) else []
    for key in MODEL_KEYS:
        for keys, one in maps or [(where, given)]:
            name = one.get(key) if isinstance(one, dict) else None
            if isinstance(name, str) and name:
                return name, (*keys, key)
    return None


def overridden(document: Map, override: Map | None) -> Map:
    """Return a document with other values; each keeps the place where it is written.

    Maps are joined key by key, and lists of entries with an ``id`` entry by entry; anything else
    is replaced as a whole. Keys and entries that the document does not have are added to it.
    """
    if override is None:
        return document
    entries = {key.text: (key, value) for key, value in document.entries}
    for key, value in override.entries:
        own = entries.get(key.text)
        entries[key.text] = (key, value) if own is None else (own[0], _joined(own[1], value))
    return replace(document, entries=tuple(entries.values()))


def _joined(value: Node, override: Node) -> Node:
    if isinstance(value, Map) and isinstance(override, Map):
        return overridden(value, override)
    if isinstance(value, Items) and isinstance(override, Items):
        own, new = _by_id(value), _by_id(override)
        if own is not None and new is not None:
            joined = {id_: overridden(entry, new.get(id_)) for id_, entry in own.items()}
            return replace(value, items=(*joined.values(), *(new[i] for i in new if i not in own)))
    return override


def _by_id(items: Items) -> dict[str, Map] | None:
    """Return the entries of a list by their ids, ``None`` where one has none, or two the same."""
    found = {
        id_: item
        for item in items.items
        if isinstance(item, Map) and (id_ := as_text(item.get("id") or item)) is not None
    }
    return found if len(found) == len(items.items) else None

"""One configuration as it was read, and the files that it names."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from eddi_scaffold.common.files import Source, next_to, read_source, similar_file
from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.config import values
from eddi_scaffold.config.schema import Config
from eddi_scaffold.yaml_text.spans import inside_scalar

_EVENT_FILES, _TYPES = "event_files", "MessageTypes"
"""Keys of what is remembered: the texts of other files, and message types."""
MODEL_KEYS = ("model", "config", "file")  # keys by which `parameters` names the file of the model


@dataclass(frozen=True)
class ConfigFile:
    """A configuration with the place of each of its parts."""

    config: Config
    name: str
    # path such as `("EDDIInputs", 0, "id")` -> place of the value
    places: Mapping[values.Path, Place]
    remembered: bool = False  # it comes from the answers of a package, not from its file
    text: str = ""  # of the file
    # name of each `expression_file` as it is written there -> its text
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
        """Return the place of a part, or of the smallest part that holds it."""
        return values.place_of(self.places, path, self.name)


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


def _sorted(value: Any, key: str = "") -> Any:
    """Return maps with sorted keys; the order of the fields of a message is a part of its type."""
    if isinstance(value, list):
        return [_sorted(item) for item in value]
    if not isinstance(value, dict):
        return value
    return {
        name: inner if key == _TYPES else _sorted(inner, name)
        for name, inner in sorted(value.items())
    }


def about_file(problem: Problem, name: str, place: Place) -> Problem:
    """Report the file of a problem at the place where it is named."""
    return replace(problem, message=f"{name!r}: {problem.message}", place=place)


def existing_file(of: str, name: str, place: Place) -> Path:
    """Return where a file is that another one names at a place.

    Raises:
        EddiError: there is no such file (F001), or it is not below the folder of the other (F009).
    """
    try:
        path = next_to(of, name)
        path.stat()
    except EddiError as failure:
        raise EddiError(*(about_file(p, name, place) for p in failure.problems)) from None
    except (OSError, ValueError):
        hint = similar_file(path, name, Path(of).name)
        hint = hint or f"a name is relative to the folder of {Path(of).name}"
        raise EddiError(problem("F001.no_file", place, hint=hint, name=name)) from None
    return path


def named_model(file: ConfigFile) -> tuple[str, Place] | None:
    """Return the file that ``parameters`` names as the model, as written there, and its place.

    SESAME D7.2 writes ``parameters: [{config: safeml_config.yml}]``.
    """
    parameters, path = file.config.Model.parameters, ("Model", "parameters")
    maps = dict(enumerate(parameters)) if isinstance(parameters, list) else {}
    for key in MODEL_KEYS:
        for number, entries in maps.items() or [(None, parameters)]:
            name = entries.get(key) if isinstance(entries, dict) else None
            if isinstance(name, str) and name:
                inner = path if number is None else (*path, number)
                return name, file.place(*inner, key)
    return None


def named_model_path(file: ConfigFile) -> Path | None:
    """Return where the file is that ``parameters`` names, ``None`` where it names none.

    Raises:
        EddiError: there is no such file (F001), or it is not below the folder of the configuration
            (F009); the place is that of its name.
    """
    named = named_model(file)
    return None if named is None else existing_file(file.name, *named)

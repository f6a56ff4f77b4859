"""One configuration as it was read: its content, and where each part of it is."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from eddi_scaffold.config.schema import Config
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.positioned_yaml.columns import inside_scalar
from eddi_scaffold.problems import EddiError, Place, Problem, error
from eddi_scaffold.source import Source, beside, read_source

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
            message = f"{name!r} cannot be read: the configuration is remembered, not given"
            raise EddiError(error("K033", message, hint="name the configuration with -c"))
        return read_source(beside(self.name, name))

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
    if not isinstance(files, dict) or not all(isinstance(one, str) for one in files.values()):
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

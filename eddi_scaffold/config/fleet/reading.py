"""Read ``deployment.yml``."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from eddi_scaffold.config.file import about_file
from eddi_scaffold.config.fleet.schema import FleetForm, MonitorEntry, known_keys
from eddi_scaffold.config.plain_values import Places, plain_values
from eddi_scaffold.config.violations import violations
from eddi_scaffold.positioned_yaml.nodes import Map, items_of, read_map
from eddi_scaffold.problems import EddiError, Place, Problem, error, has_errors, in_order
from eddi_scaffold.readers.xml_text import looks_like_xml
from eddi_scaffold.source import Source, beside

ROBOTS = "Robots"
_SECTIONS = (ROBOTS, "Bindings")
"""Sections that tell a deployment file from all others, also where one of them is misspelt."""
_ROBOTS_LINE = re.compile(rb"^Robots[ \t]*:", re.MULTILINE)


@dataclass(frozen=True)
class FleetFile:
    """A deployment file as it was read.

    Attributes:
        form: its content.
        name: path as the user gave it.
        places: path such as ``("Robots", 0, "name")`` -> place of the value.
        overrides: number of a robot and of one of its monitors -> its ``override``.
    """

    form: FleetForm
    name: str
    places: Mapping[tuple[str | int, ...], Place]
    overrides: Mapping[tuple[int, int], Map]

    def place(self, *path: str | int) -> Place:
        """Return the place of a part, or of the nearest part around it."""
        for end in range(len(path), -1, -1):
            if path[:end] in self.places:
                return self.places[path[:end]]
        return Place(self.name)

    def files(self, robot: int, monitor: int) -> tuple[Path, Path | None]:
        """Return where configuration and model of a monitor are.

        Raises:
            EddiError: one is not in the folder of this file, or below (F009), or not there (F001).
        """
        entry = self.form.Robots[robot].monitors[monitor]
        config = self._beside(entry, robot, monitor, "config")
        return config, None if entry.model is None else self._beside(entry, robot, monitor, "model")

    def _beside(self, entry: MonitorEntry, robot: int, monitor: int, key: str) -> Path:
        name: str = getattr(entry, key)
        place = self.place(ROBOTS, robot, "monitors", monitor, key)
        try:
            path = beside(self.name, name)
            path.stat()
        except EddiError as failure:
            raise EddiError(*(about_file(p, name, place) for p in failure.problems)) from None
        except (OSError, ValueError):
            hint = "a name is relative to the folder of the deployment file"
            raise EddiError(error("F001", f"there is no file {name!r}", place, hint)) from None
        return path


def is_fleet(source: Source) -> bool:
    """Return whether a file is a deployment file."""
    named = any(name.encode() in source.data for name in _SECTIONS)
    if looks_like_xml(source.data) or not named:
        return False
    node, _ = read_map(source, "K001")
    if node is None:  # no YAML, or damaged: what it is meant to be still shows
        return _ROBOTS_LINE.search(source.data) is not None
    return any(node.get(name) is not None for name in _SECTIONS)


def read_fleet(source: Source) -> tuple[FleetFile | None, list[Problem]]:
    """Read a deployment file; the result is ``None`` when a problem is an error."""
    document, problems = read_map(source, "K001")
    if document is None:
        return None, problems
    places: Places = {}
    data = plain_values(document, places, problems)
    data = {key: value for key, value in data.items() if value is not None or key == ROBOTS}
    try:
        form = FleetForm.model_validate(data)
    except ValidationError as failed:
        wrong = violations(failed, places, source.name, known_keys)
        return None, in_order([*problems, *wrong])
    found = FleetFile(form, source.name, places, dict(_overrides(document)))
    problems += _repeated(found)
    return (None if has_errors(problems) else found), in_order(problems)


def _overrides(document: Map) -> Iterator[tuple[tuple[int, int], Map]]:
    for robot, entry in enumerate(items_of(document.get(ROBOTS))):
        monitors = entry.get("monitors") if isinstance(entry, Map) else None
        for number, monitor in enumerate(items_of(monitors)):
            override = monitor.get("override") if isinstance(monitor, Map) else None
            if isinstance(override, Map):
                yield (robot, number), override


def _repeated(file: FleetFile) -> Iterator[Problem]:
    """Report robots that nobody could tell apart (D010)."""
    form = file.form
    names = [(one.name, file.place(ROBOTS, k, "name")) for k, one in enumerate(form.Robots)]
    first: dict[str, Place] = {}
    for name, place in [*names, (form.Station.name, file.place("Station", "name"))]:
        before = first.setdefault(name.casefold(), place)
        if before is not place:
            message = f"two robots are called {name!r}, first in line {before.line}"
            hint = "give each a name of its own; the control station is `station` by default"
            yield error("D010", message, place, hint)

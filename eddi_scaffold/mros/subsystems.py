"""The components of a system and of all systems that are part of it, in the order of output."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from eddi_scaffold.mros.interface_definitions import SystemFile, noticed
from eddi_scaffold.problems import Place, Problem, did_you_mean, error, warning

SUBSYSTEM_MISSING = "M024"


@dataclass
class Flat:
    """Systems in the order in which their components come: parts first."""

    systems: list[SystemFile] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)


def flattened(system: SystemFile, known: Sequence[SystemFile]) -> Flat:
    """Return a system behind its sub-systems, each once.

    A sub-system is found by the name inside its file. One that is not there is a warning, a
    system that is part of itself an error. Problems in the files of parts are reported as well.
    """
    by_name: dict[str, SystemFile] = {}
    for one in known:
        by_name.setdefault(one.system.name, one)
    flat = Flat()
    _add(system, by_name, (system.system.name,), flat)
    return flat


def _add(system: SystemFile, known: dict[str, SystemFile], path: tuple[str, ...], to: Flat) -> None:
    for part in system.system.subsystems:
        place = Place(system.file, part.line, part.col)
        if part.name in path:
            circle = " -> ".join((*path[path.index(part.name) :], part.name))
            message = f"the system {part.name!r} is part of itself: {circle}"
            to.problems.append(error("M023", message, place))
        elif part.name not in known:
            message = f"there is no system {part.name!r} in the directory of models"
            hint = did_you_mean(part.name, known)
            to.problems.append(warning(SUBSYSTEM_MISSING, message, place, hint))
        elif known[part.name] not in to.systems:
            found = known[part.name]
            to.problems += noticed(found.system.notices, found.file)
            _add(found, known, (*path, part.name), to)
    to.systems.append(system)

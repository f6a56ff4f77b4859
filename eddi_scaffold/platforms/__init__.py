"""Platforms: where a monitor runs. Each is one folder that offers ``PLATFORM``.

A platform turns monitors (model + configuration) into the answers of whole packages. Platforms know
neither each other nor a kind; what they need of a kind comes in as values.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from eddi_scaffold.problems import EddiError, error

if TYPE_CHECKING:
    from eddi_scaffold.config.schema import Config
    from eddi_scaffold.kinds import JsonValue
    from eddi_scaffold.monitors.binding import Monitor
    from eddi_scaffold.problems import Problem
    from eddi_scaffold.regions.result import Orphan


@dataclass(frozen=True)
class PackageAnswers:
    """One package to be rendered.

    Attributes:
        folder: where it goes, relative to the destination of the platform, POSIX form.
        answers: all answers of its template, in the order in which they are written.
        files: path in the package -> bulk data that Copier does not render.
        saved: bodies that are waiting for their regions.
    """

    folder: str
    answers: Mapping[str, JsonValue]
    files: Mapping[str, bytes] = field(default_factory=dict)
    saved: Sequence[Orphan] = ()


@dataclass(frozen=True)
class Platform:
    """The functions that make a platform.

    Attributes:
        name: as in ``--platform``.
        root: folder of all packages, relative to the workspace or output folder.
        needs_config: a monitor cannot be generated without a configuration.
        monitor: answers of the package of one monitor, and problems.
        support: answers of the packages that all monitors share; gets the names of every monitor
            package of the workspace, sorted, and who maintains them.
        taken_names: folder of all packages, or ``None`` -> names that would break the platform ->
            why.
    """

    name: str
    root: str
    needs_config: bool
    monitor: Callable[[Monitor], tuple[PackageAnswers, list[Problem]]]
    support: Callable[[Sequence[str], Config | None], list[PackageAnswers]]
    taken_names: Callable[[Path | None], Mapping[str, str]]


@cache
def platforms() -> Mapping[str, Platform]:
    """Return every platform by name."""
    found = (
        importlib.import_module(f"{__name__}.{module.name}").PLATFORM
        for module in pkgutil.iter_modules(__path__)
        if module.ispkg
    )
    return {platform.name: platform for platform in sorted(found, key=lambda p: p.name)}


def chosen(name: str) -> Platform:
    """Return the platform called ``name``.

    Raises:
        EddiError: there is none (G008).
    """
    if name not in platforms():
        known = ", ".join(platforms())
        message = f"there is no platform {name!r}"
        raise EddiError(error("G008", message, hint=f"platforms: {known}"))
    return platforms()[name]

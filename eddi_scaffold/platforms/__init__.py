"""Platforms: where a monitor runs. Each is one folder here, which offers ``PLATFORM`` of its name.

A platform turns monitors (model + configuration) into the answers of whole packages. Which one a
package belongs to is asked of the platforms: their names, and those of templates, are never taken
apart.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING

from eddi_scaffold.common.problems import EddiError, problem

if TYPE_CHECKING:
    from eddi_scaffold.common.problems import Problem
    from eddi_scaffold.kinds import JsonValue
    from eddi_scaffold.monitors.binding import BoundMonitor
    from eddi_scaffold.regions.choosing import Body

DEFAULT = "ros1"
"""The platform that is meant where none is named: configurations connect a monitor to ROS 1."""
DEFAULT_IN_FOLDER = "plain"  # the same where packages go to a folder that is not a workspace
RUNTIME, SINGLE_PROCESS = "runtime", "single_process"
"""Answers of a monitor package: where the runtime library is; whether one process runs all."""
VENDORED, INSTALLED = "vendored", "installed"
"""Beside the monitors, or a distribution that rosdep or pip installs."""
RUNTIME_PACKAGE = "eddi_runtime"  # of the package with it
Choices = Mapping[str, "str | bool"]
"""What a person chose for the monitors of a workspace: some of these answers."""


def built_in(place: Path, command: str) -> str:
    """Return what a person types to build a workspace."""
    return command if place == Path() else f"cd {quote(str(place))} && {command}"


def pip_install(place: Path, monitors: Sequence[str]) -> list[str]:
    """Return what a person types to install packages of Python that are in a folder."""
    runtime = [RUNTIME_PACKAGE] if (place / RUNTIME_PACKAGE).is_dir() else []
    paths = [str(place / name) for name in [*runtime, *monitors]]
    # pip takes a bare name for a distribution of its index
    named = [quote(path if "/" in path else f"./{path}") for path in paths]
    return [f"pip install {' '.join(named)}"]


def choices(runtime: str | None, single_process: bool | None) -> Choices:
    """Return what is to be otherwise than it was; None is as it was."""
    answers = {RUNTIME: runtime, SINGLE_PROCESS: single_process}
    return {name: value for name, value in answers.items() if value is not None}


def runtime_of(monitors: Mapping[str, Mapping[str, JsonValue]]) -> str:
    """Return where the runtime library of a workspace is: beside the monitors if one needs it."""
    where = [monitor.get(RUNTIME, VENDORED) for monitor in monitors.values()]
    return VENDORED if VENDORED in where else INSTALLED


@dataclass(frozen=True)
class MeetingPlace:
    """A place where robots hear each other."""

    key: str  # what names it in a deployment file: `master` or `domain`
    name: str  # of the place; empty for the default one
    partition: str = ""  # of DDS, inside the domain; empty for that of ROS 2


@dataclass(frozen=True)
class Meeting:
    """Where the nodes of several robots find each other."""

    key: str  # of a robot in a deployment file, which names that place: `master` or `domain`
    default: str  # what is meant where none is named
    # that place, workspace or folder of a robot, its namespace (empty for none) and its monitor
    # packages -> shell commands that build these, and start them there
    next_steps: Callable[[MeetingPlace, Path, str, Sequence[str]], Sequence[str]]
    has_partitions: bool = False  # a robot may also have a `partition`


@dataclass(frozen=True)
class PackageAnswers:
    """One package to be rendered, or one that nothing needs any more."""

    folder: str  # where it goes, relative to the destination of the platform, POSIX form
    # all answers of its template, in the order in which they are written; none for a package that
    # leaves
    answers: Mapping[str, JsonValue]
    # path in the package -> what Copier does not render
    files: Mapping[str, bytes] = field(default_factory=dict)
    saved: Sequence[Body] = ()  # bodies that are waiting for their regions
    # name -> lines of an adopted module that have no place in the package
    adopted: Mapping[str, bytes] = field(default_factory=dict)

    @property
    def lacks(self) -> Sequence[str]:
        """Return what runs, and is nowhere any more: files that its answers know by digest."""
        known = self.answers.get("files")
        text = {self.answers.get("model_text")}
        return sorted({*known} - {*self.files} - text) if isinstance(known, Mapping) else ()


@dataclass(frozen=True)
class Platform:
    """The functions that make a platform."""

    name: str  # as in `--platform`, the name of its folder
    # what its packages are rendered from: that of one monitor, then those that all monitors share
    templates: tuple[str, ...]
    # answers of the package of one monitor, and problems
    monitor: Callable[[BoundMonitor], tuple[PackageAnswers, list[Problem]]]
    # folder of all packages, or `None` -> names that would break the platform -> why
    taken_names: Callable[[Path | None], Mapping[str, str]]
    # workspace or folder, and monitor packages -> shell commands that build and start them
    next_steps: Callable[[Path, Sequence[str]], Sequence[str]] = pip_install
    # answers of the packages that all monitors share; gets every monitor package of the workspace
    # with its answers
    support: Callable[[Mapping[str, Mapping[str, JsonValue]]], list[PackageAnswers]] = lambda _: []
    # what people call the folder in which its packages are built together; `None`: each goes to any
    # folder
    workspace: str | None = None
    # folder of all packages in it, POSIX form; its first part is that of the sources
    root: str = ""
    needs_config: bool = True  # a monitor cannot be generated without a configuration
    # of the robots that it is for; `None` where they cannot hear each other
    meeting: Meeting | None = None


def names() -> tuple[str, ...]:
    """Return the names of all platforms, sorted, without loading one."""
    modules = {module.name for module in pkgutil.iter_modules(__path__)}
    return tuple(sorted(modules - {"ros_packages"}))  # those have no platform of their own


@cache
def platforms() -> Mapping[str, Platform]:
    """Return every platform by name."""
    return {name: importlib.import_module(f"{__name__}.{name}").PLATFORM for name in names()}


def owner_of(template: str) -> Platform:
    """Return the platform that has a template; KeyError where none has."""
    for platform in platforms().values():
        if template in platform.templates:
            return platform
    raise KeyError(template)


def chosen(name: str) -> Platform:
    """Return the platform called ``name``; EddiError G008 where there is none."""
    if name not in platforms():
        known = ", ".join(platforms())
        raise EddiError(problem("G008.platform", name=name, known=known))
    return platforms()[name]

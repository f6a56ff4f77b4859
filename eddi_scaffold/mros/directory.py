"""Systems and directories of models on disk: the one module of this package that opens files."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path, PurePosixPath
from typing import TypeVar

from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.mros import MODEL_SUFFIXES, SYSTEM_SUFFIX
from eddi_scaffold.mros.interface_definitions import Models, NodeModelFile, SystemFile, noticed
from eddi_scaffold.mros.model import System
from eddi_scaffold.mros.reading import read_ros_models, read_rossystem
from eddi_scaffold.mros.text import EMPTY_FILE, MrosSyntaxError

_Read = TypeVar("_Read")


def load_system(path: Path, folder: Path | None = None) -> tuple[SystemFile, list[Problem]]:
    """Read a system for a command.

    Args:
        path: the ``.rossystem``.
        folder: directory of models; a system inside of it is named relative to it.

    Returns:
        The system and its warnings.

    Raises:
        EddiError: it cannot be read, or is in a format that is not understood.
    """
    name = named(path, folder)
    try:
        system = read_rossystem(read_source(path).data, name)
    except MrosSyntaxError as failed:
        raise EddiError(problem_of(failed)) from None
    if system.references_only:
        raise EddiError(problem("M001.references", Place(name, 1, 1)))
    return SystemFile(name, system), list(noticed(system.notices, name))


def load_models(folder: Path, *, systems: bool = False) -> Models:
    """Read every model below a directory, in the order of the POSIX paths.

    Args:
        folder: links to directories in it are not followed, hidden directories not entered: ours
            hold copies of models.
        systems: read ``.rossystem`` files as well, for a system that has sub-systems.

    Raises:
        EddiError: there is no such directory (F001).
    """
    if not folder.is_dir():
        reason = "it is not a directory" if folder.exists() else "there is no such directory"
        raise EddiError(problem("F001.models", Place(str(folder)), reason=reason))
    files, found, skipped = [], [], []
    problems: list[Problem] = []
    for name in _files(folder):
        suffix = PurePosixPath(name).suffix
        if suffix == SYSTEM_SUFFIX:
            system = _system(folder, name) if systems else None
            found += [SystemFile(name, system)] if system is not None else []
            continue
        try:
            model = _read(folder, name, read_ros_models)
        except EddiError as failed:
            problems += failed.problems
            skipped.append(name)
            continue
        problems += noticed(model.notices, name)
        files.append(NodeModelFile(name, model))
    return Models(tuple(files), tuple(found), tuple(skipped), tuple(problems))


def named(path: Path, folder: Path | None) -> str:
    """Return the name of a file in messages: relative to the directory if it lies in it."""
    if folder is None:
        return str(path)
    try:
        return path.resolve().relative_to(folder.resolve()).as_posix()
    except ValueError:
        return str(path)


def problem_of(failed: MrosSyntaxError) -> Problem:
    """Return an error of the readers as a problem; nothing but comments is a warning."""
    place = Place(failed.file, failed.line, failed.col)
    fault = problem(failed.case, place, reason=failed.message)
    return fault if failed.case == EMPTY_FILE else replace(fault, excerpt=failed.source_line)


def _files(folder: Path) -> list[str]:
    found = []
    for root, folders, files in os.walk(folder):
        folders[:] = [name for name in folders if not name.startswith(".")]
        found += [
            Path(root, name).relative_to(folder).as_posix()
            for name in files
            if name.endswith((*MODEL_SUFFIXES, SYSTEM_SUFFIX))
        ]
    return sorted(found)


def _read(folder: Path, name: str, read: Callable[[bytes, str], _Read]) -> _Read:
    try:
        return read(read_source(folder / name).data, name)
    except MrosSyntaxError as failed:
        raise EddiError(problem_of(failed)) from None


def _system(folder: Path, name: str) -> System | None:
    """Read a possible sub-system; a missing one is reported, regardless of other files."""
    try:
        return _read(folder, name, read_rossystem)
    except EddiError:
        return None

"""Readers of the MROS models ``.rossystem``, ``.ros``, ``.ros1``, ``.ros2``, usable alone.

    from pathlib import Path
    from eddi_scaffold.mros import read_rossystem

    system = read_rossystem(Path("robot.rossystem").read_bytes(), "robot.rossystem")
    for component in system.components:
        print(component.name, [interface.ref for interface in component.interfaces])

"MROS" is the family of languages of ipa320/ros-model, today ipa320/RosTooling (model based ROS).
"""

from __future__ import annotations

import os
import re
from dataclasses import replace
from pathlib import Path

from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.mros.brace_format import BraceReader
from eddi_scaffold.mros.indent_format import IndentReader
from eddi_scaffold.mros.model import RosModel, System
from eddi_scaffold.mros.resolving import Models
from eddi_scaffold.mros.text import MrosSyntaxError, decoded

__all__ = ["MrosSyntaxError", "RosModel", "System", "read_ros_models", "read_rossystem"]

MODEL_SUFFIXES = (".ros", ".ros1", ".ros2")
SYSTEM_SUFFIX = ".rossystem"
_NOTHING = re.compile(r"(?:\s+|//[^\n]*|\#[^\n]*|/\*[\s\S]*?\*/)*")
_BRACE = re.compile(r"(?:RosSystem|PackageSet|ComponentInterface)\b")
_XMI = (
    "this is the XMI (XML) form of 2017 and 2018; open it with the Eclipse tools of that time and "
    "save it as text"
)


def read_rossystem(source: str | bytes, file: str = "<text>") -> System:
    """Read the text of a ``.rossystem``.

    Args:
        source: the content; bytes are read as UTF-8.
        file: its name, for messages only.

    Raises:
        MrosSyntaxError: it cannot be read, holds nothing, or is in a format of the family that is
            not read (XMI, rossdl).
    """
    return _reader(source, file).system()


def read_ros_models(source: str | bytes, file: str = "<text>") -> RosModel:
    """Read the text of a ``.ros``, ``.ros1`` or ``.ros2``.

    Raises:
        MrosSyntaxError: as :func:`read_rossystem`.
    """
    return _reader(source, file).model()


def _reader(source: str | bytes, file: str) -> BraceReader | IndentReader:
    """Return the reader that fits the first word that is not a comment."""
    text = decoded(source, file)
    nothing = _NOTHING.match(text.text)
    start = nothing.end() if nothing else 0
    if start == len(text.text):
        raise text.error(0, "the file contains only blanks and comments", "empty")
    if text.text.startswith("<", start):
        raise text.error(0, _XMI, "xmi")
    text.dialect = "brace" if _BRACE.match(text.text, start) else "indent"
    return BraceReader(text) if text.dialect == "brace" else IndentReader(text)


def load_system(path: Path, folder: Path | None = None) -> tuple[System, list[Problem]]:
    """Read a system for a command; inside of a directory of models it is named relative to it.

    Returns:
        The system and its warnings.

    Raises:
        EddiError: it cannot be read, or is in a format that is not understood.
    """
    name = str(path)
    if folder is not None and path.resolve().is_relative_to(folder.resolve()):
        name = path.resolve().relative_to(folder.resolve()).as_posix()
    try:
        system = read_rossystem(read_source(path).data, name)
    except MrosSyntaxError as failed:
        (fault,) = failed.problems
        raise EddiError(replace(fault, place=replace(fault.place, file=str(path)))) from None
    if system.references_only:
        raise EddiError(problem("M001.references", Place(str(path), 1, 1)))
    return system, list(system.problems)


def load_models(folder: Path) -> Models:
    """Read every model and system below a directory, in the order of the POSIX paths.

    Links to directories are not followed, hidden ones not entered: ours hold copies of models.

    Raises:
        EddiError: there is no such directory (F001).
    """
    if not folder.is_dir():
        reason = "it is not a directory" if folder.exists() else "there is no such directory"
        raise EddiError(problem("F001.models", Place(str(folder)), reason=reason))
    names, models = list[str](), Models()
    for root, folders, files in os.walk(folder):
        folders[:] = [name for name in folders if not name.startswith(".")]
        names += [
            Path(root, name).relative_to(folder).as_posix()
            for name in files
            if name.endswith((*MODEL_SUFFIXES, SYSTEM_SUFFIX))
        ]
    for name in sorted(names):
        is_system = name.endswith(SYSTEM_SUFFIX)
        try:
            data = read_source(folder / name).data
            if is_system:
                models.systems.append(read_rossystem(data, name))
            else:
                models.files.append(read_ros_models(data, name))
                models.problems += models.files[-1].problems
        except EddiError as failed:
            if not is_system:  # a sub-system that is missing is reported as such
                models.problems += failed.problems
                models.skipped.append(name)
    return models

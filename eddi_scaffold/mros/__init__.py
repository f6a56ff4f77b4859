"""Readers of the MROS models ``.rossystem``, ``.ros``, ``.ros1``, ``.ros2``, usable alone.

    from pathlib import Path
    from eddi_scaffold.mros import read_rossystem

    system = read_rossystem(Path("robot.rossystem").read_bytes(), "robot.rossystem")
    for component in system.components:
        print(component.name, [interface.ref for interface in component.interfaces])

"MROS" is the family of languages of ipa320/ros-model, today ipa320/RosTooling (model based ROS).
It is not the RobMoSys project MROS (metacontrol for ROS), although that one also wrote
``.rossystem`` files.
"""

from __future__ import annotations

import re

from eddi_scaffold.mros.brace_format import BraceReader
from eddi_scaffold.mros.indent_format import IndentReader
from eddi_scaffold.mros.model import RosModel, System
from eddi_scaffold.mros.text import EMPTY_FILE, FOREIGN_FORMAT, MrosSyntaxError, decoded

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
        MrosSyntaxError: it cannot be read (``SYNTAX``), holds nothing (``EMPTY_FILE``), or is in
            a format of the family that is not read (``FOREIGN_FORMAT``: XMI, rossdl).
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
        raise text.error(0, "the file contains only blanks and comments", EMPTY_FILE)
    if text.text.startswith("<", start):
        raise text.error(0, _XMI, FOREIGN_FORMAT, "xmi")
    text.dialect = "brace" if _BRACE.match(text.text, start) else "indent"
    return BraceReader(text) if text.dialect == "brace" else IndentReader(text)

"""Text or bytes of one file -> its system or model, in any dialect. Nothing is opened here."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

from eddi_scaffold.mros.brace import models as brace_models
from eddi_scaffold.mros.brace import system as brace_system
from eddi_scaffold.mros.indent import models as indent_models
from eddi_scaffold.mros.indent import system as indent_system
from eddi_scaffold.mros.model import Dialect, RosModel, System
from eddi_scaffold.mros.text import EMPTY_FILE, FOREIGN_FORMAT, MrosSyntaxError, Text, decoded

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
    text = _text(source, file)
    dialect = _dialect(text)
    with _in(dialect):
        if dialect == "brace":
            return brace_system.read_system(text)
        return indent_system.read_system(text)


def read_ros_models(source: str | bytes, file: str = "<text>") -> RosModel:
    """Read the text of a ``.ros``, ``.ros1`` or ``.ros2``.

    Args:
        source: the content; bytes are read as UTF-8.
        file: its name, for messages only.

    Raises:
        MrosSyntaxError: as :func:`read_rossystem`.
    """
    text = _text(source, file)
    dialect = _dialect(text)
    with _in(dialect):
        if dialect == "brace":
            return brace_models.read_model(text)
        return indent_models.read_model(text)


def _text(source: str | bytes, file: str) -> Text:
    return decoded(source, file) if isinstance(source, bytes) else Text(source, file)


def _dialect(text: Text) -> Dialect:
    """Return the dialect, determined by the first word that is not a comment."""
    nothing = _NOTHING.match(text.text)
    start = nothing.end() if nothing else 0
    if start == len(text.text):
        raise text.error(0, "the file contains only blanks and comments", EMPTY_FILE)
    if text.text.startswith("<", start):
        raise text.error(0, _XMI, FOREIGN_FORMAT, "xmi")
    return "brace" if _BRACE.match(text.text, start) else "indent"


@contextmanager
def _in(dialect: Dialect) -> Iterator[None]:
    """Add the dialect to a syntax error."""
    try:
        yield
    except MrosSyntaxError as failed:
        failed.dialect = dialect
        raise

"""Inspect XML without parsing it: the prolog, and hints for broken files."""

from __future__ import annotations

import codecs
import re
from typing import NamedTuple

HEAD_BYTES = 1 << 16
"""How much of a file is looked at before it is parsed."""

_STARTS = (
    (codecs.BOM_UTF8, 3, "latin-1"),
    (codecs.BOM_UTF16_LE, 2, "utf-16-le"),
    (codecs.BOM_UTF16_BE, 2, "utf-16-be"),
    (b"<\0", 0, "utf-16-le"),
    (b"\0<", 0, "utf-16-be"),
    (b"", 0, "latin-1"),
)
"""First bytes -> length of the byte order mark, encoding."""
_DECLARATION = re.compile(r"<\?xml\s")
_PROLOG = r"(?:[^<]|<!--.*?-->|<\?.*?\?>)*"
_TO_DOCTYPE = re.compile(_PROLOG + "(?=<!DOCTYPE)", re.DOTALL)
_TO_ROOT_NAME = re.compile(_PROLOG + r"<[^\s/>!?]+", re.DOTALL)


class Head(NamedTuple):
    """The first bytes of a document, decoded far enough to see its markup.

    Attributes:
        text: the text after a byte order mark; other than UTF-16 read as Latin-1, which keeps
            byte offsets and every ASCII character.
        offset: bytes before the text.
        encoding: codec of ``text``.
    """

    text: str
    offset: int
    encoding: str

    def line_of(self, index: int) -> int:
        """Return the line, counted from 1, of a character of ``text``."""
        return self.text.count("\n", 0, index) + 1

    @property
    def doctype_line(self) -> int | None:
        """The line of a document type declaration, ``None`` when there is none."""
        prolog = _TO_DOCTYPE.match(self.text)
        return None if prolog is None else self.line_of(prolog.end())

    @property
    def root_name_end(self) -> int | None:
        """The byte offset behind the name of the document element."""
        name = _TO_ROOT_NAME.match(self.text)
        return None if name is None else self.offset + len(name[0].encode(self.encoding))


def read_head(data: bytes) -> Head:
    """Decode the first bytes of a document."""
    length, encoding = next(row[1:] for row in _STARTS if data.startswith(row[0]))
    return Head(data[length:HEAD_BYTES].decode(encoding, "ignore"), length, encoding)


def looks_like_xml(data: bytes) -> bool:
    """Return whether the first character that is not white space is ``<``."""
    return read_head(data[:HEAD_BYTES]).text.lstrip().startswith("<")


def syntax_hint(head: Head, message: str) -> str | None:
    """Return what to do about a syntax error, where the cause is a common one."""
    text = head.text
    declaration = _DECLARATION.search(text)
    if not text.strip():
        return "the file is empty"
    if declaration and declaration.start() > 0:
        return (
            "the XML declaration must be the first thing in the file; "
            "move the text before it below it"
        )
    if declaration and text[: text.find(">") + 1].count('"') % 2:
        return "quote missing in the XML declaration"
    if "Premature end of data" in message or "EndTag: '</' not found" in message:
        return "the file is cut off: the end tag of the first element is missing"
    return None if text.lstrip().startswith("<") else "this is not an XML file"

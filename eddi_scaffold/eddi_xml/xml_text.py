"""Inspect XML without parsing it: the prolog, and hints for broken files."""

from __future__ import annotations

import codecs
import re
from typing import NamedTuple

HEAD_BYTES = 1 << 16  # how much of a file is looked at before it is parsed

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
_PROLOG = re.compile(r"(?:[^<]|<!--.*?-->|<\?.*?\?>)*", re.DOTALL)
"""Up to a document type declaration or the document element. Nothing may follow in this pattern:
it would try every way to divide the comments."""
_ROOT_NAME = re.compile(r"<[^\s/>!?]+")


class Head(NamedTuple):
    """The first bytes of a document, decoded far enough to see its markup."""

    # the text after a byte order mark; other than UTF-16 read as Latin-1, which keeps byte offsets
    # and every ASCII character
    text: str
    offset: int  # bytes before the text
    encoding: str  # codec of `text`

    def line_of(self, index: int) -> int:
        """Return the line, counted from 1, of a character of ``text``."""
        return self.text.count("\n", 0, index) + 1

    @property
    def prolog_end(self) -> int:
        """The index in ``text`` behind comments and processing instructions."""
        prolog = _PROLOG.match(self.text)
        return prolog.end() if prolog is not None else 0

    @property
    def doctype_line(self) -> int | None:
        """The line of a document type declaration, ``None`` when there is none."""
        is_there = self.text.startswith("<!DOCTYPE", self.prolog_end)
        return self.line_of(self.prolog_end) if is_there else None

    @property
    def root_name_end(self) -> int | None:
        """The byte offset behind the name of the document element."""
        name = _ROOT_NAME.match(self.text, self.prolog_end)
        if name is None:
            return None
        return self.offset + len(self.text[: name.end()].encode(self.encoding))


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

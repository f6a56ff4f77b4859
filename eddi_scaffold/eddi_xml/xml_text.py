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

    # after a byte order mark; other than UTF-16 read as Latin-1, which keeps byte offsets and every
    # ASCII character
    text: str
    encoding: str  # codec of `text`
    root_line: int  # of a document type declaration, or of the document element
    has_doctype: bool
    root_name_end: int | None  # byte offset behind the name of the document element


def read_head(data: bytes) -> Head:
    """Decode the first bytes of a document."""
    length, encoding = next(row[1:] for row in _STARTS if data.startswith(row[0]))
    text = data[length:HEAD_BYTES].decode(encoding, "ignore")
    prolog = _PROLOG.match(text)
    start = prolog.end() if prolog is not None else 0
    name = _ROOT_NAME.match(text, start)
    end = None if name is None else length + len(text[: name.end()].encode(encoding))
    line = text.count("\n", 0, start) + 1
    return Head(text, encoding, line, text.startswith("<!DOCTYPE", start), end)


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

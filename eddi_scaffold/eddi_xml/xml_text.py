"""Inspect XML without parsing it: the prolog, and hints for broken files."""

from __future__ import annotations

import codecs
import re
from dataclasses import dataclass

HEAD_BYTES = 1 << 16
"""How much of a file is looked at before it is parsed."""

_ENCODINGS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
    (b"<\0", "utf-16-le"),
    (b"\0<", "utf-16-be"),
)
_DECLARATION = re.compile(r"<\?xml\s")
_ROOT_NAME = re.compile(r"<[^\s/>]+")


@dataclass(frozen=True)
class Head:
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

    def byte_offset(self, index: int) -> int:
        """Return the offset in the file of a character of ``text``."""
        return self.offset + len(self.text[:index].encode(self.encoding))

    def line_of(self, index: int) -> int:
        """Return the line, counted from 1, of a character of ``text``."""
        return self.text.count("\n", 0, index) + 1


def read_head(data: bytes) -> Head:
    """Decode the first bytes of a document."""
    for mark, encoding in _ENCODINGS:
        if data.startswith(mark):
            offset = 0 if mark[0] in b"<\0" else len(mark)
            codec = "latin-1" if encoding == "utf-8" else encoding
            return Head(data[offset:HEAD_BYTES].decode(codec, "ignore"), offset, codec)
    return Head(data[:HEAD_BYTES].decode("latin-1"), 0, "latin-1")


def looks_like_xml(data: bytes) -> bool:
    """Return whether the first character that is not white space is ``<``."""
    return read_head(data[:HEAD_BYTES]).text.lstrip().startswith("<")


def prolog_end(text: str) -> int:
    """Return the index of the first ``<`` that starts neither a comment nor an instruction.

    That is the document element or a document type declaration; ``len(text)`` when there is none.
    """
    position = 0
    while True:
        position = text.find("<", position)
        if position < 0:
            return len(text)
        for start, end in (("<!--", "-->"), ("<?", "?>")):
            if text.startswith(start, position):
                found = text.find(end, position + len(start))
                position = found + len(end) if found >= 0 else len(text)
                break
        else:
            return position


def doctype_line(head: Head) -> int | None:
    """Return the line of a document type declaration, ``None`` when there is none."""
    start = prolog_end(head.text)
    return head.line_of(start) if head.text.startswith("<!DOCTYPE", start) else None


def root_name_end(head: Head) -> int | None:
    """Return the byte offset behind the name of the document element."""
    match = _ROOT_NAME.match(head.text, prolog_end(head.text))
    return head.byte_offset(match.end()) if match else None


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
    if not text.lstrip().startswith("<"):
        return "this is not an XML file"
    return None

"""The internal document type of XMLBIF files: harmless ones are blanked, all else is refused.

Tools write the declarations of the format's elements into each file. Entities and external
subsets, by which a file can explode or reach for others, are refused.
"""

from __future__ import annotations

import re

from eddi_scaffold.problems import Place, Problem, error
from eddi_scaffold.source import Source

_DOCTYPE = re.compile(rb"<!DOCTYPE\s+BIF\s*(?:\[(?P<inner>[^\[\]]*)\]\s*)?>")
_HARMLESS = re.compile(rb"(?:\s+|<!(?:ELEMENT|ATTLIST)\b[^<>&%]*>|<!--(?:(?!--).)*-->)*", re.DOTALL)


def without_doctype(source: Source) -> tuple[Source, list[Problem]]:
    """Return the file with blanks in place of a harmless document type; lines stay."""
    data = source.data
    start = data.find(b"<!DOCTYPE")
    if start < 0:
        return source, []
    match = _DOCTYPE.match(data, start)
    if match is None or not _HARMLESS.fullmatch(match["inner"] or b""):
        line = data.count(b"\n", 0, start) + 1
        message = "the document type declares more than elements and attributes, which is refused"
        hint = "remove the <!DOCTYPE ...> declaration"
        return Source(source.name, b""), [error("X002", message, Place(source.name, line), hint)]
    blank = re.sub(rb"[^\n]", b" ", match.group())
    return Source(source.name, data[:start] + blank + data[match.end() :]), []

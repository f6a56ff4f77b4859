"""Write a map of ours into the text of an EDDI: every other byte stays as it is.

Writing the parsed tree again would change blanks, quotes and the order of name spaces in a file
that belongs to another tool. So the place is found in the text: the start tags in it are the
elements of the tree, in the same order.
"""

from __future__ import annotations

import codecs
import re
from collections.abc import Sequence
from typing import NamedTuple

from eddi_scaffold.common.escaping import xml_text
from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.eddi_xml.extensions import extension_maps
from eddi_scaffold.eddi_xml.parsing import Element, encoding_of

_MARKUP = re.compile(
    r"<!--.*?-->|<\?.*?\?>|<!\[CDATA\[.*?\]\]>"
    r"|<(?P<end>/?)(?P<name>[^\s/>!?]+)(?:[^>\"']|\"[^\"]*\"|'[^']*')*?(?P<empty>/?)>",
    re.DOTALL,
)
_ONLY_IN_EDDI = ("frequency", "artifact")
"""Tags of maps that are in no file of their own: they outlive a newer one."""


class _Span(NamedTuple):
    start: int
    start_ends: int
    end: int
    name: str
    empty: bool


def with_map(
    data: bytes, document: EddiDocument, at: Element, key: str, values: Sequence[tuple[str, str]]
) -> bytes:
    """Return an EDDI with a map on an element, also for one of its model (EddiError, X036)."""
    mark = codecs.BOM_UTF8 if data.startswith(codecs.BOM_UTF8) else b""
    encoding = encoding_of(document.document)
    try:
        text = data[len(mark) :].decode(encoding)
        is_same = text.encode(encoding) == data[len(mark) :]
    except (LookupError, UnicodeError):
        is_same = False
    elements = list(document.document.iter())
    spans = _spans(text) if is_same else []
    if len(spans) != len(elements):
        raise EddiError(problem("X036.encoding", Place(document.name), encoding=encoding))
    span = dict(zip(elements, spans, strict=True))
    line_end = "\r\n" if "\r\n" in text else "\n"
    start, end, before, after, indent = _gap(
        text, span[at], [span[child] for child in at], line_end
    )
    for old in extension_maps(document, key):
        if old.owner is at and old.model == values[0][1]:
            tags = {tag for tag, _ in values}
            kept = [(v.tag, v.text) for v in old.of(*_ONLY_IN_EDDI) if v.tag not in tags]
            values = [*values[:1], *kept, *values[1:]]
            start, end, before, after = span[old.element].start, span[old.element].end, "", ""
            indent = _indent(text, start)
    lines = [
        f'<keyValueMaps key="{key}">',
        *(
            f'  <values tag="{xml_text(tag)}" value="{xml_text(value).replace("&gt;", ">")}"/>'
            for tag, value in values  # conditions compare a lot, and ">" may stand in a value
        ),
        "</keyValueMaps>",
    ]
    block = before + f"{line_end}{indent}".join(lines) + after
    return mark + (text[:start] + block + text[end:]).encode(encoding, "xmlcharrefreplace")


def _spans(text: str) -> list[_Span]:
    spans: list[_Span] = []
    open_: list[int] = []
    for match in _MARKUP.finditer(text):
        start, end = match.span()
        if match["name"] is None:
            continue
        if match["end"]:
            if open_:
                number = open_.pop()
                spans[number] = spans[number]._replace(end=end)
            continue
        spans.append(_Span(start, end, end, match["name"], bool(match["empty"])))
        if not match["empty"]:
            open_.append(len(spans) - 1)
    return spans


def _gap(
    text: str, at: _Span, children: Sequence[_Span], line_end: str
) -> tuple[int, int, str, str, str]:
    """Return where a first child goes: from, to, what comes before and after it, its indent."""
    outer = _indent(text, at.start)
    inner = f"{outer}  "
    if children and "\n" in text[at.start_ends : children[0].start]:
        inner = _indent(text, children[0].start)
    before = f"{line_end}{inner}"
    if at.empty:
        opened = text[at.start : at.start_ends].removesuffix("/>").rstrip() + ">"
        return at.start, at.end, opened + before, f"{line_end}{outer}</{at.name}>", inner
    rest = text[at.start_ends :]
    has_line_end = "\n" in rest[: len(rest) - len(rest.lstrip())]
    after = before if children and not has_line_end else ""
    return at.start_ends, at.start_ends, before, after, inner


def _indent(text: str, start: int) -> str:
    before = text[text.rfind("\n", 0, start) + 1 : start]
    return before if not before.strip() else ""

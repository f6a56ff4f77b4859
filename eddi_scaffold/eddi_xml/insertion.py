"""Write a map of ours into the text of an EDDI: every other byte stays as it is.

Writing the parsed tree again would change blanks, quotes and the order of name spaces in a file
that belongs to another tool. So the place is found in the text: the start tags in it are the
elements of the tree, in the same order.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

from eddi_scaffold.common.escaping import xml_text
from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.eddi_xml.extensions import extension_maps
from eddi_scaffold.eddi_xml.parsing import encoding_of

if TYPE_CHECKING:
    from eddi_scaffold.eddi_xml.document import EddiDocument
    from eddi_scaffold.eddi_xml.parsing import Element

_MARKUP = re.compile(
    r"<!--.*?-->|<\?.*?\?>|<!\[CDATA\[.*?\]\]>"
    r"|<(?P<end>/?)(?P<name>[^\s/>!?]+)(?:[^>\"']|\"[^\"]*\"|'[^']*')*?(?P<empty>/?)>",
    re.DOTALL,
)
_ONLY_HERE = ("frequency", "artifact")
"""Tags of maps that are in no file of their own: they outlive a newer one."""
_MARK = b"\xef\xbb\xbf"


class _Span(NamedTuple):
    """Where an element stands in the text."""

    start: int
    start_ends: int
    end: int
    name: str
    empty: bool


def with_map(
    data: bytes, document: EddiDocument, at: Element, key: str, values: Sequence[tuple[str, str]]
) -> bytes:
    """Return the bytes of an EDDI with a map on an element; one of the same model is replaced.

    Args:
        data: the file.
        document: the same, parsed.
        at: the element.
        key: of the map.
        values: tags and texts, that of the model first; what a file of its own has no place for
            stays as it was.

    Raises:
        EddiError: the file cannot be changed as a text (X036).
    """
    mark = _MARK if data.startswith(_MARK) else b""
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
    model = values[0][1]
    own = [
        extension_map
        for extension_map in extension_maps(document, key)
        if extension_map.owner is at and extension_map.model == model
    ]
    if own:
        old = span[own[0].element]
        tags = {tag for tag, _ in values}
        kept = [(one.tag, one.text) for one in own[0].of(*_ONLY_HERE) if one.tag not in tags]
        block = _block(
            key, [*values[:1], *kept, *values[1:]], _indent(text, old.start), _line_end(text)
        )
        new = text[: old.start] + block.lstrip() + text[old.end :]
    else:
        new = _inserted(text, span[at], [span[child] for child in at], key, values)
    return mark + new.encode(encoding, "xmlcharrefreplace")


def _spans(text: str) -> list[_Span]:
    """Return the elements of a well-formed text, in the order of their start tags."""
    found: list[_Span] = []
    open_: list[int] = []
    for match in _MARKUP.finditer(text):
        if match["name"] is None:
            continue
        if not match["end"]:
            found.append(
                _Span(match.start(), match.end(), match.end(), match["name"], bool(match["empty"]))
            )
            if not match["empty"]:
                open_.append(len(found) - 1)
        elif open_:
            number = open_.pop()
            found[number] = found[number]._replace(end=match.end())
    return found


def _inserted(
    text: str, at: _Span, children: Sequence[_Span], key: str, values: Sequence[tuple[str, str]]
) -> str:
    """Put a map before the first child of an element."""
    line_end, outer = _line_end(text), _indent(text, at.start)
    between = text[at.start_ends : children[0].start] if children else ""
    inner = _indent(text, children[0].start) if "\n" in between else f"{outer}  "
    block = _block(key, values, inner, line_end)
    if at.empty:
        opened = text[at.start : at.start_ends].removesuffix("/>").rstrip() + ">"
        whole = f"{opened}{block}{line_end}{outer}</{at.name}>"
        return text[: at.start] + whole + text[at.end :]
    rest = text[at.start_ends :]
    gap = "" if rest[: len(rest) - len(rest.lstrip())].count("\n") else f"{line_end}{inner}"
    return text[: at.start_ends] + block + (gap if children else "") + rest


def _block(key: str, values: Sequence[tuple[str, str]], indent: str, line_end: str) -> str:
    lines = [f'<keyValueMaps key="{key}">']
    lines += [
        f'  <values tag="{xml_text(tag)}" value="{xml_text(value).replace("&gt;", ">")}"/>'
        for tag, value in values  # conditions compare a lot, and ">" may stand in a value
    ]
    return "".join(f"{line_end}{indent}{line}" for line in [*lines, "</keyValueMaps>"])


def _indent(text: str, start: int) -> str:
    before = text[text.rfind("\n", 0, start) + 1 : start]
    return before if not before.strip() else ""


def _line_end(text: str) -> str:
    return "\r\n" if "\r\n" in text else "\n"

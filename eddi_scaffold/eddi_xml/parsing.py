"""Load XMI: the only module that imports lxml. Models are untrusted, so the parser is hardened.

No document type declaration, no entity, no network, no other file; libxml2 limits the depth to
256 and a text or attribute to 10 MB because ``huge_tree`` stays off.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, BinaryIO, TypeAlias

from lxml import etree

from eddi_scaffold.common.problems import Place, Problem, problem
from eddi_scaffold.eddi_xml.vocabulary import local_name
from eddi_scaffold.eddi_xml.xml_text import (
    HEAD_BYTES,
    Head,
    doctype_line,
    read_head,
    root_name_end,
    syntax_hint,
)

Element: TypeAlias = etree._Element  # noqa: SLF001 - lxml has no public name for it
XSI = "http://www.w3.org/2001/XMLSchema-instance"
XSI_TYPE = f"{{{XSI}}}type"
XMI = "http://www.omg.org/XMI"

_KNOWN_PREFIXES = {"xsi": XSI, "xmi": XMI}
_UNDECLARED = re.compile(r"Namespace prefix (\S+) (?:for \S+ )?on \S+ is not defined")
_QUOTES = ("ERR_LT_IN_ATTRIBUTE", "ERR_ATTRIBUTE_NOT_FINISHED")
"""How a quote that is not closed shows: far behind it."""
_START_TAG = re.compile(r"end of Start Tag \S+ line (\d+)")
_MAX_REPAIRS = 100
_LAST_LINE = 65535
# Between two "<" lie at least 5 bytes per attribute: no window of half of that without "<" means
# no element with more than 1,000 attributes, at a thousandth of the cost of looking at each.
_WINDOW = 2500
_ASCII_LIKE = re.compile(r"(?i)(us-?)?ascii|utf-?8|iso-8859-\d+|windows-125\d")


@dataclass(frozen=True)
class Limits:
    """How large an untrusted model may be.

    Attributes:
        file_bytes: size of the file, checked before parsing.
        attributes: attributes of one element.
        reference_tokens: references in one attribute.
    """

    file_bytes: int = 64 * 1024 * 1024
    attributes: int = 1000
    reference_tokens: int = 100_000


DEFAULT_LIMITS = Limits()


@dataclass(frozen=True)
class XmlDocument:
    """A parsed document.

    Attributes:
        document: the document element, which is ``xmi:XMI`` when there are several roots.
        roots: the root objects.
    """

    document: Element
    roots: tuple[Element, ...]


def load(
    stream: BinaryIO,
    name: str,
    limits: Limits = DEFAULT_LIMITS,
) -> tuple[XmlDocument | None, list[Problem]]:
    """Parse a document from a seekable stream.

    Returns:
        The tree, or ``None`` after an error, and the problems X001, X003, X006.
    """
    size = stream.seek(0, 2)
    if size > limits.file_bytes:
        return None, [_limit("the size of the file in bytes", size, limits.file_bytes, Place(name))]
    stream.seek(0)
    head = read_head(stream.read(HEAD_BYTES))
    line = doctype_line(head)
    if line is not None:
        return None, [_doctype(Place(name, line))]
    document, undeclared, fault = _parse(stream, head, name)
    if document is None:
        return None, [fault] if fault else []
    if _docinfo(document).doctype:
        return None, [_doctype(Place(name, 1))]
    crowded = _crowded(document, stream, limits.attributes)
    if crowded is not None:
        place = Place(name, line_of(crowded))
        count = len(crowded.attrib)
        return None, [_limit("the number of attributes", count, limits.attributes, place)]
    return XmlDocument(document, _roots(document)), [
        problem("X006.prefix", Place(name, line_of(document)), prefix=prefix)
        for prefix in undeclared
    ]


def line_of(element: Element) -> int | None:
    """Return the line of an element, counted from 1.

    libxml2 stores lines of elements up to 65,534. Above that it answers with the line on which
    the next text ends, from which the line of the element follows.
    """
    stated: Any = element.sourceline  # the stubs give it no type
    if not isinstance(stated, int) or stated < _LAST_LINE:
        return stated if isinstance(stated, int) else None
    node: Element | None = element
    while node is not None:
        text = node.text or (None if len(node) else node.tail)
        if text:
            return stated - str(text).count("\n")
        node = node[0] if len(node) else node.getnext()
    return stated


def select(element: Element, query: str) -> list[Any]:
    """Return what an XPath query finds: elements or texts."""
    found = element.xpath(query)
    return found if isinstance(found, list) else []


def encoding_of(document: Element) -> str:
    """Return the encoding that a file was read in."""
    return str(_docinfo(document).encoding or "UTF-8")


def feature_of(element: Element) -> str:
    """Return the name of the feature that contains an element: its tag without namespace."""
    return local_name(str(element.tag))


def only(
    elements: Sequence[Element], case: str, place: Callable[[Element], Place]
) -> tuple[Element | None, list[Problem]]:
    """Return the one element that may be there, and an error at each further one.

    Args:
        elements: all that give the same value.
        case: of the errors.
        place: of an element.
    """
    return next(iter(elements), None), [
        problem(case, place(again), feature=feature_of(again), line=line_of(elements[0]))
        for again in elements[1:]
    ]


def text_of(element: Element) -> str:
    """Return all text inside an element."""
    return "".join(str(part) for part in element.itertext())


def stray_texts(element: Element, *, deep: bool = True) -> list[tuple[Element, str]]:
    """Return the texts inside an element that are not white space, each with its parent.

    One alone in an element without attributes is none: so EMF writes an attribute of many values.

    Args:
        element: where to look.
        deep: look inside its children too.
    """
    steps = "descendant-or-self::*[@* or *]/" if deep else ""
    texts = select(element, f"{steps}text()[normalize-space()]")
    found: list[tuple[Element, str]] = []
    for text in texts:
        before = text.getparent()  # for a tail: the sibling that it follows
        parent = before.getparent() if text.is_tail else before
        found.append((before if parent is None else parent, text.strip()))
    return found


class _Input:
    """A stream with an insertion, as lxml reads it."""

    def __init__(self, stream: BinaryIO, at: int = 0, insertion: bytes = b"") -> None:
        stream.seek(0)
        self._stream = stream
        self._pending = stream.read(at) + insertion

    def read(self, size: int = -1) -> bytes:
        if self._pending:
            pending, self._pending = self._pending, b""
            return pending
        return self._stream.read(size)


def _parser() -> etree.XMLParser:
    return etree.XMLParser(
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        dtd_validation=False,
        huge_tree=False,
        remove_comments=True,
        remove_pis=True,
    )


def _parse(
    stream: BinaryIO, head: Head, name: str
) -> tuple[Element | None, list[str], Problem | None]:
    """Parse strictly; where only prefixes are undeclared, declare them and parse strictly again.

    Recovery of libxml2 would accept such files too, but silently repairs much else, and its error
    log, which could show it, ends after 100 entries.
    """
    undeclared: list[str] = []
    at = root_name_end(head)
    for _ in range(_MAX_REPAIRS):
        declared = "".join(f' xmlns:{p}="{_KNOWN_PREFIXES.get(p, p)}"' for p in undeclared)
        content: Any = _Input(stream, at or 0, declared.encode(head.encoding, "replace"))
        parser = _parser()
        try:
            return etree.parse(content, parser).getroot(), undeclared, None
        except (etree.XMLSyntaxError, LookupError, ValueError) as failure:
            missing = _missing_prefixes(parser)
            new = [prefix for prefix in missing if prefix not in undeclared]
            if not new or at is None:
                return None, [], _syntax_error(failure, parser, head, name, repaired=bool(declared))
            undeclared += new
    return None, [], problem("X001.prefixes", Place(name, 1))


def _errors(parser: etree.XMLParser) -> list[Any]:
    """Return what stops the parser; it also warns, of relative namespaces for example."""
    return [entry for entry in parser.error_log if entry.level_name != "WARNING"]


def _missing_prefixes(parser: etree.XMLParser) -> list[str]:
    """Return the undeclared prefixes when nothing else is wrong, else nothing."""
    found: dict[str, None] = {}
    for entry in _errors(parser):
        match = _UNDECLARED.match(entry.message)
        if entry.type_name != "NS_ERR_UNDEFINED_NAMESPACE" or match is None:
            return []
        found[match.group(1)] = None
    return list(found)


def _syntax_error(
    failure: Exception, parser: etree.XMLParser, head: Head, name: str, *, repaired: bool
) -> Problem:
    entries = [e for e in _errors(parser) if e.type_name != "NS_ERR_UNDEFINED_NAMESPACE"]
    message = " ".join((entries[0].message if entries else str(failure)).split()).rstrip(".")
    line = entries[0].line if entries else getattr(failure, "lineno", None) or 1
    shifted = repaired and line == head.line_of(root_name_end(head) or 0)
    column = None if shifted or not entries else entries[0].column
    place = Place(name, max(line, 1), column or None)
    if entries and entries[0].type_name in _QUOTES:
        starts = [int(m[1]) for e in entries if (m := _START_TAG.search(e.message))]
        if starts and starts[0] < line:
            place = Place(name, starts[0])
        return problem("X001.quote", place, reason=message)
    if "XML_PARSE_HUGE" in message or "too long" in message or "Resource limit" in message:
        return problem("X003.parser", place, hint=_FIXED, reason=message)
    return problem("X001.syntax", place, hint=syntax_hint(head, message), reason=message)


_FIXED = "depth 256 and 10 MB per text or attribute are fixed limits; split the model"


def _roots(document: Element) -> tuple[Element, ...]:
    if local_name(str(document.tag)) == "XMI":
        return tuple(document.iterchildren())
    return (document,)


def _crowded(document: Element, stream: BinaryIO, limit: int) -> Element | None:
    """Return an element with too many attributes."""
    encoding = encoding_of(document)
    if _ASCII_LIKE.fullmatch(encoding) and limit * 5 >= 2 * _WINDOW and not _has_gap(stream):
        return None
    found: list[Element] = select(document, f"descendant-or-self::*[count(@*) > {limit}]")
    return found[0] if found else None


def _docinfo(document: Element) -> Any:
    return document.getroottree().docinfo  # the stubs lack half of its attributes


def _has_gap(stream: BinaryIO) -> bool:
    """Return whether some window of the file has no ``<``: needed for a very long start tag."""
    stream.seek(0)
    while block := stream.read(_WINDOW * 40):
        for start in range(0, len(block) - _WINDOW + 1, _WINDOW):
            if block.find(b"<", start, start + _WINDOW) < 0:
                return True
    return False


def _doctype(place: Place) -> Problem:
    return problem("X001.declaration", place)


def _limit(what: str, value: int, limit: int, place: Place) -> Problem:
    return problem("X003.size", place, subject=what, value=value, limit=limit)

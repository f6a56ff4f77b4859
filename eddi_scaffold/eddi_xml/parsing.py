"""Load XMI: the only module that imports lxml. Models are untrusted, so the parser is hardened.

No document type declaration, no entity, no network, no other file; libxml2 limits the depth to
256 and a text or attribute to 10 MB because ``huge_tree`` stays off.
"""

from __future__ import annotations

import codecs
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, TypeAlias

from lxml import etree

from eddi_scaffold.common.problems import Place, Problem, problem
from eddi_scaffold.eddi_xml.vocabulary import local_name

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


MAX_ATTRIBUTES = 1000  # of one element, which lxml looks up one by one
MAX_REFERENCES = 100_000  # in one attribute


def load(data: bytes, name: str) -> tuple[Element | None, list[Problem]]:
    """Parse the bytes of a document; ``None`` after an error (X001, X003)."""
    head = read_head(data)
    if head.has_doctype:
        return None, [problem("X001.declaration", Place(name, head.root_line))]
    document, undeclared, fault = _parse(data, head, name)
    if document is None or fault is not None:
        return None, [fault] if fault else []
    if _docinfo(document).doctype:
        return None, [problem("X001.declaration", Place(name, 1))]
    crowded = select(document, f"descendant-or-self::*[@*[{MAX_ATTRIBUTES + 1}]]")
    if crowded:
        place, count = Place(name, line_of(crowded[0])), len(crowded[0].attrib)
        return None, [problem("X003.attributes", place, value=count, limit=MAX_ATTRIBUTES)]
    place = Place(name, line_of(document))
    return document, [problem("X006.prefix", place, prefix=prefix) for prefix in undeclared]


def new_element(tag: str, parent: Element | None, attributes: Mapping[str, str]) -> Element:
    """Return a new element, the last child of its parent."""
    element = etree.Element(tag, dict(attributes))
    if parent is not None:
        parent.append(element)
    return element


def line_of(element: Element) -> int | None:
    """Return the line of an element, counted from 1; libxml2 knows none beyond 65534."""
    stated: Any = element.sourceline  # the stubs give it no type
    line: int | None = stated
    return line if line is None or line < _LAST_LINE else None


def select(element: Element, query: str) -> list[Any]:
    """Return what an XPath query finds: elements or texts."""
    result = element.xpath(query)
    return result if isinstance(result, list) else []


def encoding_of(document: Element) -> str:
    """Return the encoding that a file was read in."""
    return str(_docinfo(document).encoding or "UTF-8")


def feature_of(element: Element) -> str:
    """Return the name of the feature that contains an element: its tag without namespace."""
    return local_name(str(element.tag))


def only(
    elements: Sequence[Element], case: str, place: Callable[[Element], Place]
) -> tuple[Element | None, list[Problem]]:
    """Return the one element that may be there, and an error at each further one."""
    return next(iter(elements), None), [
        problem(case, place(again), feature=feature_of(again), line=place(elements[0]).line)
        for again in elements[1:]
    ]


def text_of(element: Element) -> str:
    """Return all text inside an element."""
    return "".join(str(part) for part in element.itertext())


def _parse(data: bytes, head: Head, name: str) -> tuple[Element | None, list[str], Problem | None]:
    """Parse strictly; where only prefixes are undeclared, declare them and parse strictly again."""
    # recovery of libxml2 silently repairs much else, and its log ends after 100 entries
    undeclared: list[str] = []
    at = head.root_name_end
    for _ in range(_MAX_REPAIRS):
        declared = "".join(f' xmlns:{p}="{_KNOWN_PREFIXES.get(p, p)}"' for p in undeclared)
        insertion = declared.encode(head.encoding, "replace")
        parser = etree.XMLParser(
            resolve_entities=False,
            no_network=True,
            load_dtd=False,
            dtd_validation=False,
            huge_tree=False,
            remove_comments=True,
            remove_pis=True,
        )
        try:
            content = b"".join((data[: at or 0], insertion, data[at or 0 :])) if declared else data
            return etree.fromstring(content, parser), undeclared, None
        except (etree.XMLSyntaxError, LookupError, ValueError) as failure:
            # it also warns, of relative namespaces for example
            faults = [entry for entry in parser.error_log if entry.level_name != "WARNING"]
            matches = [_UNDECLARED.match(entry.message) for entry in faults]
            missing = dict.fromkeys(m[1] for m in matches if m and m[1] not in undeclared)
            if not missing or None in matches or at is None:
                fault = _syntax_error(failure, faults, name)
                if declared and fault.place.line == head.root_line:  # longer by what is declared
                    fault = replace(fault, place=replace(fault.place, col=None))
                return None, [], fault
            undeclared += missing
    return None, [], problem("X001.prefixes", Place(name, 1))


def _syntax_error(failure: Exception, faults: Sequence[Any], name: str) -> Problem:
    entries = [e for e in faults if e.type_name != "NS_ERR_UNDEFINED_NAMESPACE"]
    message = " ".join((entries[0].message if entries else str(failure)).split()).rstrip(".")
    line = entries[0].line if entries else getattr(failure, "lineno", None) or 1
    place = Place(name, max(line, 1), (entries[0].column if entries else None) or None)
    if entries and entries[0].type_name in _QUOTES:
        starts = [int(m[1]) for e in entries if (m := _START_TAG.search(e.message))]
        if starts and starts[0] < line:
            place = Place(name, starts[0])
        return problem("X001.quote", place, reason=message)
    if "XML_PARSE_HUGE" in message or "too long" in message or "Resource limit" in message:
        return problem("X003.parser", place, reason=message)
    return problem("X001.syntax", place, reason=message)


def _docinfo(document: Element) -> Any:
    return document.getroottree().docinfo  # the stubs lack half of its attributes

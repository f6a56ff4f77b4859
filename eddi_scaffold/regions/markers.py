"""The marker lines of editable regions: read, write, and split a file at them.

Written forms, one per kind of file (``--`` is not allowed inside an XML comment, so the dashes
of SESAME D7.2 Fig 15 give way to a bar there)::

    '''-----Manual edit begin-----'''  # region: input:RtE_A_E0 was: input:old sig: 1a2b3c4d
    '''-----Manual edit end-----'''  # region: input:RtE_A_E0
    <!-- Manual edit begin | region: xml:depends -->
    # -----Manual edit begin-----  # region: cmake:install

Read as well: no id (D7.2), three or more dashes, any quotes or none, any indentation.
"""

from __future__ import annotations

import re
import urllib.parse
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

Style = Literal["python", "xml", "hash"]

_DASHED = re.compile(
    r"""^\s*(?:\#\s*)?(?P<quote>'''|\"\"\"|'|"|)\s*-{3,}\s*Manual\ edit\ (?P<what>begin|end)
        \s*-{3,}\s*(?P=quote)\s*(?:\#?\s*region:\s*(?P<tail>.*?)|\#)?\s*$""",
    re.VERBOSE,
)
_XML = re.compile(
    r"""^\s*<!--\s*-*\s*Manual\ edit\ (?P<what>begin|end)\s*-*?\s*
        (?:\|?\s*region:\s*(?P<tail>.*?))?\s*-->\s*$""",
    re.VERBOSE,
)
_ALIKE = re.compile(r"-{3,}\s*Manual edit (?:begin|end)\s*-{3,}|<!--[^>]*Manual edit (?:begin|end)")
_TAIL = re.compile(r"^(\S+)(?:\s+was:\s*(\S+(?:\s*,\s*\S+)*?))?(?:\s+sig:\s*([0-9a-f]{8}))?$")
_SIG = re.compile(r"\s+sig:\s*[0-9a-f]{8}(?=\s|$)")
_CONFLICT = re.compile(r"^(?:<{7}|>{7})(?:\s|$)")
_DEFINITION = re.compile(r"^([ \t]*)(?:async\s+)?(def|class)\s+(\w+)")
_PLACEHOLDER = re.compile(r"^\s*'''eddi region (\S+)'''\s*$")


@dataclass(frozen=True)
class Fault:
    """Why a file's markers cannot be trusted.

    Attributes:
        line: line in the file, counted from 1.
        reason: what is wrong and what to do about it.
    """

    line: int
    reason: str


@dataclass(frozen=True)
class Region:
    """One editable region of a file.

    Attributes:
        id: ``<kind>:<id>``, decoded; of a region without id ``function:<Class.method>``.
        explicit: whether a marker names the id.
        function: qualified name of the enclosing function, empty outside of functions.
        was: ids under which the element was known before, the newest first.
        sig: hash of what the body may use when it was written, ``None`` when not said.
        line: line of the begin marker, counted from 1.
        begin: the begin marker's line, without line end.
        body: the text between the markers, byte for byte.
        end: the end marker's line, without line end.
    """

    id: str
    explicit: bool
    function: str
    was: tuple[str, ...]
    sig: str | None
    line: int
    begin: str
    body: str
    end: str

    @property
    def indent(self) -> str:
        """Blanks before the begin marker."""
        return indent_of(self.begin)


@dataclass(frozen=True)
class Document:
    """A file split at its markers.

    Attributes:
        parts: lines outside of regions (with line end) and regions, in file order.
    """

    parts: tuple[str | Region, ...]

    @cached_property
    def regions(self) -> dict[str, Region]:
        """The regions by id, in file order."""
        return {part.id: part for part in self.parts if isinstance(part, Region)}

    @property
    def skeleton(self) -> list[str]:
        """The lines with one placeholder line for each region: what is compared and merged."""
        return [p if isinstance(p, str) else placeholder(p.id, p.indent) for p in self.parts]


@dataclass(frozen=True)
class _Marker:
    what: str
    line: int
    text: str
    id: str | None
    was: tuple[str, ...]
    sig: str | None


@dataclass(frozen=True)
class _Scope:
    line: int
    indent: int
    kind: str
    name: str


def encode_id(region_id: str) -> str:
    """Return the id as it stands in a marker line.

    Ids come from models and may hold anything: blanks, quotes, commas, line ends. Letters and
    digits of any script stay readable; ``--`` is broken up because XML comments forbid it.
    """
    text = "".join(
        c if c.isalnum() or c in "_.:/-" else urllib.parse.quote(c, safe="", errors="surrogatepass")
        for c in region_id
    )
    return text.replace("--", "-%2D")


def decode_id(text: str) -> str:
    """Return the id that :func:`encode_id` wrote."""
    return urllib.parse.unquote(text, errors="surrogatepass")


def begin_marker(
    region_id: str, style: Style = "python", was: Iterable[str] = (), sig: str | None = None
) -> str:
    """Return the line that opens a region, without indentation and line end.

    Args:
        region_id: ``<kind>:<id>``.
        style: ``python``, ``xml`` (manifests and launch files) or ``hash`` (CMake).
        was: former ids, the newest first.
        sig: 8 hex digits over what the body may use.
    """
    former = ", ".join(encode_id(old) for old in was)
    tail = encode_id(region_id) + (f" was: {former}" if former else "")
    return _written("begin", style, tail + (f" sig: {sig}" if sig else ""))


def end_marker(region_id: str, style: Style = "python") -> str:
    """Return the line that closes a region, without indentation and line end."""
    return _written("end", style, encode_id(region_id))


def with_sig(begin: str, sig: str | None) -> str:
    """Return a begin marker's line that says another signature, or none."""
    bare = _SIG.sub("", begin, count=1)
    if sig is None:
        return bare
    close = re.search(r"\s*-->\s*$", bare)
    at = close.start() if close else len(bare.rstrip())
    return f"{bare[:at]} sig: {sig}{bare[at:]}"


def placeholder(region_id: str, indent: str = "") -> str:
    """Return the skeleton line that stands for a region; a statement, so that Python parses."""
    return f"{indent}'''eddi region {encode_id(region_id)}'''\n"


def placeholder_id(line: str) -> str | None:
    """Return the region that a skeleton line stands for, ``None`` for every other line."""
    match = _PLACEHOLDER.match(line)
    return decode_id(match[1]) if match else None


def indent_of(line: str) -> str:
    """Return the blanks at the start of a line."""
    return line[: len(line) - len(line.lstrip(" \t"))]


def split_lines(text: str) -> list[str]:
    r"""Split at ``\n`` only: form feeds and Unicode separators belong to the text."""
    lines = text.split("\n")
    ends = [line + "\n" for line in lines[:-1]]
    return [*ends, lines[-1]] if lines[-1] else ends


def parse(text: str) -> tuple[Document, list[Fault]]:
    """Split a file's text at its markers.

    Returns:
        The document, and the faults; with any fault the document must not be used.
    """
    lines = split_lines(text)
    faults: list[Fault] = []
    parts: list[str | Region] = []
    scopes = _scopes(lines)
    begin: _Marker | None = None
    body: list[str] = []
    for number, line in enumerate(lines, 1):
        if _CONFLICT.match(line):
            faults.append(Fault(number, "unresolved merge conflict; resolve it first"))
        marker = _marker(line, number, faults)
        if marker is None:
            # Outside, line ends are the generator's; inside, every byte is the person's.
            body.append(line) if begin else parts.append(line.replace("\r\n", "\n"))
        elif marker.what == "begin":
            if begin:
                faults.append(_nested(begin, marker))
            else:
                begin, body = marker, []
        elif begin is None:
            faults.append(
                Fault(number, "end marker without begin; put the begin marker back above it")
            )
        else:
            parts.append(_region(begin, marker, "".join(body), scopes, faults))
            begin = None
    if begin:
        faults.append(
            Fault(begin.line, "the region has no end marker; put it back below the hand code")
        )
    faults.extend(_duplicates(parts))
    return Document(tuple(parts)), sorted(faults, key=lambda f: f.line)


def _written(what: str, style: Style, tail: str) -> str:
    if style == "xml":
        return f"<!-- Manual edit {what} | region: {tail} -->"
    if style == "hash":
        return f"# -----Manual edit {what}-----  # region: {tail}"
    return f"'''-----Manual edit {what}-----'''  # region: {tail}"


def _marker(line: str, number: int, faults: list[Fault]) -> _Marker | None:
    text = line.rstrip("\r\n")
    match = _DASHED.match(text) or _XML.match(text)
    if match is None:
        if _ALIKE.search(text):
            faults.append(
                Fault(number, "a marker must stand alone on its line; move the other text away")
            )
        return None
    if not match["tail"]:
        return _Marker(match["what"], number, text, None, (), None)
    tail = _TAIL.match(match["tail"])
    if tail is None:
        faults.append(
            Fault(
                number,
                "text behind 'region:' is not '<kind>:<id> [was: <old>] [sig: <8 hex digits>]'; "
                "put the generated line back",
            )
        )
        return _Marker(match["what"], number, text, None, (), None)
    was = tuple(decode_id(old.strip()) for old in (tail[2] or "").split(",") if old.strip())
    return _Marker(match["what"], number, text, decode_id(tail[1]), was, tail[3])


def _nested(outer: _Marker, inner: _Marker) -> Fault:
    reason = (
        f"begin marker inside the region that begins in line {outer.line}; "
        "regions do not nest: put the missing end marker back or remove this line"
    )
    return Fault(inner.line, reason)


def _region(
    begin: _Marker, end: _Marker, body: str, scopes: Sequence[_Scope], faults: list[Fault]
) -> Region:
    if begin.id and end.id and begin.id != end.id:
        reason = (
            f"this end marker says {end.id!r} but the begin marker in line {begin.line} says "
            f"{begin.id!r}; give both the same id"
        )
        faults.append(Fault(end.line, reason))
    function = _enclosing_function(scopes, begin)
    region_id = begin.id or end.id
    if region_id is None and not function:
        reason = "a marker without id must stand in a function; write '# region: <kind>:<id>'"
        faults.append(Fault(begin.line, reason))
    return Region(
        id=region_id or f"function:{function}",
        explicit=region_id is not None,
        function=function,
        was=begin.was,
        sig=begin.sig,
        line=begin.line,
        begin=begin.text,
        body=body,
        end=end.text,
    )


def _scopes(lines: Sequence[str]) -> list[_Scope]:
    """Return where definitions begin, the last one first."""
    found = ((number, _DEFINITION.match(line)) for number, line in enumerate(lines, 1))
    return [_Scope(n, len(m[1]), m[2], m[3]) for n, m in found if m][::-1]


def _enclosing_function(scopes: Sequence[_Scope], begin: _Marker) -> str:
    # An editor may have stripped the marker's blanks: then any definition above encloses it.
    limit = len(indent_of(begin.text)) or 10**6
    names: list[str] = []
    for scope in scopes:
        if scope.line < begin.line and scope.indent < limit:
            if not names and scope.kind == "class":
                return ""
            names.append(scope.name)
            limit = scope.indent
            if limit == 0:
                break
    return ".".join(reversed(names))


def _duplicates(parts: Iterable[str | Region]) -> list[Fault]:
    seen: dict[str, int] = {}
    faults = []
    for part in parts:
        if isinstance(part, Region):
            if part.id in seen:
                what = "region" if part.explicit else "region without id in this function"
                reason = (
                    f"second {what} {part.id!r}, the first is in line {seen[part.id]}; "
                    "keep one or give it another id"
                )
                faults.append(Fault(part.line, reason))
            seen.setdefault(part.id, part.line)
    return faults

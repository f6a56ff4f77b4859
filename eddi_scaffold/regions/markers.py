"""The marker lines of editable regions, and the digests in them.

Written forms, one per kind of file (``--`` is not allowed inside an XML comment, so the dashes
of SESAME D7.2 Fig 15 give way to a bar there)::

    '''-----Manual edit begin-----'''  # region: process_Ea of:1a2b3c4d for:81fdda7e was:process_E
    '''-----Manual edit end-----'''  # region: process_Ea
    # -----Manual edit begin-----  # region: cmake.own of:e3b0c442
    <!-- Manual edit begin | region: launch.node of:7fdce92c -->

Read as well: no id (D7.2), three or more dashes, any quotes or none, any indentation.
"""

from __future__ import annotations

import hashlib
import re
import textwrap
import urllib.parse
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal

Style = Literal["python", "xml", "hash"]

# Lines are as long as somebody wants: no two neighbours below can match the same characters.
_DASHED = re.compile(
    r"""(?:\#\s*)?(?:(?P<quote>'''|\"\"\"|'|")\s*)?-{3,}\s*Manual\ edit\ (?P<what>begin|end)
        \s*-{3,}(?(quote)\s*(?P=quote))(?:\s*\#)?\s*(?:region:(?P<tail>.*))?""",
    re.VERBOSE,
)
_XML = re.compile(r"Manual edit (?P<what>begin|end)(?:\s*-+)?\s*(?:(?:\|\s*)?region:(?P<tail>.*))?")
_ALIKE = re.compile(
    r"(?<!-)-{3,}\s*Manual edit (?:begin|end)\s*-{3,}"
    r"|<!--(?:(?!<!--)[^>])*Manual edit (?:begin|end)"
)
_FORMS: Mapping[Style, str] = {
    "python": "'''-----Manual edit {}-----'''  # region: {}",
    "xml": "<!-- Manual edit {} | region: {} -->",
    "hash": "# -----Manual edit {}-----  # region: {}",
}
_HEX = "[0-9a-f]{8}"
_TAIL = re.compile(
    rf"(?P<id>\S+)(?:\s+of:(?P<of>{_HEX}))?(?:\s+for:(?P<uses>{_HEX}))?"
    rf"(?:\s+was:(?P<was>\S+))?(?:\s+now:(?P<now>{_HEX}/(?:{_HEX})?(?:/\S+)?))?"
)


@dataclass(frozen=True)
class Digests:
    """What a body stands for."""

    of: str | None = None  # digest of the generated body that it replaces, None when not known
    uses: str | None = None  # digest of what it may use, None where nothing is used


@dataclass(frozen=True)
class Look:
    """Why a person must look at a body."""

    digests: Digests  # those of today's rendering
    missing: tuple[str, ...] = ()  # names that it uses and nothing generates any more


@dataclass(frozen=True)
class Marker:
    """One marker line."""

    what: str  # `begin` or `end`
    line: int  # counted from 1
    text: str  # without line end
    id: str | None  # decoded, None when not given
    digests: Digests = Digests()
    was: tuple[str, ...] = ()  # former ids, the newest first
    now: Look | None = None


def encode_id(region_id: str) -> str:
    """Return the id, which may be any text, as it is written in a marker line or a file's name."""
    text = "".join(
        c if c.isalnum() or c in "_.:-" else urllib.parse.quote(c, safe="", errors="surrogatepass")
        for c in region_id
    )
    return text.replace("--", "-%2D")  # which comments of XML forbid


def decode_id(text: str) -> str:
    """Return the id that :func:`encode_id` wrote; what it never wrote is an id as it stands."""
    try:
        return urllib.parse.unquote(text, errors="surrogatepass")
    except UnicodeDecodeError:
        return text


def normal(body: str) -> str:
    """Return a body without what editors, formatters and git change: blanks, indentation, ends."""
    lines = [line.rstrip() for line in body.split("\n")]
    return textwrap.dedent("\n".join(lines)).strip("\n")


def digest(body: str) -> str:
    """Return the digest of a body's normal form, 8 hex digits."""
    return _hash(normal(body))[:8]


def text_digest(text: str) -> str:
    """Return the digest of a text in which blanks at line ends do not count, 16 hex digits."""
    return _hash("\n".join(line.rstrip() for line in text.removeprefix("\ufeff").split("\n")))[:16]


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def begin_marker(
    region_id: str,
    style: Style = "python",
    digests: Digests = Digests(),
    was: Iterable[str] = (),
    now: Look | None = None,
) -> str:
    """Return the line that opens a region, without indentation and line end."""
    return _FORMS[style].format("begin", encode_id(region_id) + tail_of(digests, was, now))


def tail_of(digests: Digests, was: Iterable[str] = (), now: Look | None = None) -> str:
    """Return what a begin marker has behind its id."""
    former = ",".join(encode_id(old) for old in was)
    parts = [("of", digests.of), ("for", digests.uses), ("was", former)]
    if now is not None:
        names = ",".join(encode_id(name) for name in now.missing)
        shown = f"{now.digests.of}/{now.digests.uses or ''}{'/' if names else ''}{names}"
        parts.append(("now", shown))
    return "".join(f" {key}:{value}" for key, value in parts if value)


def end_marker(region_id: str, style: Style = "python") -> str:
    """Return the line that closes a region, without indentation and line end."""
    return _FORMS[style].format("end", encode_id(region_id))


def with_tail(begin: str, region_id: str, tail: str) -> str:
    """Return a begin marker's line of any style with this id and what follows it."""
    plain = begin.rstrip()
    close = " -->" if plain.endswith("-->") else ""
    head, found, _ = plain.removesuffix("-->").partition("region:")
    if not found:
        head = head.rstrip() + (" | " if close else "  # ")
    return f"{head}region: {encode_id(region_id)}{tail}{close}"


def indent_of(line: str) -> str:
    """Return the blanks at the start of a line."""
    return line[: len(line) - len(line.lstrip(" \t"))]


def read_marker(line: str, number: int) -> Marker | str | None:
    """Return the marker in a line, why it is none although it looks like one, or ``None``."""
    if "Manual edit " not in line:
        return None
    text = line.rstrip("\r\n")
    bare = text.strip().removeprefix("\ufeff")
    is_comment = len(bare) >= len("<!---->") and bare.startswith("<!--") and bare.endswith("-->")
    comment = bare[4:-3].strip().lstrip("-").strip() if is_comment else ""
    match = _DASHED.fullmatch(bare) or _XML.fullmatch(comment)
    if match is None:
        alone = "a marker must be alone on its line; move the other text away"
        return alone if _ALIKE.search(text) else None
    tail = (match["tail"] or "").strip()
    if not tail:
        return Marker(match["what"], number, text, None)
    found = _TAIL.fullmatch(tail)
    if found is None or (match["what"] == "end" and found["id"] != tail):
        form = "ID [of:8 HEX DIGITS] [for:8 HEX DIGITS] [was:ID,...]"
        return f"text behind 'region:' is not '{form}'; put the generated line back"
    of, uses, missing = (*(found["now"] or "").split("/", 2), "", "")[:3]
    look = Look(Digests(of, uses or None), _names(missing)) if of else None
    digests, was = Digests(found["of"], found["uses"]), _names(found["was"] or "")
    return Marker(match["what"], number, text, decode_id(found["id"]), digests, was, look)


def _names(text: str) -> tuple[str, ...]:
    return tuple(decode_id(name) for name in text.split(",") if name)

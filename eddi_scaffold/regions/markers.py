"""The marker lines of editable regions, and the digests in them.

``--`` is not allowed inside an XML comment, so the dashes of SESAME D7.2 Fig 15 give way to a bar
there. Read as well: no id (D7.2), three or more dashes, any quotes or none, any indentation.
"""

from __future__ import annotations

import hashlib
import re
import textwrap
from collections.abc import Iterable, Mapping
from typing import Literal, NamedTuple
from urllib.parse import quote, unquote

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
_FORMS: Mapping[Style, str] = {  # behind the id, for example: of:1a2b3c4d for:81fdda7e was:E,F
    "python": "'''-----Manual edit {}-----'''  # region: {}",
    "xml": "<!-- Manual edit {} | region: {} -->",
    "hash": "# -----Manual edit {}-----  # region: {}",
}
_HEX = "[0-9a-f]{8}"
_TAIL = re.compile(
    rf"(?P<id>\S+)(?:\s+of:(?P<of>{_HEX}))?(?:\s+for:(?P<uses>{_HEX}))?"
    rf"(?:\s+was:(?P<was>\S+))?(?:\s+now:(?P<now>{_HEX}/(?:{_HEX})?(?:/\S+)?))?"
)


class Digests(NamedTuple):
    """What a body stands for."""

    of: str | None = None  # digest of the generated body that it replaces, None when not known
    uses: str | None = None  # digest of what it may use, None where nothing is used


UNKNOWN = Digests()


class Look(NamedTuple):
    """Why a person must look at a body."""

    digests: Digests  # those of today's rendering
    missing: tuple[str, ...] = ()  # names that it uses and nothing generates any more


class Marker(NamedTuple):
    """One marker line."""

    what: str  # `begin` or `end`
    line: int  # counted from 1
    text: str  # without line end
    id: str | None  # decoded, None when not given
    digests: Digests = UNKNOWN
    was: tuple[str, ...] = ()  # former ids, the newest first
    now: Look | None = None


def encode_id(region_id: str) -> str:
    """Return the id, which may be any text, as it is written in a marker line or a file's name."""
    text = re.sub(r"[^\w.:-]", lambda c: quote(c[0], safe="", errors="surrogatepass"), region_id)
    return text.replace("--", "-%2D")  # which comments of XML forbid


def decode_id(text: str) -> str:
    """Return the id that :func:`encode_id` wrote; what it never wrote is an id as it stands."""
    try:
        return unquote(text, errors="surrogatepass")
    except UnicodeDecodeError:
        return text


def normal(body: str) -> str:
    """Return a body without what editors, formatters and git change: blanks, indentation, ends."""
    lines = [line.rstrip() for line in body.split("\n")]
    return textwrap.dedent("\n".join(lines)).strip("\n")


def digest(body: str) -> str:
    """Return the digest of a body's normal form, 8 hex digits."""
    return hashlib.sha256(normal(body).encode("utf-8", "surrogatepass")).hexdigest()[:8]


def text_digest(text: str) -> str:
    """Return the digest of a text in which blanks at line ends do not count, 16 hex digits."""
    plain = "\n".join(line.rstrip() for line in text.removeprefix("\ufeff").split("\n"))
    return hashlib.sha256(plain.encode("utf-8", "surrogatepass")).hexdigest()[:16]


def begin_marker(
    region_id: str,
    style: Style = "python",
    digests: Digests = UNKNOWN,
    was: Iterable[str] = (),
    now: Look | None = None,
) -> str:
    """Return the line that opens a region, without indentation and line end."""
    return _FORMS[style].format("begin", encode_id(region_id) + tail_of(digests, was, now))


def tail_of(digests: Digests, was: Iterable[str] = (), now: Look | None = None) -> str:
    """Return what a begin marker has behind its id."""
    parts = {"of": digests.of, "for": digests.uses, "was": ",".join(map(encode_id, was))}
    if now is not None:
        names = ",".join(map(encode_id, now.missing))
        parts["now"] = f"{now.digests.of}/{now.digests.uses or ''}{'/' if names else ''}{names}"
    return "".join(f" {key}:{value}" for key, value in parts.items() if value)


def end_marker(region_id: str, style: Style = "python") -> str:
    """Return the line that closes it."""
    return _FORMS[style].format("end", encode_id(region_id))


def with_tail(begin: str, region_id: str, tail: str) -> str:
    """Return a begin marker's line of any style with this id and what follows it."""
    plain = begin.rstrip()
    close = " -->" if plain.endswith("-->") else ""
    head, known, _ = plain.removesuffix("-->").partition("region:")
    if not known:
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
    marker = _DASHED.fullmatch(bare) or _XML.fullmatch(comment)
    if marker is None:
        alone = "a marker must be alone on its line; move the other text away"
        return alone if _ALIKE.search(text) else None
    what, behind = marker["what"], (marker["tail"] or "").strip()
    if not behind:
        return Marker(what, number, text, None)
    tail = _TAIL.fullmatch(behind)
    if tail is None or (what == "end" and tail["id"] != behind):
        form = "ID [of:8 HEX DIGITS] [for:8 HEX DIGITS] [was:ID,...]"
        return f"text behind 'region:' is not '{form}'; put the generated line back"
    of, uses, missing = (*(tail["now"] or "").split("/", 2), "", "")[:3]
    look = Look(Digests(of, uses or None), _names(missing)) if of else None
    digests = Digests(tail["of"], tail["uses"])
    return Marker(what, number, text, decode_id(tail["id"]), digests, _names(tail["was"]), look)


def _names(text: str | None) -> tuple[str, ...]:
    return tuple(decode_id(name) for name in (text or "").split(",") if name)

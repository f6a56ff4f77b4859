"""The marker lines of editable regions.

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
from collections.abc import Iterable
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
_WORDS = "Manual edit "
_SIG = re.compile(r"(?<!\s)\s+sig:\s*[0-9a-f]{8}(?=\s|$)")
_SIG_AT_END = re.compile(r"(?:^|(?<!\s)\s+)sig:\s*([0-9a-f]{8})$")
_WAS = "was:"


@dataclass(frozen=True)
class Marker:
    """One marker line.

    Attributes:
        what: ``begin`` or ``end``.
        line: line in the file, counted from 1.
        text: the line without its end.
        id: ``<kind>:<id>``, decoded, ``None`` when not given.
        was: former ids.
        sig: signature, ``None`` when not given.
    """

    what: str
    line: int
    text: str
    id: str | None
    was: tuple[str, ...]
    sig: str | None


def encode_id(region_id: str) -> str:
    """Return the id as it is written in a marker line.

    Ids come from models and may hold anything: blanks, quotes, commas, line ends. Letters and
    digits of any script stay readable; ``--`` is broken up because XML comments forbid it.
    """
    text = "".join(
        c if c.isalnum() or c in "_.:/-" else urllib.parse.quote(c, safe="", errors="surrogatepass")
        for c in region_id
    )
    return text.replace("--", "-%2D")


def decode_id(text: str) -> str:
    """Return the id that :func:`encode_id` wrote; what it never wrote is an id as it stands."""
    try:
        return urllib.parse.unquote(text, errors="surrogatepass")
    except UnicodeDecodeError:
        return text


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
    """Return a begin marker's line with another signature, or none."""
    bare = _SIG.sub("", begin, count=1)
    if sig is None:
        return bare
    plain = bare.rstrip()
    at = len(plain.removesuffix("-->").rstrip())
    return f"{bare[:at]} sig: {sig}{bare[at:]}"


def indent_of(line: str) -> str:
    """Return the blanks at the start of a line."""
    return line[: len(line) - len(line.lstrip(" \t"))]


def _written(what: str, style: Style, tail: str) -> str:
    if style == "xml":
        return f"<!-- Manual edit {what} | region: {tail} -->"
    if style == "hash":
        return f"# -----Manual edit {what}-----  # region: {tail}"
    return f"'''-----Manual edit {what}-----'''  # region: {tail}"


def read_marker(line: str, number: int) -> Marker | str | None:
    """Return the marker in a line, why it is none although it looks like one, or ``None``."""
    if _WORDS not in line:
        return None
    text = line.rstrip("\r\n")
    bare = text.strip()
    match = _DASHED.fullmatch(bare) or _XML.fullmatch(_commented(bare))
    if match is None:
        alone = "a marker must be alone on its line; move the other text away"
        return alone if _ALIKE.search(text) else None
    if not (match["tail"] or "").strip():
        return Marker(match["what"], number, text, None, (), None)
    tail = _read_tail(match["tail"].strip())
    if tail is None:
        form = "<kind>:<id> [was: <old>] [sig: <8 hex digits>]"
        return f"text behind 'region:' is not '{form}'; put the generated line back"
    region_id, was, sig = tail
    return Marker(match["what"], number, text, region_id, was, sig)


def _commented(text: str) -> str:
    """Return the text of an XML comment, without dashes before it; empty for no comment."""
    if len(text) < len("<!---->") or not (text.startswith("<!--") and text.endswith("-->")):
        return ""
    return text[4:-3].strip().lstrip("-").strip()


def _read_tail(text: str) -> tuple[str, tuple[str, ...], str | None] | None:
    """Return id, former ids and signature, ``None`` for another text."""
    region_id, *rest = text.split(None, 1)
    left = rest[0] if rest else ""
    sig = _SIG_AT_END.search(left)
    left = left[: sig.start()].rstrip() if sig else left
    was = left.removeprefix(_WAS).strip()
    former = [name.strip() for name in was.split(",") if name.strip()]
    is_list = left.startswith(_WAS) and was[:1] not in {"", ","}
    if left and (not is_list or any(name.split()[1:] for name in former)):
        return None
    ids = tuple(decode_id(name) for name in former)
    return decode_id(region_id), ids, sig[1] if sig else None

"""Characters that a word processor puts in place of those that YAML knows."""

from __future__ import annotations

import re
import unicodedata

_QUOTES = "\u201c\u201d\u201e\u201f\u00ab\u00bb\u2018\u2019\u201a\u201b\u2039\u203a"
_DASHES = "\u2010\u2011\u2012\u2013\u2014\u2212"
_SPACES = "\u00a0\u2002\u2003\u2007\u2009\u202f\u3000"
_NOTHING = "\u200b\u2060\ufeff"
_TYPED = {
    _QUOTES: 'type " or nothing',
    _DASHES: "type -",
    _SPACES: "type a space",
    _NOTHING: "delete",
}
_BLANK = f"[{_SPACES}{_NOTHING}]"
_MEANT_FOR_YAML = re.compile(
    rf"^ *(?P<indent>{_BLANK})|[-:,\[{{] *(?P<after>{_BLANK})|(?P<before>{_BLANK}) *:"
    rf"|^ *(?P<item>[{_DASHES}])[ {_SPACES}]|(?:^|[-:,\[{{]) *(?P<quote>[{_QUOTES}])"
)
_COMMENT = re.compile(r"(^|[ \t])#.*")


def advice(text: str) -> str | None:
    """Return what to type in place of the first such character of a text, ``None`` without one."""
    return next((found for char in text if (found := _advice(char)) is not None), None)


def misplaced(line: str) -> tuple[int, str] | None:
    """Return where a line has one in the place of a sign of YAML, from 0, and what to type."""
    match = _MEANT_FOR_YAML.search(_COMMENT.sub("", line))
    if match is None:
        return None
    at = match.start(match.lastgroup or 0)
    return at, _advice(line[at]) or ""


def _advice(char: str) -> str | None:
    typed = next((words for chars, words in _TYPED.items() if char in chars), None)
    if typed is None:
        return None
    name = unicodedata.name(char).lower()
    seen = "" if char in _SPACES + _NOTHING else f" {char}"
    place = "" if char in _NOTHING else " in place of"
    return f"{typed}{place}{seen} U+{ord(char):04X}, {name}"

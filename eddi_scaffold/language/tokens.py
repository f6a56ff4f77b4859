"""Texts of events as tokens."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Literal, NamedTuple

from eddi_scaffold.language.findings import TextFindings

TokenKind = Literal["word", "number", "text", "symbol", "end"]
_KINDS: Mapping[str, TokenKind] = {
    "word": "word",
    "number": "number",
    "text": "text",
    "symbol": "symbol",
}
"""Group of the pattern below -> kind of the token."""
RESERVED = frozenset(
    {
        *("AND", "OR", "XOR", "NOT", "IMPLIES", "TRUE", "FALSE", "UNKNOWN"),
        *("ENUM", "VAR", "CONST", "EVENT", "COVERAGE"),
    }
)
"""Words that are not names, in any case of letters."""

_TOKEN = re.compile(
    r"""(?P<blank>[ \t\r\n\f]+|//[^\n]*)
      | (?P<number>[0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?)
      | (?P<word>[A-Za-z_][A-Za-z0-9_]*)
      | (?P<text>"[^"\r\n]+")
      | (?P<symbol>(?!<->|->|=>)(?::=|==|!=|<=|>=|\.\.|[-+*/<>(),;:.\[\]{}=]))
      | (?P<other>&&|\|\||<->|->|=>|.)""",
    re.VERBOSE | re.DOTALL,
)
_INSTEAD = {
    "&": "AND",
    "&&": "AND",
    "|": "OR",
    "||": "OR",
    "!": "NOT",
    "->": "IMPLIES",
    "=>": "IMPLIES, or >= to compare",
    "<->": "==",
    "^": "x * x, or a unit in one word such as mps2",
    "\N{LESS-THAN OR EQUAL TO}": "<=",
    "\N{GREATER-THAN OR EQUAL TO}": ">=",
    "#": "// for a comment",
    "\N{NO-BREAK SPACE}": "a plain blank",
    "%": "the unit pct",
    "\N{DEGREE SIGN}": "the unit, deg or degC",
}


class Token(NamedTuple):
    """One token.

    Attributes:
        kind: ``end`` follows the last token.
        text: as written; empty at the end.
        start: offset of its first character.
        end: offset behind its last one.
    """

    kind: TokenKind
    text: str
    start: int
    end: int

    @property
    def word(self) -> str:
        """The text in upper case when this is a word, else empty."""
        return self.text.upper() if self.kind == "word" else ""

    @property
    def shown(self) -> str:
        """The token in a message."""
        if self.kind == "end":
            return "the end of the text"
        return repr(self.text if len(self.text) <= 40 else f"{self.text[:37]}...")


def comments_of(text: str) -> list[tuple[int, int]]:
    """Return the first and the last offset of each comment."""
    blanks = (match for match in _TOKEN.finditer(text) if match.lastgroup == "blank")
    return [match.span() for match in blanks if match.group().startswith("//")]


def tokens_of(text: str, findings: TextFindings) -> tuple[Token, ...]:
    """Return the tokens of a text; characters outside the language are E001 and left out."""
    found: list[Token] = []
    for match in _TOKEN.finditer(text):
        kind = _KINDS.get(match.lastgroup or "")
        if kind is not None:
            found.append(Token(kind, match.group(), match.start(), match.end()))
        elif match.lastgroup == "other":
            char = match.group()
            instead = _INSTEAD.get(char)
            findings.error(
                "E001",
                match.start(),
                f"unexpected {'characters' if len(char) > 1 else 'character'} {char!r}",
                f"write {instead}" if instead else None,
            )
    last = found[-1].end if found else 0
    return (*found, Token("end", "", last, last))

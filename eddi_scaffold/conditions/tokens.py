"""Texts of events as tokens, and reading them one after the other."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from fractions import Fraction
from typing import Literal, NamedTuple, NoReturn

from eddi_scaffold.common.identifiers import key_text
from eddi_scaffold.common.problems import did_you_mean
from eddi_scaffold.common.units import one_word, words
from eddi_scaffold.conditions.findings import TextFindings
from eddi_scaffold.conditions.syntax import Identifier, NumberWithUnit

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
            findings.add(
                "E001.character",
                match.start(),
                hint=f"write {instead}" if instead else None,
                kind="characters" if len(char) > 1 else "character",
                character=char,
            )
    last = found[-1].end if found else 0
    return (*found, Token("end", "", last, last))


DURATIONS: dict[str, int] = {
    "ns": 1,
    "us": 10**3,
    "ms": 10**6,
    "s": 10**9,
    "min": 60 * 10**9,
    "h": 3600 * 10**9,
}
"""Unit of a duration -> nanoseconds."""


def nanoseconds(number: str, unit: str) -> int:
    """Return a duration in nanoseconds, rounded to nearest; the number's text is exact.

    Raises:
        OverflowError: the duration does not fit into 62 bits.
    """
    if not 0 <= float(number) < 2.0**62 or float(number) * DURATIONS[unit] >= 2.0**62:
        raise OverflowError
    if float(number) < 1e-12:  # the exact fraction of 1e-999999 would fill the memory
        return 0
    return round(Fraction(number) * DURATIONS[unit])


DECLARATIONS = ("ENUM", "VAR", "CONST", "EVENT")
_PATH_INDEX = 10**6


class Wrong(Exception):  # noqa: N818 - it ends one declaration, a Finding reports what is wrong
    """The rest of a declaration cannot be read."""


class Cursor:
    """A place among the tokens of a text."""

    def __init__(self, tokens: tuple[Token, ...], findings: TextFindings) -> None:
        self._tokens = tokens
        self._findings = findings
        self._k = 0
        self._declared = ""

    @property
    def _token(self) -> Token:
        return self._tokens[self._k]

    def _peek(self, ahead: int = 1) -> Token:
        return self._tokens[min(self._k + ahead, len(self._tokens) - 1)]

    def _is_symbol(self, text: str) -> bool:
        return self._token.kind == "symbol" and self._token.text == text

    def _expect(self, symbol: str, shown: str | None = None) -> None:
        if not self._is_symbol(symbol):
            wanted = shown or repr(symbol)
            hint = self._comparison_hint() if symbol in {")", ","} else None
            self._fail("E001.word", hint=hint, expected=wanted, shown=self._token.shown)
        self._k += 1

    def _comparison_hint(self) -> str | None:
        return "`==` compares two values" if self._is_symbol("=") else None

    def _new_name(self, what: str) -> Identifier:
        token = self._token
        if token.kind != "word":
            self._fail("E001.list_option", list_options=what, shown=token.shown)
        if token.word in RESERVED:
            self._fail("E001.reserved", shown=token.shown)
        self._k += 1
        self._declared = self._declared or token.text
        return Identifier(token.text, token.start)

    def _number(self) -> float:
        """Take a number that a double can hold."""
        token = self._token
        value = float(token.text)
        digits = token.text.lower().partition("e")[0]
        if not math.isfinite(value) or (value == 0 and digits.strip("0.") != ""):
            self._fail("E013.number", token.start)
        self._k += 1
        return value

    def _signed(self) -> NumberWithUnit:
        at, negative = self._token.start, self._is_symbol("-")
        self._k += negative
        if self._token.kind != "number":
            self._fail("E001.number", shown=self._token.shown)
        value = self._number()
        return NumberWithUnit(-value if negative else value, self._unit(), at)

    def _unit(self) -> str | None:
        """Take the unit behind a number, if there is one."""
        token, number = self._token, self._tokens[self._k - 1]
        self._refuse_compound_unit()
        if token.kind != "word":
            return None
        if token.text in words():
            self._k += 1
            return token.text
        if token.start == number.end:  # 5x: it cannot be anything else
            hint = did_you_mean(token.text, words()) or f"units: {', '.join(sorted(words()))}"
            self._fail("E009.unknown_quoted", hint=hint, shown=token.shown)
        return None

    def _refuse_compound_unit(self, ahead: int = 0) -> None:
        """Refuse a unit such as m/s or 1/h, which would be a division: units are one word here."""
        first = self._k + ahead
        spelling = "".join(token.text for token in self._tokens[first : first + 3])
        unit = one_word(spelling)
        if unit is not None:
            at = self._tokens[first].start
            self._fail(
                "E009.spelling",
                at,
                spelling=spelling,
                words=self._tokens[first - 1].text,
                unit=unit,
            )

    def _duration(self) -> int:
        number, unit = self._token, self._peek()
        if number.kind != "number" or unit.kind != "word" or unit.text not in DURATIONS:
            hint = f"the unit is one of {', '.join(DURATIONS)}"
            self._fail("E005.duration", hint=hint, shown=number.shown)
        if unit.start != number.end:
            self._fail("E005.apart", number=number.text, unit=unit.text)
        try:
            length = nanoseconds(number.text, unit.text)
        except OverflowError:
            self._fail("E013.duration")
        if length == 0:
            self._fail("E005.no_time")
        self._k += 2
        return length

    def _fail(
        self, case: str, at: int | None = None, /, *, hint: str | None = None, **fields: object
    ) -> NoReturn:
        self._findings.add(case, self._token.start if at is None else at, hint=hint, **fields)
        raise Wrong

    def _path_rest(self, name: str) -> str:
        while True:
            if self._is_symbol(".") and self._peek().kind == "word":
                name += f".{self._peek().text}"
                self._k += 2
            elif self._is_symbol("["):
                self._k += 1
                name += f"[{self._element()}]"
                self._expect("]")
            else:
                return name

    def _element(self) -> str:
        """Take the content of brackets: an index, a key, or a field and its key."""
        field = ""
        while self._token.kind == "word" and self._peek().text in ("=", "."):
            field += self._token.text + self._peek().text
            self._k += 2
        if field.endswith("."):
            self._fail("E001.key", shown=self._token.shown)
        token = self._token
        if token.kind in ("word", "text"):
            key = key_text(token.text.strip('"'))
        elif self._is_symbol("*") and not field:
            key = "*"
        elif token.text.isdigit() and len(token.text) < 8 and int(token.text) < _PATH_INDEX:
            key = str(int(token.text)) + self._last_of_part()
        else:
            self._fail("E001.index_or_key", shown=token.shown)
        self._k += 1
        return field + key

    def _last_of_part(self) -> str:
        """Take the end of a part of a list, ``..5``, if there is one."""
        if not (self._peek().text == ".." and self._peek(2).text.isdigit()):
            return ""
        first, last = self._token, self._peek(2)
        if len(last.text) > 7 or int(last.text) < int(first.text) or int(last.text) >= _PATH_INDEX:
            self._fail("E001.index", first=first.text, shown=last.shown)
        self._k += 2
        return f"..{int(last.text)}"

    def _declaration(self) -> str:
        """Return the word that opens a declaration here, empty when there is none."""
        word = self._token.word
        opens = word in DECLARATIONS and self._peek().kind == "word"
        return word if opens or (word in DECLARATIONS and self._peek().kind == "end") else ""

"""Texts of events as tokens, what is wrong in a text, and reading tokens one after the other."""

from __future__ import annotations

import math
import re
from bisect import bisect_right
from collections.abc import Callable
from itertools import accumulate
from typing import Any, NamedTuple, NoReturn

from eddi_scaffold.common.identifiers import key_text
from eddi_scaffold.common.problems import Place, Problem, did_you_mean, problem
from eddi_scaffold.common.units import one_word, words
from eddi_scaffold.conditions.syntax import Identifier, NumberWithUnit

Locate = Callable[[int], Place]
"""Offset in the text (0 to its length) -> place in the file that holds it."""
EXPRESSION = "<expression>"  # name of a text that came from no file
_MAX_FINDINGS = 100
DECLARATIONS = ("ENUM", "VAR", "CONST", "EVENT")
RESERVED = frozenset(
    {"AND", "OR", "XOR", "NOT", "IMPLIES", "TRUE", "FALSE", "UNKNOWN", "COVERAGE", *DECLARATIONS}
)
"""Words that are not names, in any case of letters."""
_TOKEN = re.compile(
    r"""(?P<blank>[ \t\r\n\f]+|//[^\n]*)
      | (?P<number>[0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?)
      | (?P<word>[A-Za-z_]\w*(?:\.[A-Za-z_]\w*|\[(?:"[^"\r\n]*"|[^"\]\r\n])*\])*)
      | (?P<text>"[^"\r\n]+")
      | (?P<symbol>:=|==|!=|<=|>=|\.\.|[-+*/%<>(),;:.\[\]{}=])
      | (?P<other>&&|\|\||.)""",
    re.VERBOSE | re.DOTALL | re.ASCII,
)
_BRACKETS = re.compile(r'\[((?:"[^"]*"|[^"\]])*)\]')
_ELEMENT = re.compile(
    r"""\s*(?:\*|(?P<field>(?:(?:[A-Za-z_]\w*\.)*[A-Za-z_]\w*\s*=\s*)?)
        (?:(?P<key>[A-Za-z_]\w*|"[^"]+")|(?P<first>\d{1,6})(?:\s*\.\.\s*(?P<last>\d{1,6}))?))\s*""",
    re.VERBOSE | re.ASCII,
)
"""What may stand in brackets: all elements, one by a key or an index, a part of them."""
DURATIONS = {"ns": 1, "us": 10**3, "ms": 10**6, "s": 10**9, "min": 60 * 10**9, "h": 3600 * 10**9}
"""Unit of a duration -> nanoseconds."""


class Refused(Exception):  # noqa: N818 - it ends one part of a text, a problem says why
    """What is being read or checked has no meaning."""


class TextFindings:
    """Collects what is wrong with a text."""

    def __init__(self, locate: Locate) -> None:
        self.problems: list[Problem] = []
        self._locate = locate

    def add(self, case: str, offset: int, /, *, hint: str | None = None, **fields: object) -> None:
        """Add the problem of a case at an offset."""
        if len(self.problems) < _MAX_FINDINGS:
            self.problems.append(problem(case, self._locate(offset), hint=hint, **fields))

    def refuse(self, case: str, offset: int, /, **fields: Any) -> NoReturn:
        """Add a problem which is the end of a part."""
        self.add(case, offset, **fields)
        raise Refused


def line_and_column(text: str) -> Callable[[int], tuple[int, int]]:
    """Return the function offset -> line and column, both from 1."""
    starts = [0, *accumulate(len(line) + 1 for line in text.split("\n"))]

    def of(offset: int) -> tuple[int, int]:
        line = bisect_right(starts, offset)
        return line, offset - starts[line - 1] + 1

    return of


def in_text(text: str, name: str = EXPRESSION) -> Locate:
    """Return the places of a text that is a complete file."""
    of = line_and_column(text)
    return lambda offset: Place(name, *of(offset))


class Token(NamedTuple):
    """One token."""

    kind: str  # `word`, `number`, `text`, `symbol`; `end` follows the last token
    text: str  # as written; empty at the end
    start: int  # offset of its first character
    end: int  # offset behind its last one

    @property
    def keyword(self) -> str:
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
    """Return the tokens of a text; characters outside the language are E001 and omitted."""
    tokens: list[Token] = []
    for match in _TOKEN.finditer(text):
        kind, char = match.lastgroup or "", match.group()
        if kind == "other":
            findings.add("E001.character", match.start(), shown=repr(char))
        elif kind != "blank":
            tokens.append(Token(kind, char, *match.span()))
    end = tokens[-1].end if tokens else 0
    return (*tokens, Token("end", "", end, end))


class Cursor:
    """A place among the tokens of a text."""

    def __init__(self, tokens: tuple[Token, ...], findings: TextFindings) -> None:
        self._tokens = tokens
        self._findings = findings
        self._index = 0

    @property
    def _token(self) -> Token:
        return self._tokens[self._index]

    def _peek(self, ahead: int = 1) -> Token:
        return self._tokens[min(self._index + ahead, len(self._tokens) - 1)]

    def _is_symbol(self, text: str) -> bool:
        return self._token.kind == "symbol" and self._token.text == text

    def _took(self, symbol: str) -> bool:
        is_here = self._is_symbol(symbol)
        self._index += is_here
        return is_here

    def _take(self) -> Token:
        self._index += 1
        return self._tokens[self._index - 1]

    def _expect(self, symbol: str, shown: str | None = None) -> None:
        if not self._took(symbol):
            self._missing(shown or repr(symbol))

    def _fail(self, case: str, at: int | None = None, /, **fields: Any) -> NoReturn:
        self._findings.refuse(case, self._token.start if at is None else at, **fields)

    def _missing(self, expected: str) -> NoReturn:
        self._fail("E001.word", expected=expected, shown=self._token.shown)

    def _declaration(self) -> str:
        """Return the word that opens a declaration here, empty when there is none."""
        opens = self._token.keyword in DECLARATIONS and self._peek().kind in ("word", "end")
        return self._token.keyword if opens else ""

    def _new_name(self, what: str, *, is_path: bool = False) -> Identifier:
        token = self._token
        if token.kind != "word" or not (is_path or token.text.isidentifier()):
            self._missing(what)
        if token.keyword in RESERVED:
            self._fail("E001.reserved", shown=token.shown)
        return Identifier(self._path(self._take()), token.start)

    def _number(self) -> float:
        """Take a number that a double can hold."""
        if self._token.kind != "number":
            self._missing("a number")
        value = float(self._token.text)
        if not math.isfinite(value):
            self._fail("E013.number")
        self._index += 1
        return value

    def _signed(self) -> NumberWithUnit:
        at, sign = self._token.start, -1 if self._took("-") else 1
        return NumberWithUnit(sign * self._number(), self._unit(), at)

    def _unit(self) -> str | None:
        token, number = self._token, self._tokens[self._index - 1]
        self._refuse_compound_unit()
        if token.kind == "word" and token.text in words():
            return self._take().text
        if self._took("%"):
            return "pct"
        if token.kind == "word" and token.start == number.end:  # 5x: it cannot be anything else
            self._fail("E009.unknown", hint=unit_hint(token.text), unit=token.text[:40])
        return None

    def _refuse_compound_unit(self, ahead: int = 0) -> None:
        """Refuse a unit such as m/s or 1/h, which would be a division: units are one word here."""
        first = self._index + ahead
        spelling = "".join(token.text for token in self._tokens[first : first + 3])
        unit, before = one_word(spelling), self._tokens[first - 1].text
        if unit is not None:
            at = self._tokens[first].start
            self._fail("E009.spelling", at, spelling=spelling, words=before, unit=unit)

    def _duration(self) -> int:
        """Take a duration; return nanoseconds, rounded to nearest."""
        number, unit = self._token, self._peek()
        if number.kind != "number" or unit.text not in DURATIONS:
            self._fail("E005.duration", shown=number.shown)
        value, scale = float(number.text), DURATIONS[unit.text]
        if not value * scale < 2.0**62:
            self._fail("E013.duration")
        length = round(value * scale)
        if length == 0:
            self._fail("E005.no_time")
        self._index += 2
        return length

    def _path(self, token: Token) -> str:
        """Return a path in its canonical form."""

        def element(part: re.Match[str]) -> str:
            of = _ELEMENT.fullmatch(part[1])
            if of is None or int(of["last"] or 10**6) < int(of["first"] or 0):
                self._fail("E001.index_or_key", token.start + part.start(1), shown=repr(part[1]))
            if of["key"] is None and of["first"] is None:
                return "[*]"
            key = str(int(of["first"])) if of["first"] else key_text(of["key"].strip('"'))
            last = f"..{int(of['last'])}" if of["last"] else ""
            return f"[{''.join(of['field'].split())}{key}{last}]"

        return _BRACKETS.sub(element, token.text)


def unit_hint(unit: str) -> str:
    """Return the unit that is nearest to a text, or all."""
    return did_you_mean(unit, words()) or f"units: {', '.join(sorted(words()))}"

"""Texts of the short form of ConSerts: ``PathIsFree AND (Lidar OR Radar)``, ``20 .. 100 %``.

They hold no more than that, so a mistake is told at its character, with what to write.
"""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Iterator
from typing import Any, NamedTuple

from eddi_scaffold.yaml_text import nodes as y

RESERVED = frozenset({"always", "and", "bool", "not", "or"})  # in any case
_DEEPEST = 50
_TOKEN = re.compile(r'\s*(?:(?P<id>\w[\w.-]*)|"(?P<quoted>[^"]*)"|(?P<symbol>\S))')
_NUMBER = r"[-+]?(?:[0-9]+(?:\.[0-9]+)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
_RANGE = re.compile(
    rf"\s*(?:(?P<start>{_NUMBER})\s*(?P<dots>\.\.<?)\s*(?P<end>{_NUMBER})"
    rf"|(?P<word>at least|at most|below)\s+(?P<bound>{_NUMBER}))"
    r"\s*(?P<unit>\S.*?)??(?:\s+or\b|\s*$)"
)


class Refused(Exception):  # noqa: N818 - control flow of the reader
    """A text has no meaning from an offset on; the case and fields of the problem."""

    def __init__(self, case: str, offset: int, hint: str | None = None, **fields: Any) -> None:
        super().__init__(case)
        self.case, self.offset, self.hint, self.fields = case, offset, hint, fields


class Term(NamedTuple):
    """An id in an expression."""

    id: str
    offset: int


class Row(NamedTuple):
    """Terms and rows of the other word that ``AND`` or ``OR`` joins."""

    word: str
    terms: list[Term | Row]


class _Token(NamedTuple):
    text: str  # an id, `(`, `)`, or empty at the end
    start: int
    word: str  # in upper case; empty for what is quoted or a symbol


def parse_expression(text: str) -> Row:
    """Read an expression; of one id it is a row of that id.

    Raises:
        Refused: it is none.
    """
    tokens = deque([*_tokens(text), _Token("", len(text.rstrip()), "")])
    row = _row(tokens, 0)
    _expect(tokens[0], "")
    return row


def _tokens(text: str) -> Iterator[_Token]:
    for match in _TOKEN.finditer(text):
        start = match.start(match.lastgroup or 0)
        symbol, id_ = match["symbol"] or "", match["id"] or ""
        if symbol not in {"", "(", ")"}:
            raise Refused("C002.symbol", start, symbol=repr(symbol))
        if id_.upper() == "NOT":
            raise Refused("C002.negation", start)
        yield _Token(id_ or symbol or match["quoted"] or "", start, id_.upper())


def _row(tokens: deque[_Token], depth: int) -> Row:
    if depth > _DEEPEST:
        raise Refused("C002.nested", tokens[0].start, limit=_DEEPEST)
    word, terms = "", [_term(tokens, depth)]
    while tokens[0].word in {"AND", "OR"}:
        joint = tokens.popleft()
        if word and word != joint.word:
            raise Refused("C002.mixed", joint.start)
        word = joint.word
        terms.append(_term(tokens, depth))
    return _joined(word or "AND", terms)


def _term(tokens: deque[_Token], depth: int) -> Term | Row:
    token = tokens.popleft()
    if token.text in {"", ")"} or token.word in {"AND", "OR"}:
        raise Refused("C002.term", token.start)
    if token.text != "(":
        return Term(token.text, token.start)
    row = _row(tokens, depth + 1)
    _expect(tokens.popleft(), ")")
    return row


def _expect(token: _Token, text: str) -> None:
    """Refuse a token other than a text, empty for the end."""
    if token.text != text:
        case = "C002.no_word" if token.text else "C002.closing"
        raise Refused(case, token.start, word=y.shown(token.text))


def _joined(word: str, terms: list[Term | Row]) -> Row:
    """Join terms; the same word in parentheses, or parentheses around one id, are no row."""
    joined: dict[str | int, Term | Row] = {}
    for term in terms:
        inner = [term]
        if isinstance(term, Row) and (term.word == word or len(term.terms) == 1):
            inner = term.terms
        joined |= {part.id if isinstance(part, Term) else id(part): part for part in inner}
    only = next(iter(joined.values()))
    return only if len(joined) == 1 and isinstance(only, Row) else Row(word, [*joined.values()])


class ShortRange(NamedTuple):
    """A range: its name and ends as in the full form, and where it begins in the text."""

    name: str
    start: str
    end: str
    offset: int


def parse_ranges(text: str) -> tuple[list[ShortRange], str]:
    """Read ranges joined by ``or``, and their unit; empty is a ratio.

    Raises:
        Refused: it is no range, or has two units.
    """
    ranges: list[ShortRange] = []
    units: list[tuple[str, int]] = []
    at = 0
    while at < len(text) or not ranges:
        match = _RANGE.match(text, at)
        if match is None:
            raise Refused("C002.range", at, text=y.shown(text))
        start, end, bound = match["start"] or "-.inf", match["end"] or ".inf", match["bound"]
        start, end = (bound, end) if match["word"] == "at least" else (start, bound or end)
        name = "Exclusive" if match["dots"] == "..<" or match["word"] == "below" else "Inclusive"
        offset = at + len(match[0]) - len(match[0].lstrip())
        ranges.append(ShortRange(name, start, end, offset))
        units.append((match["unit"] or "", match.start("unit")))
        at = match.end()
    unit, last = units[-1]
    for other, offset in units:
        if other not in {"", unit}:
            at = last if unit else offset
            raise Refused("C002.units", at, first=y.shown(other), second=y.shown(unit))
    return ranges, "percent" if unit == "%" else unit

"""Texts of events: declarations, and expressions behind them."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace

from eddi_scaffold.common.problems import did_you_mean
from eddi_scaffold.conditions.expressions import ExpressionParser
from eddi_scaffold.conditions.findings import TextFindings
from eddi_scaffold.conditions.syntax import (
    ConstDeclaration,
    EnumDeclaration,
    EventDeclaration,
    File,
    Identifier,
    VarDeclaration,
)
from eddi_scaffold.conditions.tokens import RESERVED, Token, Wrong, tokens_of

MAX_TEXT = 64 * 1024
_DECLARATIONS = ("ENUM", "VAR", "CONST", "EVENT")
_WANTED = {
    "UNIT": "a unit",
    "RATE": "a rate such as 10 Hz",
    "TIMEOUT": "a duration such as 500ms",
    "RANGE": "a range such as 0 .. 5",
    "ALLOW": "INF",
}
"""Option of a VAR -> what comes behind it."""
ANONYMOUS = "event"
"""Name of the event that a bare expression is."""


def parse(text: str, findings: TextFindings) -> File:
    """Parse a text: declarations, an expression, or declarations and an expression behind them.

    What is wrong goes to ``findings`` (E001 to E006, E013, W001); the declarations that
    could be read are returned.
    """
    if len(text.encode("utf-8", "surrogatepass")) > MAX_TEXT:
        findings.add("E013.text", 0, limit=MAX_TEXT)
        return File()
    tokens = tokens_of(text, findings)
    if findings.problems:
        return File()
    return _Parser(tokens, findings).file()


class _Parser(ExpressionParser):
    def __init__(self, tokens: tuple[Token, ...], findings: TextFindings) -> None:
        super().__init__(tokens, findings)
        self._behind_declaration = False

    def file(self) -> File:
        enums: list[EnumDeclaration] = []
        variables: list[VarDeclaration] = []
        constants: list[ConstDeclaration] = []
        events: list[EventDeclaration] = []
        broken: set[str] = set()
        readers: dict[str, Callable[[], None]] = {
            "ENUM": lambda: enums.append(self._enum()),
            "VAR": lambda: variables.append(self._variable()),
            "CONST": lambda: constants.append(self._constant()),
            "EVENT": lambda: events.append(self._event()),
        }
        bare = lambda: events.append(self._bare())  # noqa: E731 - one of five readers
        while True:
            while self._is_symbol(";"):
                self._k += 1
            if self._token.kind == "end" and (enums or variables or constants or events):
                break
            if self._token.kind == "end" and self._findings.problems:
                break
            before = self._k
            self._declared = ""
            try:
                readers.get(self._declaration(), bare)()
                if not self._at_declaration():
                    hint = self._comparison_hint() or self._misspelt(before, readers)
                    hint = self._temporal_hint(self._k) or self._temporal_hint(self._k - 1) or hint
                    self._fail("E001.rest", hint=hint, shown=self._token.shown)
            except Wrong:
                broken.add(self._declared)
                self._skip(before)
        return File(
            tuple(self._nodes),
            tuple(enums),
            tuple(variables),
            tuple(constants),
            tuple(events),
            frozenset(broken),
        )

    def _misspelt(self, first: int, keywords: Collection[str]) -> str | None:
        """Return the hint at the keyword that a text of one word may be meant to be."""
        word = self._tokens[first]
        if self._k != first + 1 or word.kind != "word" or self._token.kind != "word":
            return None
        hint = did_you_mean(word.word, keywords)
        if hint is not None:
            self._declared = word.text  # it is no variable that is missing
        return hint

    def _at_declaration(self) -> bool:
        """Return whether a declaration, or a bare expression after them, may begin here."""
        return (
            self._token.kind == "end"
            or self._is_symbol(";")
            or bool(self._declaration())
            or self._behind_declaration
        )

    def _skip(self, before: int) -> None:
        """Go to the next declaration behind a wrong one."""
        self._k = max(self._k, before + 1) if self._token.kind != "end" else self._k
        while not (self._token.kind == "end" or self._is_symbol(";") or self._declaration()):
            self._k += 1

    def _enum(self) -> EnumDeclaration:
        self._k += 1
        name = self._new_name("the name of the ENUM")
        self._expect("{")
        literals = [self._new_name("a literal of the ENUM")]
        while self._is_symbol(","):
            self._k += 1
            literals.append(self._new_name("a literal of the ENUM"))
        self._expect("}")
        self._behind_declaration = True
        return EnumDeclaration(name.name, name.at, tuple(literals))

    def _variable(self) -> VarDeclaration:
        self._k += 1
        at = self._token.start
        self._new_name("the name of a variable")
        name = self._path_rest(self._tokens[self._k - 1].text)
        self._expect(":")
        found = VarDeclaration(name, at, self._new_name("NUMBER, BOOL or the name of an ENUM"))
        while True:
            option = self._option(found)
            if option is None:
                self._refuse_option()
                self._behind_declaration = True
                return found
            found = option

    def _option(self, found: VarDeclaration) -> VarDeclaration | None:
        word, after = self._token.word, self._peek()
        if word == "UNIT":
            self._refuse_compound_unit(1)
        if word == "UNIT" and after.kind == "word" and after.word not in _DECLARATIONS:
            self._k += 2
            return replace(found, unit=Identifier(after.text, after.start))
        if word == "RATE" and after.kind == "number":
            self._k += 1
            rate = self._number()
            if self._token.text != "Hz" or not 0 < rate <= 1e9:
                self._fail("E001.rate", after.start)
            self._k += 1
            return replace(found, rate=rate)
        if word == "TIMEOUT" and after.kind == "number":
            self._k += 1
            return replace(found, timeout=self._duration())
        if word == "RANGE" and (after.kind == "number" or after.text == "-"):
            self._k += 1
            low = self._signed()
            self._expect("..")
            return replace(found, range=(low, self._signed()))
        if word == "ALLOW" and after.word == "INF":
            self._k += 2
            return replace(found, infinite=True)
        return None

    def _refuse_option(self) -> None:
        """Refuse a word that can only be meant as an option: no expression goes on like that."""
        word, after = self._token, self._peek()
        goes_on = after.kind == "number" or (after.kind == "word" and after.word not in RESERVED)
        wanted = _WANTED.get(word.word)
        if wanted is not None and (goes_on or after.word in _DECLARATIONS):
            self._fail(
                "E001.behind", after.start, expected=wanted, word=word.word, shown=after.shown
            )
        hint = did_you_mean(word.word, _WANTED) if word.kind == "word" and goes_on else None
        if hint is not None and word.word not in RESERVED:
            self._fail("E001.variable_option", hint=hint, shown=word.shown)

    def _constant(self) -> ConstDeclaration:
        self._k += 1
        name = self._new_name("the name of a constant")
        self._expect("=")
        value = self._signed()
        self._behind_declaration = True
        return ConstDeclaration(name.name, name.at, value)

    def _event(self) -> EventDeclaration:
        self._k += 1
        name = self._new_name("the name of the event")
        polarity = None
        if self._is_symbol("("):
            self._k += 1
            polarity = self._token.word
            if polarity not in ("EVIDENCE", "HAZARD"):
                self._fail("E001.polarity", shown=self._token.shown)
            self._k += 1
            self._expect(")")
        self._expect(":=")
        first = len(self._nodes)
        root = self._read_definition()
        return EventDeclaration(name.name, name.at, polarity, first, root)

    def _bare(self) -> EventDeclaration:
        first, at = len(self._nodes), self._token.start
        return EventDeclaration(ANONYMOUS, at, None, first, self._read_definition(), anonymous=True)

    def _read_definition(self) -> int:
        self._behind_declaration = False
        self._depth = 0
        return self._expression()

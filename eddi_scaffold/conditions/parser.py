"""Texts of events: declarations, and expressions behind them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from eddi_scaffold.common.problems import did_you_mean
from eddi_scaffold.conditions.expressions import ExpressionParser
from eddi_scaffold.conditions.syntax import (
    ConstDeclaration,
    EnumDeclaration,
    EventDeclaration,
    File,
    Identifier,
    VarDeclaration,
)
from eddi_scaffold.conditions.tokens import (
    DECLARATIONS,
    Refused,
    TextFindings,
    Token,
    tokens_of,
)

MAX_TEXT = 64 * 1024
_OPTIONS = ("UNIT", "RATE", "TIMEOUT", "RANGE", "ALLOW")
ANONYMOUS = "event"  # name of the event that a bare expression is


def parse(text: str, findings: TextFindings) -> File:
    """Parse declarations, an expression, or declarations and an expression behind them.

    What is wrong goes to ``findings`` (E001, E005, E006, E009, E013, W001); the declarations that
    could be read are returned.
    """
    if len(text.encode("utf-8", "surrogatepass")) > MAX_TEXT:
        findings.add("E013.text", 0, limit=MAX_TEXT)
        return File()
    tokens = tokens_of(text, findings)
    return File() if findings.problems else _Parser(tokens, findings).file()


class _Parser(ExpressionParser):
    def __init__(self, tokens: tuple[Token, ...], findings: TextFindings) -> None:
        super().__init__(tokens, findings)
        self._is_behind_declaration = False

    def file(self) -> File:
        readers = {
            "ENUM": self._enum,
            "VAR": self._variable,
            "CONST": self._constant,
            "EVENT": self._event,
        }
        declarations: list[Identifier] = []
        broken: set[str] = set()
        while True:
            while self._took(";"):
                pass
            if self._token.kind == "end" and (declarations or self._findings.problems):
                break
            first = self._index
            self._declared = ""
            try:
                declarations.append(readers.get(self._declaration(), self._bare)())
                self._expect_end(first, readers)
            except Refused:
                broken.add(self._declared)
                self._index += self._index == first and self._token.kind != "end"
                while not (self._token.kind == "end" or self._is_symbol(";")):
                    if self._declaration():
                        break
                    self._index += 1
        return File(
            tuple(self._nodes),
            tuple(entry for entry in declarations if isinstance(entry, EnumDeclaration)),
            tuple(entry for entry in declarations if isinstance(entry, VarDeclaration)),
            tuple(entry for entry in declarations if isinstance(entry, ConstDeclaration)),
            tuple(entry for entry in declarations if isinstance(entry, EventDeclaration)),
            frozenset(broken),
        )

    def _expect_end(self, first: int, keywords: Collection[str]) -> None:
        """Check that a declaration, or a bare expression after them, may begin here."""
        is_end = self._token.kind == "end" or self._is_symbol(";")
        if is_end or self._declaration() or self._is_behind_declaration:
            return
        hint, before = self._comparison_hint(), self._tokens[self._index - 1]
        if self._index == first + 1 and before.kind == "word":
            keyword = did_you_mean(before.keyword, [*keywords, *_OPTIONS])
            if keyword is not None:
                hint, self._declared = keyword, before.text  # it is no variable that is missing
        self._fail("E001.rest", hint=hint, shown=self._token.shown)

    def _enum(self) -> EnumDeclaration:
        self._index += 1
        name = self._new_name("the name of the ENUM")
        self._expect("{")
        literals = [self._new_name("a literal of the ENUM")]
        while self._took(","):
            literals.append(self._new_name("a literal of the ENUM"))
        self._expect("}")
        self._is_behind_declaration = True
        return EnumDeclaration(name.name, name.at, tuple(literals))

    def _variable(self) -> VarDeclaration:
        self._index += 1
        name = self._new_name("the name of a variable")
        path = self._path_rest(name.name)
        self._expect(":")
        type_ = self._new_name("NUMBER, BOOL or the name of an ENUM")
        variable: VarDeclaration | None = VarDeclaration(path, name.at, type_)
        while variable is not None:
            declared = variable
            variable = self._option(declared)
        self._is_behind_declaration = True
        return declared

    def _option(self, variable: VarDeclaration) -> VarDeclaration | None:
        """Take an option; None where this is none."""
        word, value = self._token.keyword, self._peek()
        if word == "UNIT":
            self._refuse_compound_unit(1)
        if word == "UNIT" and value.kind == "word" and value.keyword not in DECLARATIONS:
            self._index += 2
            return replace(variable, unit=Identifier(value.text, value.start))
        if word == "ALLOW" and value.keyword == "INF":
            self._index += 2
            return replace(variable, infinite=True)
        is_number = value.kind == "number"
        if word == "RANGE" and (is_number or value.text == "-"):
            self._index += 1
            low = self._signed()
            self._expect("..")
            return replace(variable, range=(low, self._signed()))
        if word not in ("RATE", "TIMEOUT") or not is_number:
            return None
        self._index += 1
        if word == "TIMEOUT":
            return replace(variable, timeout=self._duration())
        rate = self._number()
        if self._token.text != "Hz" or not 0 < rate <= 1e9:
            self._fail("E001.rate", value.start)
        self._index += 1
        return replace(variable, rate=rate)

    def _constant(self) -> ConstDeclaration:
        self._index += 1
        name = self._new_name("the name of a constant")
        self._expect("=")
        value = self._signed()
        self._is_behind_declaration = True
        return ConstDeclaration(name.name, name.at, value)

    def _event(self) -> EventDeclaration:
        self._index += 1
        name = self._new_name("the name of the event")
        polarity = None
        if self._took("("):
            polarity = self._token.keyword
            if polarity not in ("EVIDENCE", "HAZARD"):
                self._missing("EVIDENCE or HAZARD")
            self._index += 1
            self._expect(")")
        self._expect(":=")
        return EventDeclaration(name.name, name.at, polarity, *self._definition())

    def _bare(self) -> EventDeclaration:
        at = self._token.start
        return EventDeclaration(ANONYMOUS, at, None, *self._definition(), anonymous=True)

    def _definition(self) -> tuple[int, int]:
        """Return the first and the last node of an expression."""
        self._is_behind_declaration = False
        self._depth, first = 0, len(self._nodes)
        return first, self._expression()

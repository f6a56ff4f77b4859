"""Texts of events: declarations, and expressions by precedence."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from eddi_scaffold.common.problems import did_you_mean, plural
from eddi_scaffold.conditions.syntax import (
    FUNCTIONS,
    MORE,
    OPERATORS,
    REDUCTIONS,
    WINDOWS,
    ConstDeclaration,
    EnumDeclaration,
    EventDeclaration,
    File,
    Identifier,
    ReductionOptions,
    SyntaxNode,
    VarDeclaration,
    is_list_path,
)
from eddi_scaffold.conditions.tokens import (
    DECLARATIONS,
    RESERVED,
    Cursor,
    Refused,
    TextFindings,
    Token,
    in_text,
    tokens_of,
)

MAX_TEXT = 64 * 1024
MAX_DEPTH = 100
_IMPLIES, _NOT, _COMPARISON, _MINUS = 1, 5, 6, 9
_STRENGTHS = {"implies": 1, "or": 2, "xor": 3, "and": 4, "add": 7, "sub": 7, "mul": 8, "div": 8}
_OPERATORS = {text: (_STRENGTHS.get(op, _COMPARISON), op) for op, text in OPERATORS.items()}
_LIST_OPTIONS = ("COVERAGE", "SECTOR", "LENGTH", "WITHIN")
_OPTIONS = ("UNIT", "RATE", "TIMEOUT", "RANGE", "ALLOW")
ANONYMOUS = "event"  # name of the event that a bare expression is


def parse(text: str, findings: TextFindings | None = None) -> File:
    """Parse declarations, an expression, or declarations and an expression behind them.

    What is wrong goes to ``findings`` (E001, E005, E006, E009, E013, W001); the declarations that
    could be read are returned.
    """
    findings = findings or TextFindings(in_text(text))
    if len(text.encode("utf-8", "surrogatepass")) > MAX_TEXT:
        findings.add("E013.text", 0, limit=MAX_TEXT)
        return File()
    tokens = tokens_of(text, findings)
    return File() if findings.problems else _Parser(tokens, findings).file()


class _Parser(Cursor):
    def __init__(self, tokens: tuple[Token, ...], findings: TextFindings) -> None:
        super().__init__(tokens, findings)
        self._nodes: list[SyntaxNode] = []
        self._depth = 0

    def file(self) -> File:
        readers = {
            "ENUM": self._enum,
            "VAR": self._variable,
            "CONST": self._constant,
            "EVENT": self._event,
            "": self._bare,
        }
        declarations: list[Identifier] = []
        while True:
            while self._took(";"):
                pass
            if self._token.kind == "end" and (declarations or self._findings.problems):
                break
            first, keyword = self._index, self._declaration()
            self._depth = 0
            try:
                self._index += keyword != ""
                declarations.append(readers[keyword]())
                if keyword in ("EVENT", ""):  # behind others an expression may begin
                    self._expect_end()
            except Refused:
                self._index += self._index == first and self._token.kind != "end"
                while not (self._token.kind == "end" or self._is_symbol(";")):
                    if self._declaration():
                        break
                    self._index += 1
        return File(
            tuple(self._nodes),
            tuple(of for of in declarations if isinstance(of, EnumDeclaration)),
            tuple(of for of in declarations if isinstance(of, VarDeclaration)),
            tuple(of for of in declarations if isinstance(of, ConstDeclaration)),
            tuple(of for of in declarations if isinstance(of, EventDeclaration)),
        )

    def _expect_end(self) -> None:
        if self._token.kind == "end" or self._is_symbol(";") or self._declaration():
            return
        keyword = self._tokens[self._index - 1].keyword
        hint = did_you_mean(keyword, [*DECLARATIONS, *_OPTIONS]) if keyword else None
        self._fail("E001.rest", hint=hint, shown=self._token.shown)

    def _enum(self) -> EnumDeclaration:
        name = self._new_name("the name of the ENUM")
        self._expect("{")
        literals = [self._new_name("a literal of the ENUM")]
        while self._took(","):
            literals.append(self._new_name("a literal of the ENUM"))
        self._expect("}")
        return EnumDeclaration(name.name, name.at, tuple(literals))

    def _variable(self) -> VarDeclaration:
        path = self._new_name("the name of a variable", is_path=True)
        self._expect(":")
        type_ = self._new_name("NUMBER, BOOL or the name of an ENUM")
        variable: VarDeclaration | None = VarDeclaration(path.name, path.at, type_)
        while variable is not None:
            declared = variable
            variable = self._option(declared)
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
        return replace(variable, timeout=variable.timeout or max(1, round(2.5e9 / rate)))

    def _constant(self) -> ConstDeclaration:
        name = self._new_name("the name of a constant")
        self._expect("=")
        value = self._signed()
        return ConstDeclaration(name.name, name.at, value)

    def _event(self) -> EventDeclaration:
        name = self._new_name("the name of the event")
        polarity = None
        if self._took("("):
            polarity = self._token.keyword
            if polarity not in ("EVIDENCE", "HAZARD"):
                self._missing("EVIDENCE or HAZARD")
            self._index += 1
            self._expect(")")
        self._expect(":=")
        first = len(self._nodes)
        return EventDeclaration(name.name, name.at, polarity, first, self._expression())

    def _bare(self) -> EventDeclaration:
        at, first = self._token.start, len(self._nodes)
        return EventDeclaration(ANONYMOUS, at, None, first, self._expression(), anonymous=True)

    # expressions

    def _expression(self, least: int = _IMPLIES) -> int:
        """Parse an expression of operators that are at least so strong."""
        self._depth += 1
        if self._depth > MAX_DEPTH:
            at, self._index = self._token.start, len(self._tokens) - 1  # nothing after it is read
            self._fail("E013.depth", at, limit=MAX_DEPTH)
        left, compared = self._operand(least), False
        while True:
            token = self._token
            strength, op = _OPERATORS.get(token.keyword or token.text, (0, ""))
            if token.text == "=":
                self._fail("E001.equals")
            if strength < least:
                self._depth -= 1
                return left
            if strength == _COMPARISON and compared:
                self._fail("E001.chain")
            self._index += 1
            compared = strength == _COMPARISON
            # IMPLIES groups to the right, all others to the left
            right = self._expression(strength + (strength != _IMPLIES))
            node = self._nodes[right]
            # `MAX(a, 1s) + MAX(b, 1s) / 2`: SESAME D7.2's own example means the mean
            is_quotient = node.op == "div" and not node.wrapped
            if op in ("add", "sub") and is_quotient and self._nodes[node.args[1]].op == "number":
                self._findings.add("W001", node.start)
            left = self._add(op, token, (left, right), start=self._nodes[left].start)

    def _operand(self, least: int) -> int:
        token = self._token
        if token.keyword == "NOT":
            if least > _NOT:
                self._missing("an operand, or (NOT a)")
            self._index += 1
            return self._add("not", token, (self._expression(_NOT),))
        if self._took("-"):
            return self._add("neg", token, (self._expression(_MINUS),))
        return self._atom()

    def _atom(self) -> int:
        token = self._token
        if token.kind == "number":
            self._number()
            return self._add("number", token, text=token.text, unit=self._unit())
        if token.keyword in ("TRUE", "FALSE"):
            return self._add("truth", self._take(), text=token.text)
        if self._took("("):
            inside = self._expression()
            self._expect(")")
            end, node = self._tokens[self._index - 1].end, self._nodes[inside]
            self._nodes[inside] = replace(node, start=token.start, end=end, wrapped=True)
            return inside
        if token.keyword == "UNKNOWN":
            self._fail("E001.literal")
        if self._declaration():
            end = self._tokens[self._index - 1].end if self._index else 0
            self._fail("E001.word", end, expected="an operand", shown="the next declaration")
        if token.kind == "text":
            self._fail("E001.character", shown=token.shown)
        if token.kind != "word" or token.keyword in (*_OPERATORS, "NOT"):
            self._missing("an operand")
        if token.keyword in RESERVED:
            self._fail("E001.reserved", shown=token.shown)
        self._index += 1
        if self._took("("):
            return self._call(token)
        name = self._path(token)
        return self._add("name", token, text=name, is_list=is_list_path(name))

    def _call(self, function: Token) -> int:
        word = function.keyword
        if word in WINDOWS or word in REDUCTIONS:
            argument = self._expression()
            if self._nodes[argument].is_list:
                return self._reduction(function, argument)
            return self._window(function, argument)
        if word not in FUNCTIONS and word not in MORE:
            names = dict.fromkeys((*WINDOWS, *REDUCTIONS, *FUNCTIONS, *MORE))
            hint = did_you_mean(function.text, names) or f"functions: {', '.join(names)}"
            self._fail("E006.unknown_function", function.start, hint=hint, shown=function.shown)
        args = [] if self._is_symbol(")") else [self._expression()]
        while self._took(","):
            args.append(self._expression())
        self._expect(")", "',' or ')'")
        op = "number_of" if word == "NUMBER" else word.lower()
        expected = FUNCTIONS.get(word, max(2, len(args)))
        if len(args) != expected:
            arguments = plural(expected, "argument") + (" or more" if word in MORE else "")
            self._fail(
                "E006.arguments", function.start, word=word, arguments=arguments, number=len(args)
            )
        if word not in MORE:
            return self._add(op, function, tuple(args))
        nested = args[0]
        for arg in args[1:]:
            nested = self._add(op, function, (nested, arg))
        return nested

    def _window(self, function: Token, argument: int) -> int:
        word = function.keyword
        if word not in WINDOWS:
            self._fail("E006.needs_list", function.start, word=word)
        if not self._took(","):
            self._fail("E005.duration", shown=self._token.shown)
        at, length, coverage = self._token.start, self._duration(), None
        if self._took(","):
            if self._token.keyword != "COVERAGE":
                self._missing("COVERAGE")
            self._index += 1
            if word in ("TIME", "ONCE"):
                self._fail("E005.not_here", self._tokens[self._index - 1].start, word=word)
            coverage = self._coverage()
        self._expect(")")
        more = {"window": length, "window_at": at, "coverage": coverage}
        return self._add(WINDOWS[word], function, (argument,), **more)

    def _coverage(self) -> float:
        number, share = self._token, self._number()
        if not 0 < share <= 1:
            self._findings.add("E005.range", number.start)
        return share

    def _reduction(self, function: Token, argument: int) -> int:
        word = function.keyword
        if word not in REDUCTIONS:
            known = ", ".join(REDUCTIONS)
            self._fail("E006.no_list", function.start, word=word, reductions=known)
        options, args, remaining = ReductionOptions(), [argument], [*_LIST_OPTIONS]
        coverage = None
        while self._took(","):
            option, at = self._token.keyword, self._token.start
            if option not in remaining:
                self._missing(" or ".join(remaining) or "')'")
            remaining.remove(option)
            self._index += 1
            if option == "COVERAGE":
                coverage = self._coverage()
            elif option == "SECTOR":
                low = self._signed()
                self._expect("..", "'..' as in SECTOR -30 deg .. 30 deg")
                options = replace(options, sector=(low, self._signed()), sector_at=at)
            elif option == "LENGTH":
                options = replace(options, length=self._lengths())
            else:
                args.append(self._expression())
                self._expect("..")
                args.append(self._expression())
                options = replace(options, within=True)
        self._expect(")", "',' or ')'")
        more = {"options": options, "coverage": coverage, "is_list": False}
        return self._add(REDUCTIONS[word], function, tuple(args), **more)

    def _lengths(self) -> tuple[int, int]:
        ends: list[int] = []
        while not ends or (len(ends) == 1 and self._took("..")):
            if not self._token.text.isdigit() or len(self._token.text) > 6:
                self._missing("a number of elements")
            ends.append(int(self._take().text))
        if ends[-1] < ends[0]:
            self._fail("E006.length")
        return ends[0], ends[-1]

    def _add(self, op: str, token: Token, args: tuple[int, ...] = (), **fields: Any) -> int:
        is_list = any(self._nodes[k].is_list for k in args)
        fields = {"start": token.start, "is_list": is_list, **fields}
        end = self._tokens[self._index - 1].end
        self._nodes.append(SyntaxNode(op, args, end=end, at=token.start, **fields))
        return len(self._nodes) - 1

"""The grammar of events, by precedence climbing."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NoReturn

from eddi_scaffold.events.diagnostics import Findings
from eddi_scaffold.events.syntax import (
    FUNCTIONS,
    WINDOWS,
    Bound,
    ConstDeclaration,
    EnumDeclaration,
    EventDeclaration,
    File,
    Named,
    Node,
    VarDeclaration,
)
from eddi_scaffold.events.tokens import RESERVED, Token, tokens_of
from eddi_scaffold.events.units import DURATIONS, UNITS, nanoseconds
from eddi_scaffold.problems import did_you_mean

MAX_TEXT = 64 * 1024
MAX_DEPTH = 100
MAX_NODES = 10_000
ANONYMOUS = "event"
"""Name of the event that a bare expression is."""

_IMPLIES, _COMPARISON, _SUM = 1, 6, 7
_WORDS = {"IMPLIES": (_IMPLIES, "implies"), "OR": (2, "or"), "XOR": (3, "xor"), "AND": (4, "and")}
_NOT, _MINUS = 5, 9
_SYMBOLS = {
    **{text: (_COMPARISON, op) for text, op in (("<", "lt"), ("<=", "le"), (">", "gt"))},
    **{text: (_COMPARISON, op) for text, op in ((">=", "ge"), ("==", "eq"), ("!=", "ne"))},
    "+": (_SUM, "add"),
    "-": (_SUM, "sub"),
    "*": (8, "mul"),
    "/": (8, "div"),
}
_DECLARATIONS = ("ENUM", "VAR", "CONST", "EVENT")
_PATH_INDEX = 10**6


class _Wrong(Exception):  # noqa: N818 - it ends one declaration, a Finding says what is wrong
    """The rest of a declaration cannot be read."""


def parse(text: str, findings: Findings) -> File:
    """Parse a text: declarations, an expression, or declarations and an expression behind them.

    What is wrong goes to ``findings`` (E001 to E006, E012 to E014, W001); the declarations that
    could be read are returned.
    """
    if len(text.encode("utf-8", "surrogatepass")) > MAX_TEXT:
        findings.error("E013", 0, f"the text is longer than {MAX_TEXT} bytes")
        return File()
    tokens = tokens_of(text, findings)
    if findings.problems:
        return File()
    return _Parser(tokens, findings).file()


class _Parser:
    def __init__(self, tokens: tuple[Token, ...], findings: Findings) -> None:
        self._tokens = tokens
        self._findings = findings
        self._k = 0
        self._depth = 0
        self._nodes: list[Node] = []
        self._declared = ""
        self._behind_declaration = False

    # declarations

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
                    self._fail("E003", f"the text goes on with {self._token.shown}")
            except _Wrong:
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

    def _declaration(self) -> str:
        """Return the word that opens a declaration here, empty when there is none."""
        word = self._token.word
        opens = word in _DECLARATIONS and self._peek().kind == "word"
        return word if opens or (word in _DECLARATIONS and self._peek().kind == "end") else ""

    def _at_declaration(self) -> bool:
        """Tell whether a declaration, or a bare expression behind declarations, may begin here."""
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
                self._behind_declaration = True
                return found
            found = option

    def _option(self, found: VarDeclaration) -> VarDeclaration | None:
        word, after = self._token.word, self._peek()
        if word == "UNIT" and after.kind == "word":
            self._k += 2
            return replace(found, unit=Named(after.text, after.start))
        if word == "RATE" and after.kind == "number":
            self._k += 1
            rate = self._number()
            if self._token.text != "Hz" or not 0 < rate <= 1e9:
                self._fail("E002", "a rate such as 10 Hz is expected", at=after.start)
            self._k += 1
            return replace(found, rate=rate)
        if word == "TIMEOUT" and after.kind == "number":
            self._k += 1
            return replace(found, timeout=self._duration("E005"))
        if word == "RANGE" and (after.kind == "number" or after.text == "-"):
            self._k += 1
            low = self._signed()
            self._expect("..")
            return replace(found, range=(low, self._signed()))
        if word == "ALLOW" and after.word == "INF":
            self._k += 2
            return replace(found, infinite=True)
        return None

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
                self._fail("E002", f"EVIDENCE or HAZARD is expected, found {self._token.shown}")
            self._k += 1
            self._expect(")")
        self._expect(":=")
        first = len(self._nodes)
        root = self._whole()
        return EventDeclaration(name.name, name.at, polarity, first, root)

    def _bare(self) -> EventDeclaration:
        first, at = len(self._nodes), self._token.start
        return EventDeclaration(ANONYMOUS, at, None, first, self._whole(), anonymous=True)

    def _whole(self) -> int:
        self._behind_declaration = False
        self._depth = 0
        return self._expression()

    # expressions

    def _expression(self) -> int:
        """Parse an expression with a stack of operators; only parentheses and calls recurse."""
        self._enter()
        stack: list[tuple[int, str, Token]] = []
        operands: list[int] = []
        while True:
            self._prefixes(stack)
            operands.append(self._atom())
            token = self._token
            strength, op = _WORDS.get(token.word) or _SYMBOLS.get(token.text) or (0, "")
            # IMPLIES groups to the right, all others to the left.
            while stack and stack[-1][0] >= strength + (strength == _IMPLIES):
                if stack[-1][0] == strength == _COMPARISON:
                    hint = "write a < b AND b < c"
                    self._fail("E004", "comparisons do not chain", hint=hint)
                self._reduce(stack.pop(), operands)
            if not op:
                break
            self._k += 1
            stack.append((strength, op, token))
        self._depth -= 1
        return operands[0]

    def _prefixes(self, stack: list[tuple[int, str, Token]]) -> None:
        while self._token.word == "NOT" or self._is_symbol("-"):
            prefix = (_MINUS, "neg") if self._is_symbol("-") else (_NOT, "not")
            if prefix[0] == _NOT and stack and stack[-1][0] > _NOT:
                hint = "put it in parentheses: (NOT a)"
                self._fail("E002", f"an operand is expected, found {self._token.shown}", hint=hint)
            stack.append((*prefix, self._token))
            self._k += 1

    def _reduce(self, operator: tuple[int, str, Token], operands: list[int]) -> None:
        _, op, token = operator
        right = operands.pop()
        if op in ("not", "neg"):
            operands.append(self._add(Node(op, (right,), token.start, token.start)))
            return
        left = operands.pop()
        self._check_mean(op, right)
        start = self._nodes[left].start
        operands.append(self._add(Node(op, (left, right), start, token.start)))

    def _atom(self) -> int:
        token = self._token
        if token.kind == "number":
            self._number()
            return self._add(Node("number", (), token.start, token.start, token.text, self._unit()))
        if token.word in ("TRUE", "FALSE"):
            self._k += 1
            return self._add(Node("truth", (), token.start, token.start, token.text))
        if self._is_symbol("("):
            self._k += 1
            inside = self._expression()
            self._expect(")")
            self._nodes[inside] = replace(self._nodes[inside], start=token.start, wrapped=True)
            return inside
        if token.kind == "word":
            return self._named(token)
        message = f"an operand is expected, found {token.shown}"
        return self._fail("E002", message)

    def _named(self, token: Token) -> int:
        if token.word == "UNKNOWN":
            hint = "KNOWN(x) tells whether a value is known"
            self._fail("E012", "UNKNOWN is no literal, use KNOWN(...)", hint=hint)
        if token.word in RESERVED:
            if self._declaration():
                end = self._tokens[self._k - 1].end if self._k else 0
                message = "an operand is expected, found the next declaration"
                self._fail("E002", message, at=end)
            if token.word in (*_WORDS, "NOT"):
                self._fail("E002", f"an operand is expected, found {token.shown}")
            self._fail("E012", f"{token.shown} is a reserved word, it cannot be a name")
        self._k += 1
        if self._is_symbol("("):
            return self._call(token)
        name = self._path_rest(token.text)
        return self._add(Node("name", (), token.start, token.start, name))

    def _path_rest(self, name: str) -> str:
        while True:
            if self._is_symbol(".") and self._peek().kind == "word":
                name += f".{self._peek().text}"
                self._k += 2
            elif self._is_symbol("["):
                self._k += 1
                index = self._token
                if not (
                    index.text.isdigit() and len(index.text) < 8 and int(index.text) < _PATH_INDEX
                ):
                    self._fail("E002", f"an index from 0 on is expected, found {index.shown}")
                self._k += 1
                self._expect("]")
                name += f"[{int(index.text)}]"
            else:
                return name

    def _call(self, token: Token) -> int:
        self._k += 1
        if token.word in WINDOWS:
            return self._window(token)
        if token.word not in FUNCTIONS:
            names = {name: name for name in (*WINDOWS, *FUNCTIONS)}
            hint = did_you_mean(token.text, names) or f"functions: {', '.join(names)}"
            self._fail("E006", f"there is no function {token.shown}", at=token.start, hint=hint)
        args = [] if self._is_symbol(")") else [self._expression()]
        while self._is_symbol(","):
            self._k += 1
            args.append(self._expression())
        if not self._is_symbol(")"):
            self._fail("E002", f"',' or ')' is expected, found {self._token.shown}")
        self._k += 1
        wanted = FUNCTIONS[token.word]
        if len(args) != wanted:
            plural = "s" if wanted != 1 else ""
            message = f"{token.word} takes {wanted} argument{plural}, here are {len(args)}"
            self._fail("E006", message, at=token.start)
        return self._add(Node(token.word.lower(), tuple(args), token.start, token.start))

    def _window(self, token: Token) -> int:
        op = WINDOWS[token.word]
        argument = self._expression()
        if self._is_symbol(")"):
            self._fail("E005", f"{token.word} needs a duration", hint=f"{token.word}(x, 5s)")
        self._expect(",", "',' and a duration such as 5s")
        at = self._token.start
        length = self._duration("E005")
        coverage = None
        if self._is_symbol(","):
            self._k += 1
            coverage = self._coverage(token, op)
        self._expect(")")
        return self._add(
            Node(op, (argument,), token.start, token.start, "", None, False, length, at, coverage)
        )

    def _coverage(self, function: Token, op: str) -> float:
        word = self._token
        if word.word != "COVERAGE":
            message = f"{function.word} takes 1 argument and a duration"
            self._fail("E006", message, at=function.start)
        self._k += 1
        number = self._token
        if number.kind != "number":
            self._fail("E002", f"a number is expected, found {number.shown}")
        share = self._number()
        if op in ("time", "once"):
            message = f"{function.word} takes no COVERAGE"
            self._findings.error("E014", word.start, message)
        elif not 0 < share <= 1:
            self._findings.error("E014", number.start, "the coverage must be above 0 and at most 1")
        return share

    def _check_mean(self, op: str, right: int) -> None:
        """Warn of `MAX(a, 1s) + MAX(b, 1s) / 2`: SESAME D7.2's own example means the mean."""
        node = self._nodes[right]
        is_quotient = node.op == "div" and not node.wrapped
        if op in ("add", "sub") and is_quotient and self._nodes[node.args[1]].op == "number":
            message = "only this term is divided, not the whole sum"
            hint = "put the sum in parentheses, or this term to say that it is meant so"
            self._findings.warning("W001", node.start, message, hint)

    # tokens

    @property
    def _token(self) -> Token:
        return self._tokens[self._k]

    def _peek(self) -> Token:
        return self._tokens[min(self._k + 1, len(self._tokens) - 1)]

    def _is_symbol(self, text: str) -> bool:
        return self._token.kind == "symbol" and self._token.text == text

    def _expect(self, symbol: str, shown: str | None = None) -> None:
        if not self._is_symbol(symbol):
            wanted = shown or repr(symbol)
            self._fail("E002", f"{wanted} is expected, found {self._token.shown}")
        self._k += 1

    def _new_name(self, what: str) -> Named:
        token = self._token
        if token.kind != "word":
            self._fail("E002", f"{what} is expected, found {token.shown}")
        if token.word in RESERVED:
            self._fail("E012", f"{token.shown} is a reserved word, it cannot be a name")
        self._k += 1
        self._declared = self._declared or token.text
        return Named(token.text, token.start)

    def _number(self) -> float:
        """Take a number that a double can hold."""
        token = self._token
        value = float(token.text)
        digits = token.text.lower().partition("e")[0]
        if not math.isfinite(value) or (value == 0 and digits.strip("0.") != ""):
            self._fail("E013", "the number does not fit into a double", at=token.start)
        self._k += 1
        return value

    def _signed(self) -> Bound:
        at, negative = self._token.start, self._is_symbol("-")
        self._k += negative
        if self._token.kind != "number":
            self._fail("E002", f"a number is expected, found {self._token.shown}")
        value = self._number()
        return Bound(-value if negative else value, self._unit(), at)

    def _unit(self) -> str | None:
        """Take the unit behind a number, if there is one."""
        token, number = self._token, self._tokens[self._k - 1]
        if token.kind != "word":
            return None
        if token.text in UNITS:
            self._k += 1
            return token.text
        if token.start == number.end:  # 5x: it cannot be anything else
            hint = did_you_mean(token.text, UNITS) or f"units: {', '.join(sorted(UNITS))}"
            self._fail("E009", f"there is no unit {token.shown}", hint=hint)
        return None

    def _duration(self, code: str) -> int:
        number, unit = self._token, self._peek()
        if number.kind != "number" or unit.kind != "word" or unit.text not in DURATIONS:
            hint = f"the unit is one of {', '.join(DURATIONS)}"
            self._fail(code, f"a duration such as 5s is expected, found {number.shown}", hint=hint)
        if unit.start != number.end:
            hint = f"write {number.text}{unit.text}"
            self._fail(code, "the unit of a duration stands directly behind the number", hint=hint)
        try:
            length = nanoseconds(number.text, unit.text)
        except OverflowError:
            self._fail("E013", "the duration does not fit into 62 bits of nanoseconds")
        if length == 0:
            self._fail(code, "a duration must be longer than 0")
        self._k += 2
        return length

    def _add(self, node: Node) -> int:
        if len(self._nodes) >= MAX_NODES:
            self._k = len(self._tokens) - 1
            self._fail("E013", f"the text has more than {MAX_NODES} operations", at=node.at)
        self._nodes.append(node)
        return len(self._nodes) - 1

    def _enter(self) -> None:
        self._depth += 1
        if self._depth > MAX_DEPTH:
            at = self._token.start
            self._k = len(self._tokens) - 1
            self._fail("E013", f"the expression is nested more than {MAX_DEPTH} deep", at=at)

    def _fail(
        self, code: str, message: str, *, at: int | None = None, hint: str | None = None
    ) -> NoReturn:
        self._findings.error(code, self._token.start if at is None else at, message, hint)
        raise _Wrong

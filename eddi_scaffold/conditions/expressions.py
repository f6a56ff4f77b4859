"""Expressions of events, by precedence with a stack of operators."""

from __future__ import annotations

from dataclasses import replace

from eddi_scaffold.common.problems import did_you_mean
from eddi_scaffold.conditions.findings import TextFindings
from eddi_scaffold.conditions.syntax import (
    FUNCTIONS,
    MORE,
    OPERATIONS,
    REDUCTIONS,
    WINDOWS,
    ReductionOptions,
    SyntaxNode,
    is_list_path,
)
from eddi_scaffold.conditions.tokens import DURATIONS, RESERVED, Cursor, Token

MAX_DEPTH = 100
MAX_NODES = 10_000

_IMPLIES, _COMPARISON, _SUM = 1, 6, 7
_WORDS = {"IMPLIES": (_IMPLIES, "implies"), "OR": (2, "or"), "XOR": (3, "xor"), "AND": (4, "and")}
_NOT, _MINUS = 5, 9
_PAST = {
    **dict.fromkeys(("EVENTUALLY", "FINALLY", "F"), "ONCE({}, {})"),
    **dict.fromkeys(("ALWAYS", "GLOBALLY", "HISTORICALLY", "G", "H"), "NOT ONCE(NOT ({}), {})"),
    **dict.fromkeys(("UNTIL", "SINCE", "U", "S"), "LATCH(begin, end)"),
}
"""Word of signal temporal logic -> what looks back in its place, of a condition and a duration."""
LIST_OPTIONS = ("COVERAGE", "SECTOR", "LENGTH", "WITHIN")
_SYMBOLS = {
    **{text: (_COMPARISON, op) for text, op in (("<", "lt"), ("<=", "le"), (">", "gt"))},
    **{text: (_COMPARISON, op) for text, op in ((">=", "ge"), ("==", "eq"), ("!=", "ne"))},
    "+": (_SUM, "add"),
    "-": (_SUM, "sub"),
    "*": (8, "mul"),
    "/": (8, "div"),
}


class ExpressionParser(Cursor):
    """Reads expressions; their nodes follow each other."""

    def __init__(self, tokens: tuple[Token, ...], findings: TextFindings) -> None:
        super().__init__(tokens, findings)
        self._nodes: list[SyntaxNode] = []
        self._depth = 0

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
                    self._fail("E001.chain")
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
                self._fail("E001.operand_not", shown=self._token.shown)
            stack.append((*prefix, self._token))
            self._k += 1

    def _reduce(self, operator: tuple[int, str, Token], operands: list[int]) -> None:
        _, op, token = operator
        right = operands.pop()
        if op in ("not", "neg"):
            operands.append(self._add(SyntaxNode(op, (right,), token.start, token.start)))
            return
        left = operands.pop()
        self._check_mean(op, right)
        start = self._nodes[left].start
        operands.append(self._add(SyntaxNode(op, (left, right), start, token.start)))

    def _atom(self) -> int:
        token = self._token
        if token.kind == "number":
            self._number()
            return self._add(
                SyntaxNode("number", (), token.start, token.start, token.text, self._unit())
            )
        if token.word in ("TRUE", "FALSE"):
            self._k += 1
            return self._add(SyntaxNode("truth", (), token.start, token.start, token.text))
        if self._is_symbol("("):
            self._k += 1
            inside = self._expression()
            self._expect(")")
            self._nodes[inside] = replace(self._nodes[inside], start=token.start, wrapped=True)
            return inside
        if token.kind == "word":
            return self._named(token)
        return self._fail("E001.operand", shown=token.shown)

    def _named(self, token: Token) -> int:
        if token.word == "UNKNOWN":
            self._fail("E001.literal")
        if token.word in RESERVED:
            if self._declaration():
                end = self._tokens[self._k - 1].end if self._k else 0
                self._fail("E001.operand_before_declaration", end)
            if token.word in (*_WORDS, "NOT"):
                self._fail("E001.operand", shown=token.shown)
            self._fail("E001.reserved", shown=token.shown)
        self._k += 1
        if self._is_symbol("("):
            return self._call(token)
        if self._is_symbol("[") and self._peek(2).text in (":", ",") and token.word in _PAST:
            instead = self._temporal_hint(self._k - 1)
            self._fail("E006.unknown_function", token.start, hint=instead, shown=token.shown)
        name = self._path_rest(token.text)
        return self._add(SyntaxNode("name", (), token.start, token.start, name))

    def _call(self, token: Token) -> int:
        self._k += 1
        if token.word in WINDOWS or token.word in REDUCTIONS:
            return self._window(token)
        if token.word not in FUNCTIONS and token.word not in MORE:
            names = {name: name for name in (*WINDOWS, *REDUCTIONS, *FUNCTIONS, *MORE)}
            near = self._temporal_hint(self._k - 2) or did_you_mean(token.text, names)
            hint = near or f"functions: {', '.join(names)}"
            self._fail("E006.unknown_function", token.start, hint=hint, shown=token.shown)
        args = [] if self._is_symbol(")") else [self._expression()]
        while self._is_symbol(","):
            self._k += 1
            args.append(self._expression())
        if not self._is_symbol(")"):
            self._fail("E001.list_end", shown=self._token.shown)
        self._k += 1
        if token.word in MORE:
            return self._nested(token, args)
        wanted = FUNCTIONS[token.word]
        if len(args) != wanted:
            plural = "s" if wanted != 1 else ""
            self._fail(
                "E006.arguments",
                token.start,
                word=token.word,
                expected=wanted,
                plural=plural,
                number=len(args),
            )
        op = OPERATIONS.get(token.word, token.word.lower())
        return self._add(SyntaxNode(op, tuple(args), token.start, token.start))

    def _temporal_hint(self, at: int) -> str | None:
        """Return what to write for a word of signal temporal logic, none for another token."""
        form = _PAST.get(self._tokens[at].word)
        opening = at + 1
        while form is not None and self._tokens[opening].text != "(":
            if self._tokens[opening].kind == "end":
                return f"write {form.format('x > 1', '5s')}"
            opening += 1
        if form is None:
            return None
        depth, text, before = 1, "", self._tokens[opening]
        for token in self._tokens[opening + 1 :]:
            depth += (token.text == "(") - (token.text == ")")
            if depth == 0:
                break
            text += " " * (token.start - before.end) + token.text
            before = token
        condition, comma, length = text.rpartition(",")
        return f"write {form.format(*((condition, length.strip()) if comma else (text, '5s')))}"

    def _nested(self, token: Token, args: list[int]) -> int:
        """Add LEAST or GREATEST of two arguments, as often as needed."""
        if len(args) < 2:
            self._fail("E006.two_arguments", token.start, word=token.word, number=len(args))
        op = token.word.lower()
        found = args[0]
        for arg in args[1:]:
            found = self._add(SyntaxNode(op, (found, arg), token.start, token.start))
        return found

    def _window(self, token: Token) -> int:
        argument = self._expression()
        if self._nodes[argument].is_list:
            return self._reduction(token, argument)
        if token.word not in WINDOWS:
            self._fail("E006.needs_list", token.start, word=token.word)
        op = WINDOWS[token.word]
        if self._is_symbol(")"):
            self._fail("E005.no_duration", word=token.word)
        self._expect(",", "',' and a duration such as 5s")
        at, word = self._token.start, self._token.word
        if word in LIST_OPTIONS and word != "COVERAGE":
            self._fail("E006.for_lists", word=word, function=token.word)
        length = self._duration()
        coverage = None
        if self._is_symbol(","):
            self._k += 1
            coverage = self._coverage(token, op)
        self._expect(")")
        return self._add(
            SyntaxNode(
                op, (argument,), token.start, token.start, "", None, False, length, at, coverage
            )
        )

    def _coverage(self, function: Token, op: str) -> float:
        word = self._token
        if word.word != "COVERAGE":
            self._fail("E006.one_argument", function.start, word=function.word)
        self._k += 1
        number = self._token
        if number.kind != "number":
            self._fail("E001.number", shown=number.shown)
        share = self._number()
        if op in ("time", "once"):
            self._findings.add("E005.not_here", word.start, word=function.word)
        elif not 0 < share <= 1:
            hint = f"{word.word} {share / 100:g}" if 10 <= share <= 100 else None  # percent
            self._findings.add("E005.range", number.start, hint=hint)
        return share

    def _reduction(self, token: Token, argument: int) -> int:
        """Take the options behind the list of a reduction."""
        if token.word not in REDUCTIONS:
            self._fail(
                "E006.no_list", token.start, word=token.word, reductions=", ".join(REDUCTIONS)
            )
        options, args = ReductionOptions(), [argument]
        while self._is_symbol(","):
            self._k += 1
            options = self._list_option(token, options, args)
        if not self._is_symbol(")"):
            self._fail("E001.list_end", shown=self._token.shown)
        self._k += 1
        op = REDUCTIONS[token.word]
        return self._add(SyntaxNode(op, tuple(args), token.start, token.start, options=options))

    def _list_option(
        self, token: Token, options: ReductionOptions, args: list[int]
    ) -> ReductionOptions:
        """Take one option; limits of elements become arguments."""
        word = self._token
        if word.word not in LIST_OPTIONS:
            if word.kind == "number" and self._peek().text in DURATIONS:
                self._fail("E006.list_duration", word=token.word)
            self._fail("E001.list_option", list_options=" or ".join(LIST_OPTIONS), shown=word.shown)
        if word.word in dict(options.at):
            self._fail("E006.repeated", word=word.word)
        options = replace(options, at=(*options.at, (word.word, word.start)))
        if word.word == "COVERAGE":
            return replace(options, coverage=self._coverage(token, REDUCTIONS[token.word]))
        self._k += 1
        if word.word == "SECTOR":
            low = self._signed()
            self._expect("..", "'..' as in SECTOR -30 deg .. 30 deg")
            return replace(options, sector=(low, self._signed()))
        if word.word == "LENGTH":
            return replace(options, length=self._lengths())
        args.append(self._expression())
        self._expect("..")
        args.append(self._expression())
        return replace(options, within=True)

    def _lengths(self) -> tuple[int, int]:
        ends = [self._whole_number()]
        if self._is_symbol(".."):
            self._k += 1
            ends.append(self._whole_number())
        if ends[-1] < ends[0]:
            self._fail("E006.length")
        return ends[0], ends[-1]

    def _whole_number(self) -> int:
        token = self._token
        if not token.text.isdigit() or len(token.text) > 6:
            self._fail("E001.count", shown=token.shown)
        self._k += 1
        return int(token.text)

    def _check_mean(self, op: str, right: int) -> None:
        """Warn of `MAX(a, 1s) + MAX(b, 1s) / 2`: SESAME D7.2's own example means the mean."""
        node = self._nodes[right]
        is_quotient = node.op == "div" and not node.wrapped
        if op in ("add", "sub") and is_quotient and self._nodes[node.args[1]].op == "number":
            self._findings.add("W001", node.start)

    def _add(self, node: SyntaxNode) -> int:
        if len(self._nodes) >= MAX_NODES:
            self._k = len(self._tokens) - 1
            self._fail("E013.operations", node.at, limit=MAX_NODES)
        if node.op not in REDUCTIONS.values():
            is_list = any(self._nodes[k].is_list for k in node.args)
            if is_list or (node.op == "name" and is_list_path(node.text)):
                node = replace(node, is_list=True)
        self._nodes.append(node)
        return len(self._nodes) - 1

    def _enter(self) -> None:
        self._depth += 1
        if self._depth > MAX_DEPTH:
            at = self._token.start
            self._k = len(self._tokens) - 1
            self._fail("E013.depth", at, limit=MAX_DEPTH)

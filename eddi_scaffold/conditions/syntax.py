"""Syntax of a text of events: declarations, expressions as lists of nodes, canonical form.

The nodes of all expressions are in one tuple, each after its operands, so that every walk over
them is a loop: a text of 10,000 nodes may be a chain as deep as it is long.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class NumberWithUnit:
    """A number with its unit: one end of a RANGE, the value of a CONST."""

    value: float
    unit: str | None
    at: int


@dataclass(frozen=True)
class ReductionOptions:
    """The options after the list of a reduction.

    Attributes:
        coverage: share of known elements that is enough.
        sector: angles of the first and the last element.
        length: least and greatest number of elements.
        within: the node has two more arguments, the limits of the elements.
        at: offset of each option's word.
    """

    coverage: float | None = None
    sector: tuple[NumberWithUnit, NumberWithUnit] | None = None
    length: tuple[int, int] | None = None
    within: bool = False
    at: tuple[tuple[str, int], ...] = ()


@dataclass(frozen=True)
class SyntaxNode:
    """One operation, literal or name.

    Attributes:
        op: ``number``, ``truth``, ``name``, ``neg``, ``not``, an operator (``add``, ``lt``,
            ``and``, ...) or a function (``average``, ``latch``, ...).
        args: indices of the operands.
        start: offset of its first character, with the parenthesis around it.
        at: offset of the operator or of the function's name.
        text: name, number or truth value as written.
        unit: of a number.
        wrapped: it has parentheses of its own.
        window: nanoseconds of a window.
        window_at: offset of the duration.
        coverage: share of known samples that is enough.
        is_list: it has one value for each element of a list.
        options: of a reduction.
    """

    op: str
    args: tuple[int, ...]
    start: int
    at: int
    text: str = ""
    unit: str | None = None
    wrapped: bool = False
    window: int = 0
    window_at: int = 0
    coverage: float | None = None
    is_list: bool = False
    options: ReductionOptions | None = None


@dataclass(frozen=True)
class Identifier:
    """A name and its place."""

    name: str
    at: int


@dataclass(frozen=True)
class EnumDeclaration(Identifier):
    """``ENUM Mode { AUTO, MANUAL }``."""

    literals: tuple[Identifier, ...]


@dataclass(frozen=True)
class VarDeclaration(Identifier):
    """``VAR x : NUMBER UNIT degC RATE 10 Hz TIMEOUT 500ms RANGE 0 .. 100 ALLOW INF``.

    Attributes:
        type: ``NUMBER``, ``BOOL`` or the name of an ENUM, with its place.
        unit: with its place.
        rate: samples per second.
        timeout: nanoseconds.
        range: both ends.
        infinite: ALLOW INF.
    """

    type: Identifier
    unit: Identifier | None = None
    rate: float | None = None
    timeout: int | None = None
    range: tuple[NumberWithUnit, NumberWithUnit] | None = None
    infinite: bool = False


@dataclass(frozen=True)
class ConstDeclaration(Identifier):
    """``CONST limit = 5 m``."""

    value: NumberWithUnit


@dataclass(frozen=True)
class EventDeclaration(Identifier):
    """``EVENT hot (EVIDENCE) := x > 5``, or a bare expression.

    Attributes:
        polarity: ``EVIDENCE`` or ``HAZARD``, None when not given.
        first: index of the expression's first node.
        root: index of its last node.
        anonymous: a bare expression.
    """

    polarity: str | None
    first: int
    root: int
    anonymous: bool = False


@dataclass(frozen=True)
class File:
    """A text that was parsed.

    Attributes:
        nodes: of all expressions.
        broken: names whose declaration could not be read.
    """

    nodes: tuple[SyntaxNode, ...] = ()
    enums: tuple[EnumDeclaration, ...] = ()
    variables: tuple[VarDeclaration, ...] = ()
    constants: tuple[ConstDeclaration, ...] = ()
    events: tuple[EventDeclaration, ...] = ()
    broken: frozenset[str] = frozenset()

    def nodes_of(self, event: EventDeclaration) -> tuple[SyntaxNode, ...]:
        """Return the nodes of an event's expression."""
        return self.nodes[event.first : event.root + 1]

    def reduced_to(self, name: str) -> File:
        """Return the file with one event and those that it uses, also by way of others."""
        events = {event.name: event for event in self.events if not event.anonymous}
        events |= {event.name: event for event in self.events if event.name == name}
        used: set[str] = set()
        left = {name} & events.keys()
        while left:
            event = events[left.pop()]
            used.add(event.name)
            names = {node.text for node in self.nodes_of(event) if node.op == "name"}
            left |= names & events.keys() - used
        return replace(self, events=tuple(e for e in self.events if e.name in used))


OPERATORS = {
    "implies": "IMPLIES",
    "or": "OR",
    "xor": "XOR",
    "and": "AND",
    "lt": "<",
    "le": "<=",
    "gt": ">",
    "ge": ">=",
    "eq": "==",
    "ne": "!=",
    "add": "+",
    "sub": "-",
    "mul": "*",
    "div": "/",
}
"""Operation with two operands -> how it is written."""
PREFIXES = {"not": "NOT ", "neg": "-"}
WINDOWS = {
    "AVERAGE": "average",
    "AVG": "average",
    "MAX": "max",
    "MIN": "min",
    "SUM": "sum",
    "COUNT": "count",
    "RATE": "rate",
    "STDDEV": "stddev",
    "MEDIAN": "median",
    "TIME": "time",
    "ONCE": "once",
}
REDUCTIONS = {
    "MIN": "list_min",
    "MAX": "list_max",
    "AVERAGE": "list_average",
    "AVG": "list_average",
    "SUM": "list_sum",
    "MEDIAN": "list_median",
    "STDDEV": "list_stddev",
    "COUNT": "list_count",
    "ANY": "list_any",
    "ALL": "list_all",
}
"""Function of a list -> operation."""
FUNCTIONS = {
    "ABS": 1,
    "SQRT": 1,
    "HYPOT": 2,
    "CLAMP": 3,
    "NUMBER": 1,
    "ELAPSED": 1,
    "RISE": 1,
    "FALL": 1,
    "EDGE": 1,
    "LATCH": 2,
    "HYSTERESIS": 3,
    "KNOWN": 1,
    "AGE": 1,
}
"""Function -> number of its arguments."""
OPERATIONS = {"NUMBER": "number_of"}
"""Function -> operation, where it is not the word in small letters."""
MORE = ("LEAST", "GREATEST")
"""Functions of two arguments or more."""


def word_of(op: str) -> str:
    """Return how an operation or a function is written."""
    if op in OPERATORS or op in PREFIXES:
        return {**OPERATORS, **PREFIXES}[op].strip()
    words = (word for word, of in OPERATIONS.items() if of == op)
    return next(words, op.removeprefix("list_").upper())


_ELEMENTS = re.compile(r'\[(\*|[0-9]+\.\.[0-9]+)\]|"[^"]*"')


def is_list_path(name: str) -> bool:
    """Return whether a path has ``[*]`` or ``[2..5]``: all it leads to, not one value."""
    return any(match[1] for match in _ELEMENTS.finditer(name))


def array_of(name: str) -> tuple[str, str]:
    """Return the part of a path up to its last ``[*]`` or ``[2..5]``, and the rest."""
    *_, last = (match for match in _ELEMENTS.finditer(name) if match[1])
    return name[: last.end()], name[last.end() :]


_MS = 10**6


def canonical(file: File, root: int) -> str:
    """Return the canonical form of the expression that ends at a node."""
    first = root
    while file.nodes[first].args:  # the operands of an expression are right before it
        first = file.nodes[first].args[0]
    texts: list[str] = []
    for node in file.nodes[first : root + 1]:
        texts.append(_text(node, [texts[k - first] for k in node.args]))
        for k in node.args:
            texts[k - first] = ""  # each is used once: what is printed can go
    return texts[-1]


def number_text(value: float) -> str:
    """Return the shortest text that gives this number again: ``100``, ``0.5``, ``1e-07``."""
    text = repr(float(value))
    return text.removesuffix(".0")


def duration_text(ns: int) -> str:
    """Return a duration in the canonical form."""
    return f"{ns}ns" if ns % _MS else f"{ns // _MS}ms"


def _listed(options: ReductionOptions, args: list[str]) -> list[str]:
    """Return the list of a reduction, and its options in one order."""
    found = args[:1]
    if options.sector is not None:
        ends = [f"{number_text(one.value)} {one.unit}" for one in options.sector]
        found.append(f"SECTOR {' .. '.join(ends)}")
    if options.length is not None:
        found.append(f"LENGTH {' .. '.join(str(n) for n in dict.fromkeys(options.length))}")
    if options.within:
        found.append(f"WITHIN {args[1]} .. {args[2]}")
    if options.coverage is not None:
        found.append(f"COVERAGE {number_text(options.coverage)}")
    return found


def _text(node: SyntaxNode, args: list[str]) -> str:
    if node.op in OPERATORS:
        return f"({args[0]} {OPERATORS[node.op]} {args[1]})"
    if node.op in PREFIXES:
        return f"({PREFIXES[node.op]}{args[0]})"
    if node.op == "number":
        return number_text(float(node.text)) + (f" {node.unit}" if node.unit else "")
    if node.op == "truth":
        return node.text.upper()
    if node.op == "name":
        return node.text
    if node.options is not None:
        return f"{word_of(node.op)}({', '.join(_listed(node.options, args))})"
    inside = [*args]
    if node.window:
        inside.append(duration_text(node.window))
    if node.coverage is not None:
        inside.append(f"COVERAGE {number_text(node.coverage)}")
    return f"{word_of(node.op)}({', '.join(inside)})"

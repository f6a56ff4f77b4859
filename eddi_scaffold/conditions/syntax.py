"""Syntax of a text of events: declarations, expressions as lists of nodes, canonical form.

The nodes of all expressions are in one tuple, each after its operands, so that every walk over
them is a loop: a text may be a chain as deep as it is long.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from eddi_scaffold.common.graphs import reached


@dataclass(frozen=True)
class NumberWithUnit:
    """A number with its unit: one end of a RANGE, the value of a CONST."""

    value: float
    unit: str | None
    at: int


@dataclass(frozen=True)
class ReductionOptions:
    """The options after the list of a reduction."""

    # angles of the first and the last element
    sector: tuple[NumberWithUnit, NumberWithUnit] | None = None
    length: tuple[int, int] | None = None  # least and greatest number of elements
    within: bool = False  # the node has two more arguments, the limits of the elements
    sector_at: int = 0  # offset of the word SECTOR


@dataclass(frozen=True)
class SyntaxNode:
    """One operation, literal or name."""

    # `number`, `truth`, `name`, `neg`, `not`, an operator (`add`, `lt`, `and`, ...) or a function
    # (`average`, `latch`, ...)
    op: str
    args: tuple[int, ...]  # indices of the operands
    start: int  # offset of its first character, with its parenthesis
    end: int  # offset behind its last one
    at: int  # offset of the operator or of the function's name
    text: str = ""  # name, number or truth value as written
    unit: str | None = None  # of a number
    wrapped: bool = False  # it has parentheses of its own
    window: int = 0  # nanoseconds of a window
    window_at: int = 0  # offset of the duration
    coverage: float | None = None  # share of known samples or elements that is enough
    is_list: bool = False  # it has one value for each element of a list
    options: ReductionOptions | None = None  # of a reduction


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
    """``VAR x : NUMBER UNIT degC RATE 10 Hz TIMEOUT 500ms RANGE 0 .. 100 ALLOW INF``."""

    type: Identifier  # `NUMBER`, `BOOL` or the name of an ENUM
    unit: Identifier | None = None
    timeout: int | None = None  # nanoseconds; by RATE 2.5 periods
    range: tuple[NumberWithUnit, NumberWithUnit] | None = None
    infinite: bool = False  # ALLOW INF


@dataclass(frozen=True)
class ConstDeclaration(Identifier):
    """``CONST limit = 5 m``."""

    value: NumberWithUnit


@dataclass(frozen=True)
class EventDeclaration(Identifier):
    """``EVENT hot (EVIDENCE) := x > 5``, or a bare expression."""

    polarity: str | None  # `EVIDENCE` or `HAZARD`, None when not given
    first: int  # index of the expression's first node
    root: int  # index of its last node
    anonymous: bool = False  # a bare expression


@dataclass(frozen=True)
class File:
    """A text that was parsed."""

    nodes: tuple[SyntaxNode, ...] = ()  # of all expressions
    enums: tuple[EnumDeclaration, ...] = ()
    variables: tuple[VarDeclaration, ...] = ()
    constants: tuple[ConstDeclaration, ...] = ()
    events: tuple[EventDeclaration, ...] = ()

    def nodes_of(self, event: EventDeclaration) -> tuple[SyntaxNode, ...]:
        """Return the nodes of an event's expression."""
        return self.nodes[event.first : event.root + 1]

    def reduced_to(self, name: str) -> File:
        """Return the file with one event and those that it uses, also by way of others."""
        events = {event.name: event for event in self.events if not event.anonymous}
        events |= {event.name: event for event in self.events if event.name == name}
        uses = {
            event.name: [node.text for node in self.nodes_of(event) if node.text in events]
            for event in events.values()
        }
        used = reached(uses, {name} & events.keys())
        return replace(self, events=tuple(event for event in self.events if event.name in used))


OPERATORS = {word.lower(): word for word in ("IMPLIES", "OR", "XOR", "AND")}
OPERATORS |= {"lt": "<", "le": "<=", "gt": ">", "ge": ">=", "eq": "==", "ne": "!="}
OPERATORS |= {"add": "+", "sub": "-", "mul": "*", "div": "/"}
"""Operation with two operands -> how it is written."""
PREFIXES = {"not": "NOT ", "neg": "-"}
_WINDOW_WORDS = ("MAX", "MIN", "SUM", "COUNT", "RATE", "STDDEV", "MEDIAN", "TIME", "ONCE")
WINDOWS = {"AVERAGE": "average", "AVG": "average", **{word: word.lower() for word in _WINDOW_WORDS}}
_LIST_WORDS = ("SUM", "MEDIAN", "STDDEV", "COUNT", "ANY", "ALL")
REDUCTIONS = {
    "MIN": "list_min",
    "MAX": "list_max",
    "AVERAGE": "list_average",
    "AVG": "list_average",
    **{word: f"list_{word.lower()}" for word in _LIST_WORDS},
}
"""Function of a list -> operation."""
_OF_ONE = ("ABS", "SQRT", "NUMBER", "ELAPSED", "RISE", "FALL", "EDGE", "KNOWN", "AGE")
FUNCTIONS = {**dict.fromkeys(_OF_ONE, 1), "HYPOT": 2, "LATCH": 2, "CLAMP": 3, "HYSTERESIS": 3}
"""Function -> number of its arguments."""
MORE = ("LEAST", "GREATEST")  # functions of two arguments or more


def word_of(op: str) -> str:
    """Return how an operation or a function is written."""
    if op in OPERATORS or op in PREFIXES:
        return {**OPERATORS, **PREFIXES}[op].strip()
    return op.removeprefix("list_").removesuffix("_of").upper()


_ELEMENTS = re.compile(r'\[(\*|[0-9]+\.\.[0-9]+)\]|"[^"]*"')


def is_list_path(name: str) -> bool:
    """Return whether a path has ``[*]`` or ``[2..5]``: all it leads to, not one value."""
    return any(match[1] for match in _ELEMENTS.finditer(name))


def array_of(name: str) -> tuple[str, str]:
    """Return the part of a path up to its last ``[*]`` or ``[2..5]``, and the rest."""
    *_, last = (match for match in _ELEMENTS.finditer(name) if match[1])
    return name[: last.end()], name[last.end() :]


def canonical(file: File, root: int) -> str:
    """Return the canonical form of the expression that ends at a node."""
    first = first_below(file, root)
    texts: list[str] = []
    for node in file.nodes[first : root + 1]:
        texts.append(_text(node, [texts[k - first] for k in node.args]))
        for k in node.args:
            texts[k - first] = ""  # each is used once: what is printed can go
    return texts[-1]


def first_below(file: File, root: int) -> int:
    """Return the first node of an expression: its operands are right before it."""
    while file.nodes[root].args:
        root = file.nodes[root].args[0]
    return root


def number_text(value: float) -> str:
    """Return the shortest text that gives this number again: ``100``, ``0.5``, ``1e-07``."""
    return repr(float(value)).removesuffix(".0")


def duration_text(ns: int) -> str:
    """Return a duration in the canonical form."""
    return f"{ns}ns" if ns % 10**6 else f"{ns // 10**6}ms"


def _text(node: SyntaxNode, args: list[str]) -> str:
    if node.op in OPERATORS:
        return f"({args[0]} {OPERATORS[node.op]} {args[1]})"
    if node.op in PREFIXES:
        return f"({PREFIXES[node.op]}{args[0]})"
    if node.op == "number":
        return number_text(float(node.text)) + (f" {node.unit}" if node.unit else "")
    if node.op in ("truth", "name"):
        return node.text.upper() if node.op == "truth" else node.text
    if node.options is not None:
        args = _list_arguments(node.options, args)
    if node.window:
        args = [*args, duration_text(node.window)]
    if node.coverage is not None:
        args = [*args, f"COVERAGE {number_text(node.coverage)}"]
    return f"{word_of(node.op)}({', '.join(args)})"


def _list_arguments(options: ReductionOptions, args: list[str]) -> list[str]:
    texts = args[:1]
    if options.sector is not None:
        ends = [f"{number_text(end.value)} {end.unit}" for end in options.sector]
        texts.append(f"SECTOR {' .. '.join(ends)}")
    if options.length is not None:
        texts.append(f"LENGTH {' .. '.join(str(n) for n in dict.fromkeys(options.length))}")
    if options.within:
        texts.append(f"WITHIN {args[1]} .. {args[2]}")
    return texts

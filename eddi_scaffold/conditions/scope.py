"""What names mean in a text of events, and the types that follow from their use."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from graphlib import TopologicalSorter

from eddi_scaffold.common.graphs import cycles, reached
from eddi_scaffold.common.problems import Place, did_you_mean
from eddi_scaffold.common.units import converted, dimension, words
from eddi_scaffold.conditions.syntax import (
    REDUCTIONS,
    EventDeclaration,
    File,
    Identifier,
    NumberWithUnit,
    SyntaxNode,
    VarDeclaration,
)
from eddi_scaffold.conditions.tokens import TextFindings, unit_hint
from eddi_scaffold.program.instructions import SIGNATURES
from eddi_scaffold.program.lists import TRUTHS, Reduction


@dataclass(frozen=True)
class Type:
    """NUMBER, BOOL, or an ENUM."""

    kind: str  # `number`, `bool` or `enum`, as in the program, or `text`
    enum: str = ""  # name of the ENUM

    def __str__(self) -> str:
        return self.enum or {"number": "a number", "bool": "a boolean"}.get(self.kind, "a text")


NUMBER, BOOL, TEXT = Type("number"), Type("bool"), Type("text")
_TYPES = {"NUMBER": NUMBER, "BOOL": BOOL, "TEXT": TEXT}


@dataclass(frozen=True)
class Variable:
    """What is known of an input."""

    name: str  # as in the text
    type: Type | None = None  # `None`: inferred from its use
    unit: str | None = None  # `None` for none
    range: tuple[float, float] | None = None  # least and greatest value
    timeout: int | None = None  # nanoseconds after which a sample is UNKNOWN; `None` for never
    infinite: bool = False  # infinity is a value (range sensors report "no return" by it)
    # the definition of the message says so; nobody accepts it in place of a measurement
    defined: bool = False
    declared: bool = True  # by a VAR or by the caller
    # names of the numbers between which its finite values are measurements
    within: tuple[str, str] | None = None
    reduction: Reduction | None = None  # how it is made of lists
    parts: tuple[Variable, ...] = ()  # what it is made of
    advice: str = ""  # how to say its type, where that is not for a VAR


@dataclass
class Scope:
    """The one name space of a text."""

    closed: bool  # every variable is declared; another name is an error
    enums: dict[str, tuple[str, ...]] = field(default_factory=dict)
    # literal -> its ENUM and number
    literals: dict[str, tuple[str, int]] = field(default_factory=dict)
    variables: dict[str, Variable] = field(default_factory=dict)
    constants: dict[str, NumberWithUnit] = field(default_factory=dict)
    # what lists of messages are reduced to, by canonical text
    reductions: dict[str, Variable] = field(default_factory=dict)
    # by name; that of a bare expression is empty
    events: dict[str, EventDeclaration] = field(default_factory=dict)
    # events, those that others use first; members of a cycle are omitted
    order: list[EventDeclaration] = field(default_factory=list)

    @property
    def names(self) -> list[str]:
        """Every name that has a meaning."""
        return [*self.variables, *self.constants, *self.literals, *filter(None, self.events)]

    def knows(self, name: str) -> bool:
        """Return whether a name has a meaning."""
        return any(
            name in of for of in (self.variables, self.constants, self.literals, self.events)
        )

    def type_of(self, name: str) -> Type | None:
        """Return the type of a name, ``None`` when it is not known."""
        if name in self.variables:
            return self.variables[name].type
        if name in self.literals:
            return Type("enum", self.literals[name][0])
        if name in self.constants:
            return NUMBER
        return BOOL if self.knows(name) else None


def build_scope(
    file: File, findings: TextFindings, known: Mapping[str, Variable] | None, outer: File | None
) -> Scope:
    """Collect the names of a text.

    Variables are inferred where the caller knows none; problems in the declarations from elsewhere
    (``outer``) are reported there.
    """
    scope = Scope(closed=known is not None or bool(file.variables))
    if outer is not None:
        _collect(outer, scope, TextFindings(lambda _: Place()))
    _collect(file, scope, findings)
    scope.variables = scope.variables | {
        name: variable for name, variable in (known or {}).items() if name not in scope.variables
    }
    texts = {name: {of.text for of in file.nodes_of(event)} for name, event in scope.events.items()}
    uses = {name: sorted(used & (scope.events.keys() - {""})) for name, used in texts.items()}
    in_a_cycle: set[str] = set()
    while circles := cycles(uses):
        for first, *others in circles:
            ring = " uses ".join([first, *reversed(others), first])
            findings.add("E008.uses_itself", scope.events[first].at, listed=ring)
            in_a_cycle |= {first, *others}
        uses |= {name: [] for name in in_a_cycle}
    order = TopologicalSorter(uses).static_order()
    scope.order = [scope.events[name] for name in order if name not in in_a_cycle]
    return scope


def _collect(file: File, scope: Scope, findings: TextFindings) -> None:
    seen = {*scope.names, *scope.enums}

    def is_new(declaration: Identifier) -> bool:
        is_new = declaration.name not in seen
        if not is_new:
            findings.add("E008.two_meanings", declaration.at, name=declaration.name)
        seen.add(declaration.name)
        return is_new

    for enum in filter(is_new, file.enums):
        scope.enums[enum.name] = tuple(literal.name for literal in enum.literals)
        for number, literal in enumerate(enum.literals):
            if is_new(literal):
                scope.literals[literal.name] = enum.name, number
    for constant in filter(is_new, file.constants):
        scope.constants[constant.name] = constant.value
    for declared in filter(is_new, file.variables):
        scope.variables[declared.name] = _variable(declared, scope, findings)
    for event in file.events:
        if event.anonymous or is_new(event):
            scope.events["" if event.anonymous else event.name] = event


def _variable(declared: VarDeclaration, scope: Scope, findings: TextFindings) -> Variable:
    word, unit = declared.type.name, declared.unit
    type_ = _TYPES.get(word.upper()) or (Type("enum", word) if word in scope.enums else None)
    if type_ is None:
        known = [*_TYPES, *scope.enums]
        hint = did_you_mean(word, known) or f"types: {', '.join(known)}"
        findings.add("E008.unknown_type", declared.type.at, hint=hint, word=word)
    variable = Variable(declared.name, type_, infinite=declared.infinite)
    if type_ not in (None, NUMBER) and (unit or declared.range):
        findings.add("E007.unit_of_other", (unit or declared.type).at, word=word)
        return variable
    if unit is not None and unit.name not in words():
        findings.add("E009.unknown", unit.at, hint=unit_hint(unit.name), unit=unit.name)
        unit = None
    if declared.timeout is None:
        findings.add("W003.variable", declared.at, declared=declared.name)
    unit_name = unit.name if unit is not None else ""
    range_ = None if declared.range is None else _range(declared.range, unit_name, findings)
    return replace(variable, unit=unit_name or None, timeout=declared.timeout, range=range_)


def _range(
    bounds: tuple[NumberWithUnit, NumberWithUnit], unit: str, findings: TextFindings
) -> tuple[float, float] | None:
    for bound in bounds:
        if bound.unit is not None and (not unit or dimension(bound.unit) != dimension(unit)):
            findings.add("E009.bound", bound.at, unit=bound.unit, other=unit or "none")
            return None
    low, high = (
        bound.value if bound.unit is None else converted(bound.value, bound.unit, unit)
        for bound in bounds
    )
    if math.isfinite(low) and math.isfinite(high) and low <= high:
        return low, high
    if low > high:
        findings.add("E007.range", bounds[0].at)
    else:
        findings.add("E013.bounds", bounds[0].at, unit=unit)
    return None


_KINDS = {"number": NUMBER, "bool": BOOL}
_NUMBERS = (NUMBER, NUMBER, NUMBER)
_FUNCTIONS = {
    "hypot": (_NUMBERS[:2], NUMBER),
    "clamp": (_NUMBERS, NUMBER),
    "number_of": ((TEXT,), NUMBER),
}
"""What the text has and the program has not."""


def arguments_of(op: str) -> tuple[Type, ...]:
    """Return the types of the arguments of an operation; the limits of a list are the last two."""
    if op in REDUCTIONS.values():
        return (BOOL if op in TRUTHS else NUMBER, NUMBER, NUMBER)
    if op in _FUNCTIONS:
        return _FUNCTIONS[op][0]
    return tuple(_KINDS[kind] for kind in SIGNATURES[op][0]) if op in SIGNATURES else ()


def result_of(op: str) -> Type:
    """Return the type of an operation's value."""
    if op in REDUCTIONS.values():
        return BOOL if op in ("list_any", "list_all") else NUMBER
    return _FUNCTIONS[op][1] if op in _FUNCTIONS else _KINDS[SIGNATURES[op][1]]


def infer_types(file: File, scope: Scope) -> None:
    """Give a type to each undeclared variable whose use determines one; the others stay without.

    The operand of AND is a boolean, that of + or < a number, one side of == is of the type of the
    other. The first use decides; whether the others agree is checked later.
    """
    if scope.closed:
        return
    texts = (node.text for node in file.nodes if node.op == "name" and not scope.knows(node.text))
    names = dict.fromkeys(texts)
    compared: dict[str, list[str]] = {name: [] for name in names}  # names of one type
    uses: list[tuple[SyntaxNode, Type | None]] = []
    for node in file.nodes:
        operands = [file.nodes[k] for k in node.args]
        if node.op in ("eq", "ne"):
            for operand, other in (operands, reversed(operands)):
                if other.op != "name":
                    type_ = {"number": NUMBER, "truth": BOOL}.get(other.op)
                    uses.append((operand, type_ or result_of(other.op)))
                elif other.text not in names:
                    uses.append((operand, scope.type_of(other.text)))
                elif operand.op == "name" and operand.text in names:
                    compared[operand.text].append(other.text)
        elif node.op not in ("known", "age"):
            uses += zip(operands, arguments_of(node.op), strict=False)
    uses += [(file.nodes[event.root], BOOL) for event in file.events if not event.anonymous]
    types: dict[str, Type] = {}
    for node, type_ in uses:
        is_open = node.op == "name" and node.text in names and node.text not in types
        if is_open and type_ is not None:
            types |= dict.fromkeys(reached(compared, [node.text]), type_)
    for name in names:
        scope.variables[name] = Variable(name, types.get(name), declared=False)

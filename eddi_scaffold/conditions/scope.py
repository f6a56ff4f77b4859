"""What names mean in a text of events."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from graphlib import CycleError, TopologicalSorter
from typing import Any

from eddi_scaffold.common.problems import Place, did_you_mean
from eddi_scaffold.common.units import converted, dimension, words
from eddi_scaffold.conditions.findings import TextFindings
from eddi_scaffold.conditions.syntax import (
    EnumDeclaration,
    EventDeclaration,
    File,
    Identifier,
    NumberWithUnit,
    VarDeclaration,
)


@dataclass(frozen=True)
class Type:
    """NUMBER, BOOL, or an ENUM.

    Attributes:
        kind: ``number``, ``bool`` or ``enum``, as in the intermediate form, or ``text``.
        enum: name of the ENUM.
    """

    kind: str
    enum: str = ""

    def __str__(self) -> str:
        return self.enum or {"number": "a number", "bool": "a boolean"}.get(self.kind, "a text")


NUMBER, BOOL, TEXT = Type("number"), Type("bool"), Type("text")


@dataclass(frozen=True)
class Variable:
    """What is known of an input.

    Attributes:
        name: as in the text.
        type: ``None``: inferred from its use.
        unit: ``None`` for none.
        range: least and greatest value.
        timeout: nanoseconds after which a sample is UNKNOWN; ``None`` for never.
        infinite: infinity is a value (range sensors report "no return" by it).
        defined: the definition of the message says so; nobody accepts it in place of a measurement.
        declared: by a VAR or by the caller.
        within: names of the numbers between which its finite values are measurements.
        reduction: how it is made of lists, as in the intermediate form.
        parts: what it is made of.
        advice: how to say its type, where that is not for a VAR.
    """

    name: str
    type: Type | None = None
    unit: str | None = None
    range: tuple[float, float] | None = None
    timeout: int | None = None
    infinite: bool = False
    defined: bool = False
    declared: bool = True
    within: tuple[str, str] | None = None
    reduction: Mapping[str, Any] | None = None
    parts: tuple[Variable, ...] = ()
    advice: str = ""


@dataclass
class Scope:
    """The one name space of a text.

    Attributes:
        closed: every variable is declared; another name is an error.
        reductions: what lists of messages are reduced to, by canonical text.
        order: events, those that others use first; members of a cycle are left out.
    """

    closed: bool
    enums: dict[str, tuple[str, ...]] = field(default_factory=dict)
    literals: dict[str, tuple[str, int]] = field(default_factory=dict)
    variables: dict[str, Variable] = field(default_factory=dict)
    constants: dict[str, NumberWithUnit] = field(default_factory=dict)
    reductions: dict[str, Variable] = field(default_factory=dict)
    events: dict[str, EventDeclaration] = field(default_factory=dict)
    order: list[EventDeclaration] = field(default_factory=list)

    @property
    def names(self) -> list[str]:
        """Every name that has a meaning; a bare expression has none."""
        events = [name for name, event in self.events.items() if not event.anonymous]
        return [*self.variables, *self.constants, *self.literals, *events]

    def knows(self, name: str) -> bool:
        """Return whether a name has a meaning; a bare expression has no name."""
        if name in self.events:
            return not self.events[name].anonymous
        return name in self.variables or name in self.constants or name in self.literals

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
    file: File, findings: TextFindings, given: Mapping[str, Variable] | None, outer: File | None
) -> Scope:
    """Collect the names of a text.

    Args:
        file: the text.
        findings: gets E008, E009, W003.
        given: variables that the caller knows; ``None``: variables may be inferred.
        outer: declarations from elsewhere; problems in them are reported there.
    """
    scope = Scope(closed=given is not None or bool(file.variables))
    quiet = TextFindings("", lambda _: Place())
    for source, sink in ((outer, quiet), (file, findings)):
        if source is not None:
            _collect(source, scope, sink)
    for name, variable in (given or {}).items():
        scope.variables.setdefault(name, variable)
    scope.order = _in_order(file, scope, findings)
    return scope


def _collect(file: File, scope: Scope, findings: TextFindings) -> None:
    seen = set(scope.names) | set(scope.enums)

    def new(named: Identifier) -> bool:
        if named.name in seen:
            findings.add("E008.two_meanings", named.at, name=named.name)
            return False
        seen.add(named.name)
        return True

    for enum in file.enums:
        if new(enum):
            scope.enums[enum.name] = tuple(literal.name for literal in enum.literals)
            _add_literals(enum, scope, new)
    for constant in file.constants:
        if new(constant):
            scope.constants[constant.name] = constant.value
    for declared in file.variables:
        if new(declared):
            scope.variables[declared.name] = _variable(declared, scope, findings)
    for event in file.events:
        if event.anonymous or new(event):
            scope.events[event.name] = event


def _add_literals(enum: EnumDeclaration, scope: Scope, new: Callable[[Identifier], bool]) -> None:
    for number, literal in enumerate(enum.literals):
        if new(literal):
            scope.literals[literal.name] = enum.name, number


def _variable(declared: VarDeclaration, scope: Scope, findings: TextFindings) -> Variable:
    word = declared.type.name
    type_ = {"NUMBER": NUMBER, "BOOL": BOOL, "TEXT": TEXT}.get(word.upper())
    if type_ is None and word in scope.enums:
        type_ = Type("enum", word)
    if type_ is None:
        known = ["NUMBER", "BOOL", "TEXT", *scope.enums]
        hint = did_you_mean(word, known) or f"types: {', '.join(known)}"
        findings.add("E008.unknown_type", declared.type.at, hint=hint, word=word)
    found = Variable(declared.name, type_, infinite=declared.infinite)
    if type_ is not None and type_ != NUMBER and (declared.unit or declared.range):
        at = (declared.unit or declared.type).at
        findings.add("E007.unit_of_other", at, word=word)
        return found
    found = replace(found, unit=_unit(declared, findings), timeout=_timeout(declared))
    if declared.timeout is None and declared.rate is None:
        findings.add("W003.variable", declared.at, declared=declared.name)
    return replace(found, range=_range(declared, found.unit, findings))


def _unit(declared: VarDeclaration, findings: TextFindings) -> str | None:
    unit = declared.unit
    if unit is not None and unit.name not in words():
        hint = did_you_mean(unit.name, words()) or f"units: {', '.join(sorted(words()))}"
        findings.add("E009.unknown", unit.at, hint=hint, unit=unit.name)
        return None
    return None if unit is None else unit.name


def _timeout(declared: VarDeclaration) -> int | None:
    if declared.timeout is not None or declared.rate is None:
        return declared.timeout
    return max(1, round(2.5e9 / declared.rate))


def _range(
    declared: VarDeclaration, unit: str | None, findings: TextFindings
) -> tuple[float, float] | None:
    if declared.range is None:
        return None
    ends = []
    for bound in declared.range:
        if bound.unit is None:
            ends.append(bound.value)
        elif unit is None or dimension(bound.unit) != dimension(unit):
            findings.add("E009.bound", bound.at, unit=bound.unit, other=unit or "none")
            return None
        else:
            ends.append(converted(bound.value, bound.unit, unit))
    if not all(map(math.isfinite, ends)):
        findings.add("E013.bounds", declared.range[0].at, unit=unit)
        return None
    if ends[0] > ends[1]:
        findings.add("E007.range", declared.range[0].at)
        return None
    return ends[0], ends[1]


def _in_order(file: File, scope: Scope, findings: TextFindings) -> list[EventDeclaration]:
    """Return the events of a text, those that others use first; without those of a cycle."""
    events = {event.name: event for event in scope.events.values()}
    uses: dict[str, list[str]] = {}
    for name, event in events.items():
        nodes = file.nodes[event.first : event.root + 1]
        used = (node.text for node in nodes if node.op == "name")
        uses[name] = sorted({one for one in used if one in events and not events[one].anonymous})
    while True:
        try:
            order = list(TopologicalSorter(uses).static_order())
        except CycleError as cycle:
            members: Sequence[str] = cycle.args[1][:0:-1]
            first = min(members, key=lambda name: events[name].at)
            turn = members.index(first)
            listed = [*members[turn:], *members[:turn], first]
            findings.add("E008.uses_itself", events[first].at, listed=" uses ".join(listed))
            for name in members:
                uses[name] = []
                events[name] = replace(events[name], root=-1)
            continue
        return [events[name] for name in order if events[name].root >= 0]

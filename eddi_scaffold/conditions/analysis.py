"""From a text to checked events and their intermediate form."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from eddi_scaffold.common.problems import (
    EddiError,
    Problem,
    has_errors,
    in_order,
    problem,
    with_excerpts,
)
from eddi_scaffold.conditions.alignment import Value
from eddi_scaffold.conditions.checker import Checker
from eddi_scaffold.conditions.findings import (
    EXPRESSION,
    Locate,
    TextFindings,
    in_text,
    line_and_column,
)
from eddi_scaffold.conditions.form_builder import GraphBuilder
from eddi_scaffold.conditions.parser import parse
from eddi_scaffold.conditions.scope import TEXT, Scope, Variable, build_scope
from eddi_scaffold.conditions.syntax import EventDeclaration, File, canonical
from eddi_scaffold.conditions.type_inference import infer_types

MAX_RATE = 1e9


@dataclass(frozen=True)
class Event:
    """One checked event.

    Attributes:
        id: its name; ``event`` for a bare expression.
        polarity: ``EVIDENCE`` or ``HAZARD``.
        type: ``bool``, or ``number`` for a bare numeric expression.
        canonical: its expression in canonical form.
        unit: of a number, ``None`` for none.
        at: offset of its name.
    """

    id: str
    polarity: str
    type: str
    canonical: str
    at: int
    unit: str | None


@dataclass(frozen=True)
class Analysis:
    """What is known of a text; the form is all that decides.

    Attributes:
        problems: everything that is wrong with it, in order, with source lines.
        events: in the order of the text; those with an error are left out.
        variables: those that are used, in the order of the form.
        enums: ENUM -> literals.
        form: the intermediate form (``eddi_scaffold.program.builder``); ``None`` after
            an error.
        text: what was analysed.
    """

    problems: tuple[Problem, ...] = field(compare=False)
    events: tuple[Event, ...] = field(compare=False)
    variables: tuple[Variable, ...] = field(compare=False)
    enums: Mapping[str, tuple[str, ...]] = field(compare=False)
    form: dict[str, Any] | None
    text: str = field(compare=False)

    @property
    def inputs(self) -> tuple[Variable, ...]:
        """What a host gives: variables, and in the place of reductions what they are made of."""
        parts = (part for variable in self.variables for part in (variable.parts or (variable,)))
        return tuple({part.name: part for part in parts}.values())


def analyse(
    text: str,
    *,
    rate: float | None = None,
    variables: Mapping[str, Variable] | None = None,
    declarations: str = "",
    name: str = EXPRESSION,
    locate: Locate | None = None,
    any_rate: bool = False,
    only: str | None = None,
) -> Analysis:
    """Check a text of events and make its intermediate form.

    Args:
        text: declarations and events, or one expression.
        rate: steps per second; windows need it.
        variables: what the names are, by path; ``None``: by VAR, or else by their use.
        declarations: ENUM, VAR and CONST that are declared and checked elsewhere.
        name: of the file, for the places of problems.
        locate: offset -> place, for a text inside of another file.
        any_rate: the rate is given later: what only it decides is not checked, and the form is
            good for nothing.
        only: the one event that is wanted; of the others, those that it uses are checked.

    Raises:
        EddiError: the rate is not a positive number up to 1e9 (E005).
    """
    findings = TextFindings(text, locate or in_text(text, name))
    builder = GraphBuilder(1 if any_rate else period_of(rate))
    file = parse(text, findings)
    if not file.events and not findings.problems:
        findings.add("E026.no_event", 0)
    file = file if only is None else file.reduced_to(only)
    outer = parse(declarations, TextFindings("", in_text(declarations))) if declarations else None
    scope = build_scope(file, findings, variables, outer)
    syntax_errors = has_errors(findings.problems)
    if not syntax_errors:
        infer_types(file, scope)
    checker = Checker(file, scope, findings, builder, line_and_column(text), any_rate=any_rate)
    values = {event.name: checker.event(event) for event in scope.order}
    wanted = [event for event in file.events if only in (None, event.name)]
    declared = [event for event in wanted if values.get(event.name) is not None]
    _warn(file, declared, values, findings, builder)
    problems = in_order(findings.problems)
    if locate is None:
        problems = with_excerpts(problems, text)
    used = tuple(scope.variables.get(n) or scope.reductions[n] for n in checker.used)
    form = None
    if not has_errors(problems):
        rows = [_variable_row(variable, scope) for variable in used]
        form = builder.document(rows, [_output(event, values) for event in declared])
    events = tuple(_event(event, values, file) for event in declared)
    return Analysis(tuple(problems), events, used, dict(scope.enums), form, text)


def period_of(rate: float | None) -> int:
    """Return the nanoseconds between two steps, 0 for no rate.

    Raises:
        EddiError: the rate is not a positive number up to 1e9 (E005).
    """
    if rate is None:
        return 0
    if not (math.isfinite(rate) and 1e-6 <= rate <= MAX_RATE):
        raise EddiError(problem("E005.rate_range", rate=rate))
    return round(1e9 / rate)


def _warn(
    file: File,
    declared: list[EventDeclaration],
    values: Mapping[str, Value | None],
    findings: TextFindings,
    builder: GraphBuilder,
) -> None:
    for event in declared:
        value = values[event.name]
        if value is not None and builder.is_constant(value.node):
            at = file.nodes[event.root].start
            findings.add("W004.constant", at)
        if event.polarity == "HAZARD" and file.nodes[event.root].op == "implies":
            findings.add("W002.implies", file.nodes[event.root].at, event=event.name)
        if event.polarity is None and not event.anonymous:
            findings.add("W002.polarity", event.at, event=event.name)


def _output(event: EventDeclaration, values: Mapping[str, Value | None]) -> dict[str, Any]:
    value = values[event.name]
    assert value is not None
    return {"id": event.name, "node": value.node, "polarity": event.polarity or "EVIDENCE"}


def _event(event: EventDeclaration, values: Mapping[str, Value | None], file: File) -> Event:
    value = values[event.name]
    assert value is not None
    text = canonical(file, event.root)
    polarity = event.polarity or "EVIDENCE"
    return Event(event.name, polarity, value.type.kind, text, event.at, value.unit)


def _variable_row(variable: Variable, scope: Scope) -> dict[str, Any]:
    assert variable.type is not None
    is_text = variable.type == TEXT
    row: dict[str, Any] = {"name": variable.name, "type": variable.type.kind}
    if is_text:
        row |= {"type": "number", "text": True}
    if variable.reduction is not None:
        row["reduction"] = dict(variable.reduction)
    if variable.range is not None:
        row["range"] = list(variable.range)
    if variable.timeout is not None:
        row["timeout"] = variable.timeout
    if variable.infinite:
        row["infinite"] = True
    if variable.infinite and variable.defined:
        row["defined"] = True
    if variable.type.enum:
        row["literals"] = list(scope.enums[variable.type.enum])
    return row

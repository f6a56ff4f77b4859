"""From a text to checked events and their program."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from eddi_scaffold.common.problems import (
    EddiError,
    Problem,
    has_errors,
    in_order,
    problem,
    with_excerpts,
)
from eddi_scaffold.conditions.checker import Checker
from eddi_scaffold.conditions.graph import GraphBuilder
from eddi_scaffold.conditions.parser import parse
from eddi_scaffold.conditions.scope import (
    NUMBER,
    TEXT,
    Scope,
    Type,
    Variable,
    build_scope,
    infer_types,
)
from eddi_scaffold.conditions.syntax import canonical
from eddi_scaffold.conditions.tokens import (
    EXPRESSION,
    Locate,
    TextFindings,
    in_text,
)
from eddi_scaffold.program.instructions import Program, Read, Result


@dataclass(frozen=True)
class Event:
    """One checked event."""

    id: str  # its name; `event` for a bare expression
    polarity: str  # `EVIDENCE` or `HAZARD`
    type: str  # `bool`, or `number` for a bare numeric expression
    canonical: str  # its expression in canonical form
    at: int  # offset of its name
    unit: str | None  # of a number, `None` for none


@dataclass(frozen=True)
class Analysis:
    """What is known of a text; the program is all that decides."""

    # everything that is wrong with it, in order, with source lines
    problems: tuple[Problem, ...] = field(compare=False)
    # in the order of the text; those with an error are omitted
    events: tuple[Event, ...] = field(compare=False)
    # those that are used, in the order of the program
    variables: tuple[Variable, ...] = field(compare=False)
    enums: Mapping[str, tuple[str, ...]] = field(compare=False)  # ENUM -> literals
    program: Program | None  # what computes the events; `None` after an error
    text: str = field(compare=False)  # what was analysed

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
    """Check a text of events and make its program.

    Args:
        text: declarations and events, or one expression.
        rate: steps per second; windows need it.
        variables: what the names are, by path; ``None``: by VAR, or else by their use.
        declarations: ENUM, VAR and CONST that are declared and checked elsewhere.
        name: of the file, for the places of problems.
        locate: offset -> place, for a text inside of another file.
        any_rate: the rate is set later: what only it decides is not checked, and the program
            is good for nothing.
        only: the one event that is needed; of the others, those that it uses are checked.

    Raises:
        EddiError: the rate is not a positive number up to 1e9 (E005).
    """
    if rate is not None and not 1e-6 <= rate <= 1e9:
        raise EddiError(problem("E005.rate_range", rate=rate))
    findings = TextFindings(locate or in_text(text, name))
    builder = GraphBuilder(1 if any_rate else round(1e9 / rate) if rate is not None else 0)
    file = parse(text, findings)
    if not file.events and not findings.problems:
        findings.add("E026.no_event", 0)
    file = file if only is None else file.reduced_to(only)
    outer = parse(declarations) if declarations else None
    scope = build_scope(file, findings, variables, outer)
    if not has_errors(findings.problems):
        infer_types(file, scope)
    checker = Checker(file, scope, findings, builder, text, any_rate=any_rate)
    values = {event.name: checker.event(event) for event in scope.order}
    events, results = [], []
    for event in file.events:
        value = values.get(event.name) if only in (None, event.name) else None
        if value is not None:
            root, polarity = file.nodes[event.root], event.polarity or "EVIDENCE"
            if builder.is_constant(value.node):
                findings.add("W004.constant", root.start)
            if polarity == "HAZARD" and root.op == "implies":
                findings.add("W002.implies", root.at, event=event.name)
            if event.polarity is None and not event.anonymous:
                findings.add("W002.polarity", event.at, event=event.name)
            expression = canonical(file, event.root)
            kind = value.type.kind
            events.append(Event(event.name, polarity, kind, expression, event.at, value.unit))
            results.append(Result(event.name, value.node, polarity == "HAZARD"))
    problems = in_order(findings.problems)
    if locate is None:
        problems = with_excerpts(problems, text)
    used = tuple(scope.variables.get(n) or scope.reductions[n] for n in builder.used)
    program = None
    if not has_errors(problems):
        program = builder.program([_read(variable, scope) for variable in used], results)
    return Analysis(tuple(problems), tuple(events), used, dict(scope.enums), program, text)


def _read(variable: Variable, scope: Scope) -> Read:
    type_ = variable.type
    assert type_ is not None
    return Read(
        variable.name,
        NUMBER.kind if type_ == TEXT else type_.kind,
        None if variable.range is None else (float(variable.range[0]), float(variable.range[1])),
        variable.timeout,
        infinite=variable.infinite,
        literals=scope.enums[type_.enum] if type_.enum else (),
        text=type_ == TEXT,
        reduction=variable.reduction,
        defined=variable.infinite and variable.defined,
    )


ExpressionType = Literal["bool", "float", "int", "state"]


@dataclass(frozen=True)
class ExpressionText:
    """One expression as written in a configuration."""

    text: str  # the expression
    locate: Locate  # offset in it -> place in the configuration
    state: str | None = None  # of the input that it decides, for type `state`
    event: str | None = None  # which event of the text it is, where that is a file of events


@dataclass(frozen=True)
class CompiledExpression:
    """A checked expression of an input."""

    document: Mapping[str, Any]  # for `eddi_scaffold.program`: the programs, and what they give
    names: tuple[str, ...]  # variables, in order and once each
    requires: tuple[str, ...]  # first words of the variables: SimulatorOutputs, or other inputs
    canonical: tuple[str, ...]  # the expression in canonical form; several for a state
    unit: str | None  # of a number, `None` for none


def compile_input(
    texts: Sequence[ExpressionText],
    type_: ExpressionType,
    *,
    rate: float | None,
    variables: Mapping[str, Variable] | None,
    declarations: str = "",
    polarity: Literal["EVIDENCE", "HAZARD"] = "EVIDENCE",
) -> tuple[CompiledExpression | None, list[Problem]]:
    """Check the expression of an input and make what its package holds.

    ``texts`` are one, or one for each state; ``rate``, ``variables`` and ``declarations`` as for
    ``analyse``. The expression is ``None`` after an error; problems are in the configuration.
    """
    problems: list[Problem] = []
    analyses: list[Analysis] = []
    expected = "bool" if type_ in ("bool", "state") else "number"
    for text in texts:
        analysis = analyse(
            text.text,
            rate=rate,
            variables=variables,
            declarations=declarations,
            locate=text.locate,
            only=text.event,
        )
        problems += analysis.problems
        analyses.append(analysis)
        if analysis.program is None:
            continue
        if len(analysis.events) != 1:
            problems.append(problem("E001.several_events", text.locate(0)))
        elif (actual := analysis.events[0].type) != expected:
            place = text.locate(0 if text.event is None else analysis.events[0].at)
            types = {"expected": Type(expected), "actual": Type(actual)}
            problems.append(problem("E007.input_type", place, hint=None, **types))
    if has_errors(problems):
        return None, problems
    parts = [
        {"program": analysis.program, **({"state": text.state} if text.state else {})}
        for analysis, text in zip(analyses, texts, strict=True)
    ]
    names = dict.fromkeys(entry.name for analysis in analyses for entry in analysis.inputs)
    expression = CompiledExpression(
        {"type": type_, "polarity": polarity, "parts": parts},
        tuple(names),
        tuple(dict.fromkeys(name.split(".")[0].split("[")[0] for name in names)),
        tuple(analysis.events[0].canonical for analysis in analyses),
        analyses[0].events[0].unit,
    )
    return expression, problems

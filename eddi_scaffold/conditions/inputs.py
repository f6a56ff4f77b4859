"""Expressions of EDDI inputs: checked here, compiled by ``eddi_scaffold.program``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from eddi_scaffold.common.problems import Problem, has_errors, problem
from eddi_scaffold.conditions.analysis import Analysis, analyse
from eddi_scaffold.conditions.scope import Type, Variable
from eddi_scaffold.conditions.tokens import Locate

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

    Args:
        texts: one, or one for each state.
        type_: of the input.
        rate: steps per second of the monitor.
        variables: by path (``motor.temps[1]``); ``None``: types follow from the use.
        declarations: ENUM, VAR and CONST that are declared with the inputs.
        polarity: what UNKNOWN means for a ``bool``.

    Returns:
        The expression, ``None`` after an error, and all problems, with places in the configuration.
    """
    problems: list[Problem] = []
    analyses: list[Analysis] = []
    for text in texts:
        analysis = analyse(
            text.text,
            rate=rate,
            variables=variables,
            declarations=declarations,
            locate=text.locate,
            only=text.event,
        )
        problems += [*analysis.problems, *_wrong_type(analysis, text, type_)]
        analyses.append(analysis)
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


def _wrong_type(
    analysis: Analysis, text: ExpressionText, type_: ExpressionType
) -> Sequence[Problem]:
    """Return an error when the expression gives another type than the input has."""
    if analysis.program is None:
        return ()
    if len(analysis.events) != 1:
        return (problem("E001.several_events", text.locate(0)),)
    event, expected = analysis.events[0], "bool" if type_ in ("bool", "state") else "number"
    if event.type == expected:
        return ()
    place = text.locate(0 if text.event is None else event.at)
    return (problem("E007.input_type", place, expected=Type(expected), actual=Type(event.type)),)

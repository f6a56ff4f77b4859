"""Files of events as models."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from eddi_scaffold.common.claims import Use
from eddi_scaffold.common.escaping import markdown_code, markdown_text
from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import EddiError, Place, Problem, has_errors, problem
from eddi_scaffold.common.units import accepted
from eddi_scaffold.conditions.analysis import Analysis, analyse
from eddi_scaffold.conditions.findings import Locate, line_and_column
from eddi_scaffold.conditions.report import cost_line
from eddi_scaffold.conditions.scope import Variable
from eddi_scaffold.conditions.syntax import is_list_path
from eddi_scaffold.conditions.uses import uses
from eddi_scaffold.kinds import InputType, ModelInput, Options, ReadResult, Skeleton, TypedModel

NAME = "event"
DEFAULT_RATE = 10.0
"""Steps per second where no configuration gives another number."""
_VARIABLE = re.compile(r"VAR\s+(\w+)")
_TYPES: Mapping[str, InputType] = {"number": "float", "bool": "bool"}
_LISTS: Mapping[str, InputType] = {"number": "float[]", "bool": "bool[]"}


@dataclass(frozen=True)
class Placed:
    """Where the lines of a text stand in an EDDI.

    Attributes:
        lines: tag and place of each line.
        place: of them all.
    """

    lines: tuple[tuple[str, Place], ...]
    place: Place

    def locate(self, text: str) -> Locate:
        """Return offset -> place of the value, with the column in its text."""
        of = line_and_column(text)

        def place(offset: int) -> Place:
            line, column = of(offset)
            if line > len(self.lines):
                return self.place
            tag, at = self.lines[line - 1]
            return replace(at, col=max(1, column - len(tag) - 1))

        return place

    def told(self, problem: Problem) -> Problem:
        """Return a problem as it is told: XML has no columns, so the text names the one."""
        tag = next((tag for tag, at in self.lines if at.path == problem.place.path), None)
        if tag is None or problem.place.col is None:
            return problem
        message = f"{tag}, column {problem.place.col}: {problem.message}"
        return replace(problem, message=message, place=replace(problem.place, col=None))


@dataclass(frozen=True)
class Events:
    """A file of events.

    Attributes:
        text: of the file.
        analysis: of the text, at the rate if it is known already.
        rate: steps per second.
        placed: where the lines stand, ``None`` in a file of events.
    """

    text: str
    analysis: Analysis
    rate: float
    placed: Placed | None = None


EventModel = TypedModel[Events, None]
"""A file of events; the configuration's rate goes into the events themselves."""


def read_file(source: Source, _marks: Sequence[str] = ()) -> ReadResult:
    """Read a file of events; what depends on the rate is checked by ``configure``."""
    try:
        text = source.text("E001")
    except EddiError as refused:
        return ReadResult((), refused.problems)
    data, problems = read_text(text, source.name)
    if data is None:
        return ReadResult((), tuple(problems))
    model = EventModel(NAME, source.stem, data, source, Place(source.name, 1, 1))
    return ReadResult((model,), tuple(problems))


def read_text(
    text: str, name: str, placed: Placed | None = None, rate: float | None = None
) -> tuple[Events | None, list[Problem]]:
    """Read a text of events.

    Args:
        text: the declarations.
        name: of the file.
        placed: where they stand in an EDDI.
        rate: steps per second without a configuration.
    """
    locate = placed.locate(text) if placed is not None else None
    analysis = analyse(text, any_rate=True, name=name, locate=locate)
    place = placed.place if placed is not None else Place(name, 1, 1)
    numbers = (
        problem("E007.event_number", place) for event in analysis.events if event.type != "bool"
    )
    problems = [*analysis.problems, *numbers]
    problems = [placed.told(problem) for problem in problems] if placed is not None else problems
    events = Events(text, analysis, DEFAULT_RATE if rate is None else rate, placed)
    return None if has_errors(problems) else events, problems


def configure(model: EventModel, options: Options) -> tuple[EventModel | None, list[Problem]]:
    """Bring the events to the frequency of the configuration."""
    events = model.data
    rate = events.rate if options.frequency is None else options.frequency
    placed = events.placed
    locate = placed.locate(events.text) if placed is not None else None
    try:
        analysis = analyse(events.text, rate=rate, name=model.source.name, locate=locate)
    except EddiError as failure:
        return None, list(failure.problems)
    if analysis.form is None:
        errors = [problem for problem in analysis.problems if problem.level == "error"]
        return None, [placed.told(error) if placed is not None else error for error in errors]
    configured = replace(model, data=replace(events, analysis=analysis, rate=rate))
    return configured, [] if options.frequency is None else list(
        _one_topic(model, analysis, options.parts)
    )


def inputs(model: EventModel) -> Sequence[ModelInput]:
    """Return one input for each variable, in the order of their first use."""
    uses = uses_of(form_of(model))
    inputs = model.data.analysis.inputs
    return [_input(variable, uses.get(variable.name, ())) for variable in inputs]


def skeleton(model: EventModel, options: Options) -> Skeleton:
    """Return the inputs, each with the comment at its declaration: a person wrote what it is."""
    configured, problems = configure(model, options)
    if configured is None:
        raise EddiError(*problems)
    told = dict(_commented(model.data.text))
    limits = {
        input_.name: input_.timeout / 1e9
        for input_ in configured.data.analysis.inputs
        if input_.timeout
    }
    return Skeleton(
        [
            replace(input_, description=told.get(input_.id), timeout=limits.get(input_.id))
            for input_ in inputs(configured)
        ]
    )


def _commented(text: str) -> Iterator[tuple[str, str]]:
    """Yield the name of each VAR, with the comments above and behind it."""
    above: list[str] = []
    for line in text.splitlines():
        code, _, comment = (part.strip() for part in line.partition("//"))
        declaration = _VARIABLE.match(code)
        if declaration is not None:
            yield declaration[1], " ".join([*above, comment])
        above = [*above, comment] if comment and not code else []


def counts(model: EventModel) -> Mapping[str, int]:
    """Return how many events and variables there are."""
    analysis = model.data.analysis
    return {"events": len(analysis.events), "variables": len(analysis.inputs)}


def outline(model: EventModel) -> Sequence[str]:
    """Return the events in canonical form, each above its line of the file."""
    return [
        f"event {event.id} ({event.polarity}): {event.canonical}"
        for event in model.data.analysis.events
    ]


def export(model: EventModel) -> Mapping[str, str]:
    """Return the file itself: it is the format of events."""
    return {f"{model.name}.events": model.data.text}


def readme(model: EventModel) -> Sequence[str]:
    """Return the events, their rate and what they cost, for the package's README."""
    events = model.data
    lines = ["| event | UNKNOWN counts as | condition |", "|---|---|---|"]
    for event in events.analysis.events:
        counts_as = "active" if event.polarity == "HAZARD" else "not active"
        lines.append(
            f"| {markdown_text(event.id)} | {counts_as} | `{markdown_code(event.canonical)}` |"
        )
    return [*lines, "", f"{events.rate:g} steps a second; {cost_line(form_of(model))}."]


def _one_topic(
    model: EventModel, analysis: Analysis, parts: Sequence[str | None]
) -> Iterable[Problem]:
    """Warn where the latest message of a topic may be that of another event."""
    if len(analysis.events) > 1 and None in parts:
        place = model.place
        if model.data.placed is None:  # a file: the second event, the first is no mistake
            line, column = line_and_column(model.data.text)(analysis.events[1].at)
            place = replace(place, line=line, col=column)
        yield problem("W005", place, events=len(analysis.events))


def parts(model: EventModel) -> Sequence[str]:
    """Return the ids of the events, each of which is a message of its own."""
    return [event.id for event in model.data.analysis.events]


def _input(variable: Variable, uses: tuple[Use, ...]) -> ModelInput:
    types = _LISTS if is_list_path(variable.name) else _TYPES
    is_number = variable.type is not None and variable.type.kind == "number"
    covered = None
    if variable.range is not None:
        low, high = variable.range
        covered = f"known in [{low:g}, {high:g}] {variable.unit or ''}".rstrip()
    return ModelInput(
        variable.name,
        types.get(variable.type.kind if variable.type else "number", "str"),
        unit=variable.unit or ("" if is_number else None),
        units=accepted(variable.unit) if is_number else None,
        covered=covered,
        uses=uses,
    )


def uses_of(form: Mapping[str, Any]) -> Mapping[str, tuple[Use, ...]]:
    """Return for each variable how it can bring an event nearer to what it claims.

    An EVIDENCE claims that it is true, a HAZARD that it is not.
    """
    uses_of_variable: dict[str, tuple[Use, ...]] = {}
    for output in form["outputs"]:
        is_evidence = output["polarity"] == "EVIDENCE"
        for name, more in uses(form, output["node"], wanted=is_evidence).items():
            uses_of_variable[name] = (*uses_of_variable.get(name, ()), *more)
    return uses_of_variable


def form_of(model: EventModel) -> Mapping[str, Any]:
    """Return the conditions of configured events."""
    form = model.data.analysis.form
    assert form is not None
    return form

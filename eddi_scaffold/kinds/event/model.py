"""Files of events as models."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from eddi_scaffold.escaping import markdown_code, markdown_text
from eddi_scaffold.kinds import InputType, ModelInput, Options, Reading, TypedModel
from eddi_scaffold.kinds.event.claims import uses_of
from eddi_scaffold.language.analysis import Analysis, analyse
from eddi_scaffold.language.report import cost_line
from eddi_scaffold.language.scope import Variable
from eddi_scaffold.language.syntax import is_list_path
from eddi_scaffold.language.uses import accepted as silences
from eddi_scaffold.problems import EddiError, Place, Problem, error, has_errors, warning
from eddi_scaffold.source import Source
from eddi_scaffold.units import accepted

NAME = "event"
DEFAULT_RATE = 10.0
"""Steps per second where no configuration gives another number."""
_TYPES: Mapping[str, InputType] = {"number": "float", "bool": "bool"}
_LISTS: Mapping[str, InputType] = {"number": "float[]", "bool": "bool[]"}


@dataclass(frozen=True)
class Events:
    """A file of events.

    Attributes:
        text: of the file.
        analysis: of the text, at the rate if it is known already.
        rate: steps per second.
    """

    text: str
    analysis: Analysis
    rate: float


EventModel = TypedModel[Events, None]
"""A file of events; the configuration's rate goes into the events themselves."""


def read_file(source: Source, _marks: Sequence[str] = ()) -> Reading:
    """Read a file of events; what depends on the rate is checked by ``configure``."""
    try:
        text = source.text("E001")
    except EddiError as refused:
        return Reading((), refused.problems)
    analysis = analyse(text, any_rate=True, name=source.name)
    problems = [*analysis.problems, *_numbers(analysis, source)]
    if has_errors(problems):
        return Reading((), tuple(problems))
    data = Events(text, analysis, DEFAULT_RATE)
    model = EventModel(NAME, source.stem, data, source, Place(source.name, 1, 1))
    return Reading((model,), tuple(problems))


def configure(model: EventModel, options: Options) -> tuple[EventModel | None, list[Problem]]:
    """Bring the events to the frequency of the configuration."""
    events = model.data
    rate = DEFAULT_RATE if options.frequency is None else options.frequency
    try:
        analysis = analyse(events.text, rate=rate, name=model.source.name)
    except EddiError as failure:
        return None, list(failure.problems)
    if analysis.form is None:
        return None, [problem for problem in analysis.problems if problem.level == "error"]
    configured = replace(model, data=replace(events, analysis=analysis, rate=rate))
    return configured, [] if options.frequency is None else list(
        _one_topic(model, analysis, options.parts)
    )


def inputs(model: EventModel) -> Sequence[ModelInput]:
    """Return one input for each variable, in the order of their first use."""
    analysis = model.data.analysis
    assert analysis.form is not None
    uses = uses_of(analysis.form)
    return [
        ModelInput(
            variable.name,
            _input_type(variable),
            unit=variable.unit or ("" if _is_number(variable.type) else None),
            units=_units(variable),
            covered=_covered(variable.range, variable.unit),
            uses=uses.get(variable.name, ()),
        )
        for variable in analysis.inputs
    ]


def model_part(model: EventModel) -> dict[str, Any]:
    """Return the ``model`` part of ``config/model.json``."""
    form = model.data.analysis.form
    assert form is not None
    words = {
        output["id"]: list(dict.fromkeys(one.word for one in silences(form, output["node"])))
        for output in form["outputs"]
    }
    accepts = {id_: found for id_, found in words.items() if found}
    return {"form": form, "accepts": accepts} if accepts else {"form": form}


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
    return {f"{model.source.stem}.events": model.data.text}


def readme(model: EventModel) -> Sequence[str]:
    """Return the events, their rate and what they cost, for the package's README."""
    events = model.data
    lines = ["| event | UNKNOWN counts as | condition |", "|---|---|---|"]
    for event in events.analysis.events:
        counts_as = "active" if event.polarity == "HAZARD" else "not active"
        lines.append(
            f"| {markdown_text(event.id)} | {counts_as} | `{markdown_code(event.canonical)}` |"
        )
    assert events.analysis.form is not None
    return [*lines, "", f"{events.rate:g} steps a second; {cost_line(events.analysis.form)}."]


def _one_topic(
    model: EventModel, analysis: Analysis, parts: Sequence[str | None]
) -> Iterable[Problem]:
    """Warn where the latest message of a topic may be that of another event."""
    if len(analysis.events) > 1 and None in parts:
        shared = f"{len(analysis.events)} events share one topic"
        message = f"{shared}: the latest message may be from any of them"
        hint = "give each event a separate output: `event: ID` with `topic:`"
        yield warning("W005", message, model.place, hint)


def parts(model: EventModel) -> Sequence[str]:
    """Return the ids of the events, each of which is a message of its own."""
    return [event.id for event in model.data.analysis.events]


def _input_type(variable: Variable) -> InputType:
    kind = variable.type.kind if variable.type else "number"
    return (_LISTS if is_list_path(variable.name) else _TYPES).get(kind, "str")


def _units(variable: Variable) -> Mapping[str, tuple[int, int]] | None:
    """Return the units in which a value may be given: none for what has no unit."""
    return accepted(variable.unit) if _is_number(variable.type) else None


def _is_number(type_: Any) -> bool:
    return type_ is not None and type_.kind == "number"


def _covered(limits: tuple[float, float] | None, unit: str | None) -> str | None:
    if limits is None:
        return None
    return f"known in [{limits[0]:g}, {limits[1]:g}] {unit or ''}".rstrip()


def _numbers(analysis: Analysis, source: Source) -> Sequence[Problem]:
    """Return an error for a bare numeric expression: it is not an event."""
    return [
        error("E007", "an event is a boolean, this is a number", Place(source.name, 1, 1))
        for event in analysis.events
        if event.type != "bool"
    ]

"""A file of events as a model: what they rest on, what their messages mean, their text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar

from eddi_scaffold.common.claims import Acceptance, Claim, Element, Meaning, Meanings, held
from eddi_scaffold.common.escaping import markdown_code, markdown_text
from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.conditions.lags import Lag, lags
from eddi_scaffold.conditions.standalone import cost_line
from eddi_scaffold.conditions.uses import accepted, inputs_of
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.evidence.emitted import Emitted
from eddi_scaffold.kinds import Model, ModelDraft, ModelInput, Options, ReadResult
from eddi_scaffold.kinds.event.events import (
    DEFAULT_RATE,
    NAME,
    Events,
    analysed,
    as_eddi_map,
    commented,
    events_of_eddi,
    input_of,
    read_text,
    uses_of,
)
from eddi_scaffold.kinds.event.vectors import event_vectors
from eddi_scaffold.kinds.event.verify import verify
from eddi_scaffold.program import python_text as py
from eddi_scaffold.program.condition_step import ConditionStep
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.instructions import Program, Result
from eddi_scaffold.program.monitor_text import CompiledMonitor, Declaration, head_lines

FORMAT = 1


def _words(program: Program, root: int) -> tuple[str, ...]:
    """Return the words by which a condition accepts silence."""
    return tuple(dict.fromkeys(silence.key for silence in accepted(program, root)))


_VERDICT = Meaning(
    (1,),
    refused="the verdict is 1 when it is unknown",
    instead="`verdict == 2`, known to be true, or `verdict == 0`, known to be false",
    known=(0, 2),
)
_KNOWN = (("verdict", 0, 2),)
_SILENT: Mapping[str, tuple[object, ...]] = {"EVIDENCE": (False,), "HAZARD": (True,)}
_REFUSED = {
    "EVIDENCE": "`active` of the EVIDENCE {} is false also when it is unknown",
    "HAZARD": "`active` of the HAZARD {} is true also when it is unknown",
}
_INSTEAD = {
    "EVIDENCE": "`verdict == 0`, or a separate event with NOT",
    "HAZARD": "`from: NOT {field}`, known to be absent; `verdict == 2` is that it is there",
}


@dataclass(frozen=True)
class EventModel(Model):
    """A file of events; the configuration's rate goes into the events themselves."""

    kind: ClassVar[str] = NAME
    data: Events = field(kw_only=True)

    @classmethod
    def read_file(cls, source: Source, default_guarantees: Sequence[str] = ()) -> ReadResult:
        """Read a file of events; what depends on the rate is checked by ``configure``."""
        try:
            text = source.text("E001")
        except EddiError as refused:
            return ReadResult((), refused.problems)
        data, problems = read_text(text, source.name)
        if data is None:
            return ReadResult((), tuple(problems))
        model = cls(source.stem, source, Place(source.name, 1, 1), data=data)
        return ReadResult((model,), tuple(problems))

    @classmethod
    def read_eddi(
        cls, document: EddiDocument, source: Source, default_guarantees: Sequence[str]
    ) -> ReadResult:
        files, problems = events_of_eddi(document, source)
        models = (cls(of.model or "", part, of.place, data=events) for of, part, events in files)
        return ReadResult(tuple(models), tuple(problems))

    @classmethod
    def meanings(cls, claims: Sequence[Claim] | None) -> Meanings:
        polarities = {claim.polarity for claim in claims or ()}
        verdict = replace(_VERDICT, bad=(2, 0)) if polarities == {"HAZARD"} else _VERDICT
        if claims is None:
            # It may have the polarity that the reader has in mind.
            active = Meaning((), known=_KNOWN)
        elif len(polarities) == 1:
            (polarity,) = polarities
            refused = _REFUSED[polarity].format(" ".join(claim.id for claim in claims))
            active = Meaning(_SILENT[polarity], refused=refused, instead=_INSTEAD[polarity])
        else:
            refused = "the value of `active` when it is unknown depends on the event"
            active = Meaning(refused=refused, instead="`verdict == 2`, or `verdict == 0`")
        return {"EventOutput": {"verdict": verdict, "active": active}}

    def counts(self) -> Mapping[str, int]:
        analysis = self.data.analysis
        return {"events": len(analysis.events), "variables": len(analysis.inputs)}

    def outline(self) -> Sequence[str]:
        """Return the events in canonical form, each above its line of the file."""
        return [
            f"event {event.id} ({event.polarity}): {event.canonical}"
            for event in self.data.analysis.events
        ]

    def write(self) -> Mapping[str, str]:
        if self.data.rate != DEFAULT_RATE:
            subject = f"the frequency {self.data.rate:g} of {self.name!r}"
            raise EddiError(problem("G004.unsaid", self.place, subject=subject, format="events"))
        return {f"{self.safe_name}.events": self.data.text}

    def as_eddi_map(self) -> tuple[str, Sequence[tuple[str, str]]]:
        place = replace(self.place, file=self.source.name)
        return as_eddi_map(self.name, self.data, place)

    def draft(self, options: Options) -> ModelDraft:
        """Return the inputs, each with the comment at its declaration: a person wrote it."""
        configured, problems = self.configure(options)
        if configured is None:
            raise EddiError(*problems)
        comments = dict(commented(self.data.text))
        limits = configured.input_timeouts()
        return ModelDraft(
            [
                replace(input_, description=comments.get(input_.id), timeout=limits.get(input_.id))
                for input_ in configured.inputs()
            ]
        )

    def configure(self, options: Options) -> tuple[EventModel | None, list[Problem]]:
        """Bring the events to the frequency of the configuration."""
        events = self.data
        rate = events.rate if options.frequency is None else options.frequency
        try:
            analysis = analysed(events.text, self.source.name, events.placed, rate)
        except EddiError as failure:
            return None, list(failure.problems)
        if analysis.program is None:
            return None, [error for error in analysis.problems if error.level == "error"]
        configured = replace(self, data=replace(events, analysis=analysis, rate=rate))
        if options.frequency is None or None not in options.parts or len(analysis.events) < 2:
            return configured, []
        # the latest message of a topic may be that of another event
        return configured, [problem("W005", self.place, events=len(analysis.events))]

    def inputs(self) -> Sequence[ModelInput]:
        """Return an input for each variable, in the order of their first use."""
        uses = uses_of(self.program)
        variables = self.data.analysis.inputs
        return [input_of(variable, uses.get(variable.name, ())) for variable in variables]

    def separate_outputs(self) -> Sequence[str]:
        """Return the ids of the events, each of which is a message of its own."""
        return [event.id for event in self.data.analysis.events]

    def readme(self) -> Sequence[str]:
        """Return the events, their rate and what they cost."""
        lines = ["| event | UNKNOWN counts as | condition |", "|---|---|---|"]
        for event in self.data.analysis.events:
            counts_as = "active" if event.polarity == "HAZARD" else "not active"
            lines.append(
                f"| {markdown_text(event.id)} | {counts_as} | `{markdown_code(event.canonical)}` |"
            )
        return [*lines, "", f"{self.data.rate:g} steps a second; {cost_line(self.program)}."]

    def compile(self, declaration: Declaration) -> CompiledMonitor:
        step = ConditionStep(self.program, declaration.inputs, self._units())
        events = []
        for result, inputs in zip(self.program.results, step.needs(), strict=True):
            words = _words(self.program, result.operation)
            more = {"accepts": py.literal(words)} if words else {}
            row = [py.text_literal(result.id), str(result.hazard), py.literal(inputs)]
            events.append(py.call("event.Event", row, **more))
        head = head_lines("event.EventMonitor", declaration, {})
        tables = [*step.tables(), *py.assignment("events", py.tuple_of(events), 4)]
        return CompiledMonitor(FORMAT, [*head, *tables, *step.reductions(), *step.methods()])

    def _units(self) -> dict[str, str]:
        return {input_.id: input_.unit for input_ in self.inputs() if input_.unit}

    def vectors(self, inputs: Sequence[BoundInput], about: Mapping[str, str]) -> str:
        return event_vectors(self.program, inputs, about)

    def verify(self, emitted: Emitted) -> Iterator[str]:
        accepted = [_words(self.program, result.operation) for result in self.program.results]
        return verify(self.program, self._units(), accepted, emitted)

    def claims(self, inputs: Sequence[BoundInput], frequency: float) -> Sequence[Claim]:
        """Return the events, each with the variables that it rests on."""
        claims = []
        for result in self.program.results:
            polarity, lags_of = "HAZARD" if result.hazard else "EVIDENCE", self._lags(result)
            holds = held((name, lag.unknown) for name, lag in sorted(lags_of.items()))
            claims.append(Claim(result.id, frozenset(lags_of), polarity=polarity, holds=holds))
        return claims

    def _lags(self, result: Result) -> Mapping[str, Lag]:
        return lags(self.program, result.operation, -1 if result.hazard else 1)

    def lag(self, output: str, input_: str) -> float:
        result = next(result for result in self.program.results if result.id == output)
        return self._lags(result)[input_].value

    def acceptances(self, inputs: Sequence[BoundInput], frequency: float) -> Sequence[Acceptance]:
        """Return what the events of a file accept of silence, with the events that do."""
        events: dict[Acceptance, list[str]] = {}
        for result in self.program.results:
            for silence in accepted(self.program, result.operation):
                events.setdefault(silence, []).append(result.id)
        return [replace(silence, outputs=tuple(ids)) for silence, ids in events.items()]

    def input_timeouts(self) -> Mapping[str, float]:
        """Return the TIMEOUT of each variable that has one."""
        return {
            name: read.timeout / 1e9
            for read in self.program.reads
            if read.timeout is not None
            for name in inputs_of(read)
        }

    def elements(self) -> Sequence[Element]:
        """Return the events, in a file of their own with the line of each condition."""
        operations, in_eddi = self.program.operations, self.place.path is not None
        return [
            Element(
                "event", result.id, line=None if in_eddi else operations[result.operation].at[0]
            )
            for result in self.program.results
        ]

    @property
    def program(self) -> Program:
        """The conditions of configured events."""
        program = self.data.analysis.program
        assert program is not None
        return program

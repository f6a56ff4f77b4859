"""State machines as models: what is read, shown, claimed and accepted."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar

from eddi_scaffold import kinds
from eddi_scaffold.common.claims import Acceptance, Claim, Element, held
from eddi_scaffold.common.escaping import markdown_text
from eddi_scaffold.common.files import Source
from eddi_scaffold.common.graphs import reached
from eddi_scaffold.common.identifiers import TODO
from eddi_scaffold.common.problems import EddiError, Problem, has_errors, in_order
from eddi_scaffold.conditions.lags import lags
from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry, Tone
from eddi_scaffold.eddi_xml.document import EddiDocument, read_document
from eddi_scaffold.evidence.emitted import Emitted
from eddi_scaffold.kinds.state_machine import SUFFIX
from eddi_scaffold.kinds.state_machine.checks import check_machine, check_settings
from eddi_scaffold.kinds.state_machine.compile import actions_module, compile_machine
from eddi_scaffold.kinds.state_machine.machine import StateMachine, Transition
from eddi_scaffold.kinds.state_machine.options import Evidence, Settings, Value, read_settings
from eddi_scaffold.kinds.state_machine.read_eddi import read_machines
from eddi_scaffold.kinds.state_machine.vectors import state_machine_vectors
from eddi_scaffold.kinds.state_machine.verify import verify
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import CompiledMonitor, Declaration

_LEGEND = (
    LegendEntry("state", "rounded", "neutral"),
    LegendEntry("initial state", "rounded", "input"),
    LegendEntry("fail state", "rounded", "warning"),
)


@dataclass(frozen=True)
class StateMachineModel(kinds.Model):
    """A state machine; its settings come from a configuration, ``None`` without one."""

    kind: ClassVar[str] = "state_machine"
    data: StateMachine = field(kw_only=True)
    configured: Settings | None = field(default=None, kw_only=True)

    @classmethod
    def read_file(cls, source: Source, default_guarantees: Sequence[str]) -> kinds.ReadResult:
        """Read an EDDI of which only the state machine counts, as ``write`` gives it."""
        document, problems = read_document(source)
        if document is None:
            return kinds.ReadResult((), tuple(problems))
        result = cls.read_eddi(document, source, default_guarantees)
        return replace(result, problems=(*problems, *result.problems))

    @classmethod
    def read_eddi(
        cls, document: EddiDocument, source: Source, default_guarantees: Sequence[str]
    ) -> kinds.ReadResult:
        machines, problems = read_machines(document, source)
        chosen = [] if has_errors(problems) else machines
        models = tuple(cls(of.name, source, of.place, data=of) for of in chosen)
        return kinds.ReadResult(models, tuple(in_order(problems)))

    @cached_property
    def settings(self) -> Settings:
        """What a configuration chooses, by default what the machine says itself."""
        settings = self.configured or read_settings(self.data, kinds.Options())[1]
        return settings or Settings(tuple(Value() for _ in self.data.triggers))

    def check(self) -> Sequence[Problem]:
        return check_machine(self.data)

    def counts(self) -> Mapping[str, int]:
        of = self.data
        parts = {"states": of.states, "transitions": of.transitions, "triggers": of.triggers}
        return {key: len(part) for key, part in parts.items()} | {"actions": len([*of.actions()])}

    def outline(self) -> Sequence[str]:
        """Return the states with their transitions, what the triggers are, and what is claimed."""
        lines, settings = list[str](), self.settings
        for state in self.data.states:
            marks = ", ".join(["initial"] * state.is_initial + ["fail"] * state.is_fail)
            lines.append(f"{state.name} ({marks})" if marks else state.name)
            lines += [f"  {when}: {action.kind} {action.text}" for when, action in state.actions()]
            leaving = self.data.leaving[state.name]
            lines += [f"  -> {each.target}: {_condition(each)}" for each in leaving]
        for trigger, value in zip(self.data.triggers, settings.values, strict=True):
            words = [value.how, *(["persistent"] if trigger.is_persistent else [])]
            words += ["unknown counts as false"] if value.is_absent else []
            lines.append(f"trigger {trigger.text}: {', '.join(filter(None, words))}")
        claims = [f"evidence {evidence.id}: {evidence.text}" for evidence in settings.evidence]
        return [*lines, f"start {settings.start}", *claims]

    def write(self) -> Mapping[str, str]:
        """Return the EDDI itself, of which only the state machine counts in a file of this name."""
        suffix = ".json" if self.source.name.lower().endswith(".json") else ".xml"
        return {f"{self.safe_name}{SUFFIX}{suffix}": self.source.text("X001")}

    def diagram(self) -> Diagram:
        nodes = []
        for state in self.data.states:
            tone: Tone = "warning" if state.is_fail else "input" if state.is_initial else "neutral"
            actions = [f"{moment}: {action.text}" for moment, action in state.actions()]
            nodes.append(DiagramNode(state.name, (state.name, *actions), "rounded", tone))
        transitions = self.data.transitions
        edges = tuple(DiagramEdge(of.source, of.target, _condition(of)) for of in transitions)
        tones = {node.tone for node in nodes}
        legend = tuple(entry for entry in _LEGEND if entry.tone in tones)
        text = f"{len(nodes)} states, {len(edges)} transitions"
        title = f"State machine {self.data.name}"
        return Diagram(title, tuple(nodes), edges, "down", legend, text)

    def draft(self, options: kinds.Options) -> kinds.ModelDraft:
        """Return its inputs, and the start, which a person has to decide."""
        values = {key: of for key, of in options.values.items() if of != TODO}
        configured, problems = self.configure(replace(options, values=values))
        if configured is None:
            raise EddiError(*problems)
        note = "unknown, or initial where the system starts together with the monitor"
        return kinds.ModelDraft(configured.inputs(), {"start": TODO}, {("start",): note})

    def configure(self, options: kinds.Options) -> tuple[StateMachineModel | None, list[Problem]]:
        """Take the keys of ``Model:``: start, reset, triggers, observations and evidence."""
        machine, settings, problems = read_settings(self.data, options)
        if settings is None:
            return None, problems
        if options.frequency is not None:
            problems += check_settings(machine, settings, options.place())
        name = options.id or self.name
        return replace(self, data=machine, configured=settings, name=name), problems

    def inputs(self) -> Sequence[kinds.ModelInput]:
        return self.settings.inputs

    def element_keys(self) -> Mapping[str, Sequence[str]]:
        return {
            "in_state": [state.name for state in self.data.states],
            "evidence": [evidence.id for evidence in self.settings.evidence],
        }

    def editable_modules(self) -> Sequence[kinds.EditableModule]:
        """Return the module with a region for each function, nothing for a machine without one."""
        return actions_module(self.data)

    def readme(self) -> Sequence[str]:
        """Return the transitions in the order in which they count, and what is claimed."""
        ordered = [each for of in self.data.state for each in self.data.leaving[of]]
        rows = [(each.source, each.target, _condition(each)) for each in ordered]
        claims = [(evidence.id, evidence.text) for evidence in self.settings.evidence]
        lines = _table(("from", "to", "when"), *rows)
        heads = ("evidence", "active while each possible state is")
        return [*lines, "", *_table(heads, *claims)] if claims else lines

    def compile(self, declaration: Declaration) -> CompiledMonitor:
        return compile_machine(self.data, self.settings, declaration)

    def vectors(self, inputs: Sequence[BoundInput], about: Mapping[str, str]) -> str:
        return state_machine_vectors(self.data, self.settings, inputs, about)

    def verify(self, emitted: Emitted) -> Iterator[str]:
        return verify(self.data, self.settings, emitted)

    def claims(self, inputs: Sequence[BoundInput], frequency: float) -> Sequence[Claim]:
        """Return the evidence: any input may make another state possible."""
        rests_on = frozenset(input_.id for input_ in inputs)
        claims = []
        for evidence in self.settings.evidence:
            holds = held((id_, self._held_s(evidence, id_)) for id_ in sorted(rests_on))
            claims.append(Claim(evidence.id, rests_on, holds=holds))
        return claims

    def _held_s(self, evidence: Evidence, input_: str) -> float:
        """Return for how long evidence may hold after an input has become unknown.

        For ever, unless triggers that it alone decides lead out of each state of the evidence.
        """
        held_s, ways = 0.0, {state.name: list[str]() for state in self.data.states}
        values = dict(zip(self.data.triggers, self.settings.values, strict=True))
        for each in self.data.transitions:
            for value in (values[trigger] for trigger in each.triggers if each.after is None):
                if value.condition is None or value.is_absent:
                    continue
                lags_of = lags(value.condition, value.condition.results[0].operation, -1)
                if lags_of.keys() == {input_}:
                    held_s = max(held_s, lags_of[input_].unknown)
                    ways[each.source].append(each.target)
        ends = (reached(ways, [state]).issubset(evidence.states) for state in evidence.states)
        return math.inf if any(ends) else held_s

    def acceptances(self, inputs: Sequence[BoundInput], frequency: float) -> Sequence[Acceptance]:
        """Return the start, if it is assumed, and the triggers that may be unknown."""
        start = Acceptance("start: initial", "the initial state", path=("Model", "start"))
        absent = [
            Acceptance(
                "absent: true",
                f"that {trigger.text!r} is false",
                "while it is unknown",
                path=("Model", "triggers", trigger.text),
            )
            for trigger, value in zip(self.data.triggers, self.settings.values, strict=True)
            if value.is_absent
        ]
        return [start, *absent] if self.settings.start == "initial" else absent

    def elements(self) -> Sequence[Element]:
        """Return the states and transitions, then the evidence."""
        return [
            *(Element("state", s.name, None, s.place.line, s.place.path) for s in self.data.states),
            *(
                Element("transition", self.data.called[t], None, t.place.line, t.place.path)
                for t in self.data.transitions
            ),
            *(Element("evidence", evidence.id) for evidence in self.settings.evidence),
        ]


def _condition(transition: Transition) -> str:
    texts = " or ".join(trigger.text for trigger in transition.triggers)
    after = "" if transition.after is None else f"after {transition.after:g} s"
    return f"{texts}, {after}" if texts and after else texts or after or "never"


def _table(*rows: tuple[str, ...]) -> list[str]:
    lines = [f"| {' | '.join(map(markdown_text, row))} |" for row in rows]
    return [lines[0], "|---" * len(rows[0]) + "|", *lines[1:]]

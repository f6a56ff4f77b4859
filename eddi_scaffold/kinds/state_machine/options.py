"""What a configuration says of a state machine: start, reset, triggers, observations, evidence."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from eddi_scaffold.common import units
from eddi_scaffold.common.identifiers import attribute
from eddi_scaffold.common.problems import Place, Problem, SimilarNames, has_errors, problem
from eddi_scaffold.conditions.analysis import ExpressionText, analyse, compile_input
from eddi_scaffold.conditions.parser import parse
from eddi_scaffold.conditions.scope import BOOL, NUMBER, Variable
from eddi_scaffold.conditions.tokens import EXPRESSION, Locate, TextFindings, in_text
from eddi_scaffold.config.schema import USUAL_FREQUENCY
from eddi_scaffold.kinds import ModelInput
from eddi_scaffold.kinds.state_machine.machine import StateMachine, Transition, Trigger
from eddi_scaffold.program.gates import below, fault_of, program_of
from eddi_scaffold.program.instructions import Program

if TYPE_CHECKING:
    from eddi_scaffold.kinds import Options

FAIL_STATES = "fail_states"
_ID = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_TYPES = {"bool": BOOL, "float": NUMBER, "int": NUMBER}
_STARTS = ("initial", "unknown")


@dataclass(frozen=True)
class Evidence:
    """Something that is claimed of the states that are possible."""

    id: str
    states: tuple[str, ...]  # active while each possible state is one of these
    hold: float = 0.0  # seconds for which that must hold before
    text: str = field(default="", compare=False)  # for people
    place: Place = field(default=Place(), compare=False)


@dataclass(frozen=True)
class Value:
    """Where the value of a trigger comes from: a condition, an input of its own, or a state."""

    condition: Program | None = None
    input: str = ""  # each message of it counts, in one step
    is_absent: bool = False  # UNKNOWN counts as false
    how: str = field(default="", compare=False)  # for people

    @property
    def is_raised(self) -> bool:
        """Whether a state gives it."""
        return self.condition is None and not self.input


@dataclass(frozen=True)
class Settings:
    """What a configuration chooses, checked."""

    values: tuple[Value, ...]  # of the triggers of the machine, in their order
    start: str = "initial"  # or `unknown`
    reset: Value | None = None
    observe: Mapping[str, Program] = field(default_factory=dict)  # state -> condition
    evidence: tuple[Evidence, ...] = ()
    max_gap: float | None = None  # seconds
    rate: float = USUAL_FREQUENCY  # steps per second
    inputs: tuple[ModelInput, ...] = field(default=(), compare=False)


def input_id(text: str) -> str:
    """Return the id of the input that is made of a text."""
    return attribute(re.sub(r"[^A-Za-z0-9]+", "_", text).strip("_"))


def read_settings(
    machine: StateMachine, options: Options
) -> tuple[StateMachine, Settings | None, list[Problem]]:
    """Return a machine with the transitions that a configuration triggers, and its settings."""
    reader = _Reader(machine, options)
    settings = reader.settings()
    return reader.machine, None if has_errors(reader.problems) else settings, reader.problems


class _Reader:
    def __init__(self, machine: StateMachine, options: Options) -> None:
        self.machine, self.options, self.problems = machine, options, list[Problem]()
        self.data: Mapping[str, Any] = options.values
        self.rate = options.frequency or USUAL_FREQUENCY
        self.entries = {entry.id: entry for entry in options.inputs}
        self.variables = {
            entry.id: Variable(entry.id, _TYPES.get(entry.type or ""), unit=entry.unit)
            for entry in options.inputs
        }
        self.inputs: dict[str, ModelInput] = {}
        self.texts: dict[str, str] = {}  # input of its own -> the text that it is made of

    def report(
        self, case: str, /, *path: str | int, hint: str | None = None, **fields: object
    ) -> None:
        self.problems.append(problem(case, self.options.place(*path), hint=hint, **fields))

    def unknown(self, what: str, name: str, known: Sequence[str], *path: str | int) -> None:
        hint = SimilarNames(known, "there are").hint(name)
        self.report("P001.unknown", *path, hint=hint, what=what, name=name)

    def keys(self, entry: Iterable[str], known: Sequence[str], *path: str | int) -> None:
        for key in entry:
            if key not in known:
                self.unknown("key", key, known, *path, key)

    def section(self, key: str) -> Mapping[str, Any]:
        value = self.data.get(key)
        if value is None or isinstance(value, Mapping):
            return {str(name): of for name, of in (value or {}).items()}
        self.report("P001.value", key, key=key, expected="a map")
        return {}

    def settings(self) -> Settings:
        triggers = self.section("triggers")
        texts = {trigger.text: None for trigger in self.machine.triggers}
        for text in triggers:
            if text not in texts:
                self.unknown("trigger", text, [*texts], "triggers", text)
        bound = self.of_transitions()
        values = tuple(
            bound.get(trigger) or self.value(trigger, triggers) for trigger in self.machine.triggers
        )
        observe = {}
        for state, text in self.section("observe").items():
            if state not in self.machine.state:
                self.unknown("state", state, [*self.machine.state], "observe", state)
            elif condition := self.condition(text, "observe", state):
                observe[state] = condition
        reset, start = self.data.get("reset"), self.data.get("start")
        if start not in (None, *_STARTS):
            self.report("P001.value", "start", key="start", expected="initial or unknown")
        elif start is None and self.data.get("evidence"):
            self.report("P001.start", "evidence")
        return Settings(
            values,
            str(start or "initial"),
            None if reset is None else self.of_messages(reset, "reset"),
            observe,
            self.evidence(),
            self.duration(self.data.get("max_gap"), "max_gap"),
            self.rate,
            tuple(self.inputs.values()),
        )

    # -- values of triggers ------------------------------------------------------------------------

    def of_transitions(self) -> dict[Trigger, Value]:
        bound: dict[Trigger, Value] = {}
        called = {each.ends: each for each in self.machine.transitions}
        called |= {name: each for each, name in self.machine.called.items()}
        added: dict[Transition, Trigger] = {}
        for name, text in self.section("transitions").items():
            transition, path = called.get(name), ("transitions", name)
            if transition is None:
                self.unknown("transition", name, [*called], *path)
                continue
            trigger = added[transition] = Trigger(f"transition {name}")
            bound[trigger] = self.configured(text, trigger, *path)
        transitions = tuple(
            replace(each, triggers=(*each.triggers, added[each])) if each in added else each
            for each in self.machine.transitions
        )
        self.machine = replace(self.machine, transitions=transitions)
        return bound

    def value(self, trigger: Trigger, configured: Mapping[str, Any]) -> Value:
        """Return where the value of a trigger comes from: the first of the ways that there are."""
        text, machine = trigger.text, self.machine
        if text in configured:
            return self.configured(configured[text], trigger, "triggers", text)
        if trigger.is_opaque and self.options.inputs:
            self.report("P003.opaque", "triggers", trigger=text)
        if text in machine.causes:
            return self.of_cause(machine.causes[text], machine.resolved.get(text, ""))
        if text in machine.raised:
            return Value(how="an action of a state, in the step before")
        if not trigger.is_external and (condition := self.of_text(trigger)) is not None:
            return Value(condition, how="a condition")
        name, is_order = self.own(text, each=trigger.is_external), trigger.is_external
        program = None if is_order else program_of({}, name, {name: name}, self.rate)
        return Value(program, name if is_order else "", how=f"the input {name}")

    def configured(self, value: Any, trigger: Trigger, *path: str | int) -> Value:
        entry = value if isinstance(value, Mapping) else {"expression": value}
        self.keys(map(str, entry), ("expression", "absent"), *path)
        absent, text = entry.get("absent", False), entry.get("expression")
        if not isinstance(absent, bool):
            self.report("P001.value", *path, "absent", key="absent", expected="true or false")
        path = (*path, "expression") if isinstance(value, Mapping) else path
        if text is None:  # only that it may be absent
            of = self.value(trigger, {})
        elif trigger.is_external:
            of = self.of_messages(text, *path)
        else:
            of = Value(self.condition(text, *path), how=f"the condition {text}")
        return replace(of, is_absent=absent is True)

    def of_messages(self, text: Any, *path: str | int) -> Value:
        """Return the value of an order: of an input each message counts, else a condition."""
        if not isinstance(text, str) or text not in self.variables:
            return Value(self.condition(text, *path), how=f"the condition {text}")
        self.add(text, "bool", each=True)
        return Value(None, text, how=f"the input {text}")

    def of_cause(self, cause: str, how: str) -> Value:
        """Return the condition that a cause of a fault tree is, with an input for each event."""
        if fault := fault_of(self.machine.gates, cause):
            self.report("P003.gate", "triggers", cause=cause, fault=fault)
            return Value(how=how)
        gates = self.machine.gates
        inputs = {name: self.own(name) for name in below(gates, cause) if name not in gates}
        return Value(program_of(gates, cause, inputs, self.rate), how=how)

    def of_text(self, trigger: Trigger) -> Program | None:
        """Return the condition that a text is, where its every name is one of an input."""
        findings = TextFindings(in_text(trigger.text, EXPRESSION))
        file = parse(trigger.text, findings)
        nodes = [node for event in file.events for node in file.nodes_of(event)]
        names = {node.text for node in nodes if node.op == "name"}
        if has_errors(findings.problems) or not names or not names <= self.variables.keys():
            return None
        return self._compiled(trigger.text, lambda _: trigger.place)

    def own(self, text: str, *, each: bool = False) -> str:
        """Return the id of the boolean input that is made of a text."""
        name = input_id(text)
        other = self.texts.setdefault(name, text)
        if other != text:
            self.report("P003.same_input", first=other, second=text, name=name)
        self.add(name, "bool", each=each, description=text)
        return name

    def add(self, name: str, type_: Any, *, each: bool = False, description: str = "") -> None:
        entry = self.entries.get(name)
        if name in self.inputs and self.inputs[name].every_message != each:
            self.report("P003.messages", name=name)
        is_number, unit = type_ == "float", entry.unit if entry else None
        self.inputs.setdefault(
            name,
            ModelInput(
                name,
                "int" if is_number and entry and entry.type == "int" else type_,
                unit=unit or ("" if is_number else None),
                units=units.accepted(unit) if is_number else None,
                description=description or None,
                is_good=lambda _: True,  # any default may take a transition that is good
                every_message=each,
                is_three_valued=True,
            ),
        )

    def condition(self, text: Any, *path: str | int) -> Program | None:
        """Return the condition of a text in the configuration, ``None`` after an error."""
        if isinstance(text, str):
            return self._compiled(text, self.options.inside(*path))
        self.report("P001.value", *path, key=path[-1], expected="a condition, such as an input")
        return None

    def _compiled(self, text: str, locate: Locate) -> Program | None:
        known = {name: Variable(name, BOOL) for name in self.texts} | self.variables
        # what an entry does not say of its type follows from its first use
        by_use = {of.name: of.type for of in analyse(text, rate=self.rate).variables}
        known = {
            name: replace(of, type=of.type or by_use.get(name) or BOOL)
            for name, of in known.items()
        }
        texts = [ExpressionText(text, locate)]
        compiled, problems = compile_input(texts, "bool", rate=self.rate, variables=known)
        self.problems += [p for p in problems if p.case != "W002.polarity"]
        if compiled is None:
            return None
        program: Program = compiled.document["parts"][0]["program"]
        for read in program.reads:
            if read.reduction is not None or read.type not in ("bool", "number"):
                self.problems.append(problem("P003.list", locate(0), text=text))
                return None
            self.variables[read.name] = known[read.name]
            self.add(read.name, "bool" if read.type == "bool" else "float")
        return program

    # -- evidence ----------------------------------------------------------------------------------

    def evidence(self) -> tuple[Evidence, ...]:
        section = self.data.get("evidence") or []
        if not isinstance(section, list) or not all(isinstance(e, Mapping) for e in section):
            self.report("P001.value", "evidence", key="evidence", expected="a list of maps")
            return ()
        rows: dict[str, Evidence] = {}
        for number, entry in enumerate(section):
            path = ("evidence", number)
            self.keys(map(str, entry), ("id", "in", "not_in", "hold"), *path)
            name, lists = entry.get("id"), [key for key in ("in", "not_in") if key in entry]
            if not isinstance(name, str) or not _ID.fullmatch(name):
                expected = "a name such as NotFailed"
                self.report("P001.value", *path, "id", key="id", expected=expected)
            elif name in (*rows, *self.machine.state, "failed"):
                self.report("P001.taken", *path, "id", name=name)
            elif len(lists) != 1:
                self.report("P001.value", *path, key="evidence", expected="`in` or `not_in`")
            else:
                (key,) = lists
                states = self._states(entry[key], *path, key)
                inside = [s for s in self.machine.state if (s in states) == (key == "in")]
                hold = self.duration(entry.get("hold"), *path, "hold") or 0.0
                listed = entry[key] if isinstance(entry[key], str) else ", ".join(states)
                text = f"{key.replace('_', ' ')} {listed}" + (f" for {hold:g} s" if hold else "")
                place = self.options.place(*path, "id")
                rows[name] = Evidence(name, tuple(inside), hold, text, place)
        return tuple(rows.values())

    def _states(self, value: Any, *path: str | int) -> list[str]:
        if value == FAIL_STATES and value not in self.machine.state:
            return list(self.machine.fail)
        states = [*map(str, value if isinstance(value, list) else [value])]
        for state in states:
            if state not in self.machine.state:
                self.unknown("state", state, [*self.machine.state], *path)
        return states

    def duration(self, value: Any, *path: str | int) -> float | None:
        if value is None:
            return None
        with suppress(units.QuantityError):
            return units.seconds(value)
        self.report("P001.value", *path, key=path[-1], expected="a time such as 2 s, up to a year")
        return None

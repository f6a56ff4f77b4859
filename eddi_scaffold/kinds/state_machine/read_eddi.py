"""State machines from EDDI XML, with what their triggers mean in the same file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain, product

from eddi_scaffold.common import units
from eddi_scaffold.common.files import Source
from eddi_scaffold.common.identifiers import free_name
from eddi_scaffold.common.problems import Problem
from eddi_scaffold.eddi_xml import vocabulary as word
from eddi_scaffold.eddi_xml.document import EddiDocument, EddiFindings
from eddi_scaffold.eddi_xml.extensions import AFTER, PRIORITY
from eddi_scaffold.eddi_xml.parsing import Element, select
from eddi_scaffold.eddi_xml.vocabulary import Spelling, fold
from eddi_scaffold.kinds.state_machine.machine import (
    Action,
    State,
    StateMachine,
    Transition,
    Trigger,
)
from eddi_scaffold.program.gates import GATES, Gate

_K = ("k", "voteThreshold", "vote", "n")
_TEXTS = {
    "functionaction": ("function", word.FUNCTION),
    "warningaction": ("warning", word.WARNING),
    "messageaction": ("message", word.MESSAGE),
}
_ENDS = (word.FROM_STATES, word.TO_STATES)
_UNUSED = tuple(map(Spelling, ("prerequisites", "subActions", "triggeringEvents")))


def read_machines(
    document: EddiDocument, source: Source
) -> tuple[list[StateMachine], list[Problem]]:
    """Return the state machines of a document, in its order, but those that are chains."""
    reader = _Reader(document, source)
    return list(reader.machines()), reader.findings.problems()


class _Reader:
    def __init__(self, document: EddiDocument, source: Source) -> None:
        self.document, self.source, self.findings = document, source, EddiFindings(document)
        roots = document.roots
        models = dict.fromkeys(e for root in roots for e in select(root, word.CHAINS_AND_TREES))
        kinds = {model: document.kind_of(model) for model in models}
        self.elements = [model for model, kind in kinds.items() if kind == "state_machine"]
        self.systems: dict[Element, Element] = {}  # failure model -> the system that it is of
        for element in (e for root in roots for e in root.iter() if self.elements):
            for model in document.targets(element, word.FAILURE_MODELS)[0]:
                self.systems.setdefault(model, element)
        trees = [model for model, kind in kinds.items() if kind == "fault_tree"]
        self.tree_of = {c: tree for tree in trees for c in document.children(tree, word.CAUSES)}
        # what a text may mean, and by what: the warning of a cause, or a name
        self.warnings: dict[str, list[Element]] = {}
        self.named: dict[str, list[Element]] = {}
        for cause in self.tree_of:
            for action in self.actions(cause, word.ACTIONS):
                if action.is_event:
                    self.warnings.setdefault(action.text, []).append(cause)
            for element in (cause, *self.targets(cause, word.FAILURE)):
                self.named.setdefault(self.name_of(element, ""), []).append(cause)

    def machines(self) -> Iterator[StateMachine]:
        names: set[str] = set()
        for element in self.elements:
            name = free_name(self.name_of(element, self.source.stem), names, "#")
            names.add(name)
            yield self._machine(element, name)

    def name_of(self, element: Element, default: str) -> str:
        return (self.document.attribute(element, word.NAME) or default).strip()

    def text(self, element: Element, spelling: Spelling) -> str:
        return (self.document.attribute(element, spelling) or "").strip()

    def _is(self, element: Element, spelling: Spelling) -> bool:
        return self.text(element, spelling).lower() in ("true", "1")

    def targets(self, element: Element, spelling: Spelling) -> list[Element]:
        elements, problems, _ = self.document.targets(element, spelling)
        self.findings.add(*problems)
        return elements

    def actions(self, element: Element, spelling: Spelling) -> tuple[Action, ...]:
        """Return the actions that a feature refers to; others than the three kinds are counted."""
        actions = []
        for target in self.targets(element, spelling):
            owner = self.document.describe(target)
            kind, feature = _TEXTS.get(self.document.class_of(target).name, ("", word.NAME))
            if not kind:
                self.findings.count("X014.feature", target, feature=spelling.name, owner=owner)
                continue
            is_warning, priority = kind == "warning", self.text(target, word.PRIORITY_LEVEL)
            actions.append(
                Action(
                    kind,
                    self.text(target, feature) or self.name_of(target, kind),
                    self.text(target, word.WARNING_TYPE if is_warning else word.MESSAGE_TYPE),
                    self.text(target, word.SOURCE_ID),
                    int(priority) if priority.isdecimal() and len(priority) < 10 else 0,
                    self.document.place(target),
                )
            )
            for unused in _UNUSED:
                if self.text(target, unused) or self.document.children(target, unused):
                    self.findings.count("X014.feature", target, feature=unused.name, owner=owner)
        return tuple(dict.fromkeys(actions))  # each is due once

    def _machine(self, element: Element, name: str) -> StateMachine:
        states: dict[Element, State] = {}
        for i, state in enumerate(self.document.children(element, word.STATES)):
            states[state] = State(
                self.name_of(state, f"S{i}"),
                self._is(state, word.IS_INITIAL),
                self._is(state, word.IS_FAIL),
                self.actions(state, word.ON_ENTRY),
                self.actions(state, word.ON_EXIT),
                self.document.place(state),
            )
        transitions = self.document.children(element, word.TRANSITIONS)
        rows = [row for each in transitions for row in self._transitions(each, states)]
        place = self.document.place(element)
        machine = StateMachine(name, tuple(states.values()), tuple(rows), place=place)
        return self._resolved(element, machine)

    def _transitions(self, element: Element, states: dict[Element, State]) -> Iterator[Transition]:
        subject = self.document.describe(element)
        ends = [self.targets(element, spelling) for spelling in _ENDS]
        if not all(ends):  # what is stated and leads nowhere is told already
            if not all(self.text(element, spelling) for spelling in _ENDS):
                self.findings.report("X020.no_states", element, subject=subject)
        elif any(end not in states for end in chain(*ends)):
            self.findings.report("X020.other_model", element, subject=subject)
        else:
            events = self.targets(element, word.TRIGGERS)
            triggers = [trigger for event in events for trigger in self._triggers(event)]
            priority = self.findings.key_value(element, PRIORITY) or "0"
            if not priority.lstrip("-").isdecimal() or len(priority) > 9:
                self.findings.report("P002.priority", element, subject=subject, value=priority)
                priority = "0"
            after = self._after(element, subject)
            for source, target in product(*ends):
                yield Transition(
                    self.name_of(element, ""),
                    states[source].name,
                    states[target].name,
                    tuple(dict.fromkeys(triggers)),
                    int(priority),
                    after,
                    self.document.place(element),
                )

    def _after(self, element: Element, subject: str) -> float | None:
        text = self.findings.key_value(element, AFTER)
        if text is None:
            return None
        reason: object = "0 is no time to wait"
        try:
            if (after := units.seconds(text)) > 0.0:
                return after
        except units.QuantityError as fault:
            reason = fault
        self.findings.report("P002.after", element, subject=subject, reason=reason)
        return None

    def _triggers(self, event: Element) -> Iterator[Trigger]:
        class_name = self.document.class_of(event).name
        name, place = self.name_of(event, ""), self.document.place(event)
        is_external = class_name == "externalevent"
        is_opaque = class_name not in ("externalevent", "conditionevent", "event", "")
        is_condition = not (is_external or is_opaque)
        text = self.text(event, word.CONDITION) if is_condition else ""
        for part in (text or name).split(";") if is_condition else [name]:
            if part.strip():
                is_persistent = self._is(event, word.IS_PERSISTENT)
                yield Trigger(part.strip(), is_external, is_persistent, is_opaque, place)

    def _resolved(self, element: Element, machine: StateMachine) -> StateMachine:
        """Return a machine with the causes that the texts of its triggers mean."""
        builder = _Causes(self)
        causes, resolved = dict[str, str](), dict[str, str]()
        own = self.systems.get(element)
        for trigger in machine.triggers:
            if trigger.is_external or trigger.is_opaque:
                continue
            for how, known in (("the warning of", self.warnings), ("the cause", self.named)):
                candidates = known.get(trigger.text, [])
                own_first = [c for c in candidates if self.systems.get(self.tree_of[c]) == own]
                if candidates and trigger.text not in causes:
                    cause = (own_first or candidates)[0]
                    causes[trigger.text] = builder.add(cause)
                    resolved[trigger.text] = f"{how} {self.document.describe(cause)}"
        return replace(machine, causes=causes, gates=builder.gates, resolved=resolved)


class _Causes:
    """The causes that triggers are made of, by name."""

    def __init__(self, reader: _Reader) -> None:
        self.reader, self.document = reader, reader.document
        self.names: dict[Element, str] = {}
        self.gates: dict[str, Gate] = {}

    def add(self, top: Element) -> str:
        """Take over a cause and all below it; return its name."""
        below: dict[Element, list[Element]] = {}
        waiting = [top]
        while waiting:
            cause = waiting.pop()
            if cause not in below and cause not in self.names:
                inputs = self.reader.targets(cause, word.CAUSES)
                below[cause] = [c for c in inputs if c in self.reader.tree_of]
                waiting += reversed(below[cause])
        for cause, inputs in below.items():  # a basic event is its failure
            if not self._is_gate(cause, inputs):
                element = [*self.reader.targets(cause, word.FAILURE), cause][0]
                self.names[cause] = self.reader.name_of(element, f"cause {len(self.names)}")
        taken = {*self.names.values()}
        for cause in (cause for cause in below if cause not in self.names):
            name = self.reader.name_of(cause, f"cause {len(self.names)}")
            self.names[cause] = free_name(name, taken, "#")
            taken.add(self.names[cause])
        for cause, inputs in below.items():
            if self._is_gate(cause, inputs):
                self.gates[self.names[cause]] = self._gate(cause, inputs)
        return self.names[top]

    def _is_gate(self, cause: Element, inputs: list[Element]) -> bool:
        is_port = fold(self.reader.text(cause, word.CAUSE_TYPE)) in ("inputevent", "outputevent")
        return bool(inputs) or is_port or self.document.class_of(cause).name == "gate"

    def _gate(self, cause: Element, inputs: list[Element]) -> Gate:
        stated = self.reader.text(cause, word.TREE_GATE_TYPE).upper()
        values = (self.reader.findings.key_value(cause, key) for key in _K)
        text = next(filter(None, values), "")
        k = int(text) if stated == "VOTE" and text.isdecimal() and len(text) < 10 else None
        names = tuple(self.names[below] for below in inputs)
        return Gate(stated if stated in GATES else "OR", names, k, self.document.place(cause))

"""Fault trees and Markov chains from EDDI XML (failure logic package of the metamodel)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.identifiers import free_name
from eddi_scaffold.common.problems import Place, Problem
from eddi_scaffold.eddi_xml import vocabulary as word
from eddi_scaffold.eddi_xml.document import EddiDocument, EddiFindings
from eddi_scaffold.eddi_xml.parsing import Element, select
from eddi_scaffold.eddi_xml.vocabulary import CHAINS_AND_TREES, Spelling, fold
from eddi_scaffold.kinds.reliability import system
from eddi_scaffold.kinds.reliability.read_eddi_laws import CommonCauses, Laws

_EVENTS = ("basicevent", "normalevent")
_CAUSE_TYPES = ("InputEvent", "OutputEvent", "BasicEvent", "NormalEvent", "Gate")


def read_eddi(
    document: EddiDocument, source: Source
) -> tuple[list[system.ReliabilitySystem], list[Problem]]:
    """Return a system for every chain and every top event of a document, in its order."""
    reader = _Reader(document, source)
    return list(reader.systems()), reader.findings.problems()


class _Reader:
    def __init__(self, document: EddiDocument, source: Source) -> None:
        self.document, self.source, self.findings = document, source, EddiFindings(document)
        self.laws, self.common_causes = Laws(self.findings), CommonCauses(self.findings)
        self.names: dict[Element, str] = {}  # of chains and trees
        # also those of which only a state counts
        self.chains: dict[str, system.ComponentModel] = {}
        self.states: dict[Element, tuple[str, str]] = {}  # state -> its chain, its name there
        self.states_of: dict[Element, list[Element]] = {}  # failure -> the states that are it
        self.tree_of: dict[Element, Element] = {}  # cause -> its tree
        self.below: dict[Element, list[Element]] = {}  # cause -> those that it refers to

    def systems(self) -> Iterator[system.ReliabilitySystem]:
        elements = [e for root in self.document.roots for e in select(root, CHAINS_AND_TREES)]
        for element in elements:
            kind = self.document.kind_of(element)
            if kind in ("markov_chain", "fault_tree"):
                name = self.name_of(element, self.source.stem)
                self.names[element] = free_name(name, self.names.values(), "#")
                if self.names[element] != name:
                    self.findings.report("R013.same_name", element, name=name)
            if kind == "markov_chain":
                self._read_chain(element, self.names[element])
            elif kind == "fault_tree":
                causes = self.document.children(element, word.CAUSES)
                self.tree_of.update(dict.fromkeys(causes, element))
            elif kind == "state_machine":
                transitions = self.document.children(element, word.TRANSITIONS)
                rates = [t for t in transitions if self.document.has_rate(t)]
                if rates:  # it is no chain by its rates alone
                    fields: dict[str, Any] = {"rates": len(rates), "number": len(transitions)}
                    machine = self.document.describe(element)
                    self.findings.report("X014.no_chain", rates[0], machine=machine, **fields)
                self._warn_of_unused(element)
        self.below = {cause: self.targets_of(cause, word.CAUSES) for cause in self.tree_of}
        used = {b for cause, below in self.below.items() for b in below if b is not cause}
        for element, name in self.names.items():
            if name in self.chains:
                place = self.document.place(element)
                yield system.ReliabilitySystem({name: self.chains[name]}, name, place=place)
            else:
                yield from self._systems_of_tree(element, name, used)

    def targets_of(self, element: Element, spelling: Spelling) -> list[Element]:
        elements, problems, _ = self.document.targets(element, spelling)
        self.findings.add(*problems)
        return elements

    def failures_of(self, element: Element, spelling: Spelling) -> list[Element]:
        return self.findings.targets(element, spelling, word.FAILURES)

    def name_of(self, element: Element, default: str) -> str:
        return self.document.attribute(element, word.NAME) or default

    def _is(self, element: Element, spelling: Spelling) -> bool:
        return (self.document.attribute(element, spelling) or "").strip().lower() in ("true", "1")

    def _read_chain(self, element: Element, name: str) -> None:
        states: dict[Element, str] = {}
        for i, state in enumerate(self.document.children(element, word.STATES)):
            label = self.name_of(state, f"S{i}")
            states[state] = label if label not in states.values() else f"{label}#{i}"
        transitions = self.document.children(element, word.TRANSITIONS)
        arcs = [arc for transition in transitions for arc in self._arcs(transition, states)]
        initial, fail, fail_by_failures = [], [], []
        for state, label in states.items():
            self.states[state] = name, label
            older = self.failures_of(state, word.FAIL_STATE)
            failures = self.failures_of(state, word.FAILURES)
            for failure in [*older, *failures]:
                self.states_of.setdefault(failure, []).append(state)
            if older or self._is(state, word.IS_FAIL):
                fail.append(label)
            elif failures:
                fail_by_failures.append(label)
            initial += [label] if self._is(state, word.IS_INITIAL) else []
        self._warn_of_unused(element)
        ends = tuple(initial), tuple(fail or fail_by_failures)
        content = system.Chain(tuple(states.values()), *ends, tuple(arcs))
        place = self.document.place(element)
        self.chains[name] = system.ComponentModel(name, "markov", content, place=place)

    def _warn_of_unused(self, machine: Element) -> None:
        """Warn of what would change the probabilities of a chain, and is not used."""
        fields = {"machine": self.document.describe(machine)}
        states = self.document.children(machine, word.STATES)
        pairs = [(state, word.INITIAL_PROBABILITY) for state in states]
        for parent, feature in [*pairs, (machine, word.TRANSITION_MATRICES)]:
            for child in self.document.children(parent, feature):
                self.findings.count("X014.of_machine", child, feature=feature.name, **fields)

    def _arcs(self, transition: Element, states: Mapping[Element, str]) -> Iterator[system.Arc]:
        sources = self.targets_of(transition, word.FROM_STATES)
        targets = self.targets_of(transition, word.TO_STATES)
        subject = self.document.describe(transition)
        if not sources or not targets:
            self.findings.report("X020.no_states", transition, subject=subject)
            return
        if len(sources) * len(targets) > 1:
            self.findings.count("X020.joins", transition, subject=subject)
        rate = self.laws.of_transition(transition)
        for source, target in product(sources, targets):
            if source not in states or target not in states:
                self.findings.report("X020.other_model", transition, subject=subject)
            elif source is target:
                state = states[source]
                self.findings.report("X020.itself", transition, subject=subject, state=state)
            elif rate is not None:
                place = self.document.place(transition)
                yield system.Arc(states[source], states[target], rate, place)

    def chain_with(self, states: Sequence[Element]) -> str:
        """Return the chain that fails in these of its states: the chain itself, or another one."""
        name = self.states[states[0]][0]
        component, labels = self.chains[name], [self.states[state][1] for state in states]
        assert isinstance(component.content, system.Chain)
        fail = tuple(state for state in component.content.states if state in labels)
        if fail == component.content.fail:
            return name
        variant = f"{name}/{' or '.join(fail)}"
        content = replace(component.content, fail=fail)
        self.chains[variant] = replace(component, name=variant, content=content)
        return variant

    def _systems_of_tree(
        self, tree: Element, name: str, used: set[Element]
    ) -> Iterator[system.ReliabilitySystem]:
        causes = self.document.children(tree, word.CAUSES)
        free = [cause for cause in causes if cause not in used]
        stated, problems, is_stated = self.document.targets(tree, word.TOP_EVENT)
        self.findings.add(*problems)
        if is_stated and (len(stated) != 1 or stated[0] not in self.tree_of):
            if not problems:
                self.findings.report("X009.top_event", tree, tree=self.document.describe(tree))
            return
        outputs = []
        for cause in free:
            failures = self.failures_of(cause, word.FAILURE)
            origins = (self.document.attribute(f, word.ORIGIN_TYPE) or "" for f in failures)
            outputs += [cause] if "output" in map(fold, origins) else []
        tops = stated or outputs or [cause for cause in free if self.is_gate(cause)]
        # of a cycle alone: check names it
        tops = tops or ([] if free else causes[:1])
        for top in tops:
            full = name if len(tops) == 1 else f"{name}/{self.name_of(top, 'top0')}"
            content = _TreeReader(self, tree, top).tree()
            place = self.document.place(tree if len(tops) == 1 else top)
            component = system.ComponentModel(full, "fault_tree", content, place=place)
            chains = {use: self.chains[use] for use in component.below}
            yield system.ReliabilitySystem({**chains, full: component}, full, place=place)

    def is_gate(self, cause: Element) -> bool:
        return self.document.class_of(cause).name == "gate"


class _TreeReader:
    def __init__(self, reader: _Reader, element: Element, top: Element) -> None:
        self.reader, self.element, self.top = reader, element, top
        self.document, self.findings = reader.document, reader.findings
        self.ids: dict[Element, str] = {}
        self.events: dict[str, system.BasicEvent] = {}
        self.gates: dict[str, system.Gate] = {}
        self.failures: dict[Element, list[str]] = {}  # failure -> its events

    def tree(self) -> system.FaultTree:
        reached: dict[Element, None] = {}
        waiting = [self.top]
        while waiting:
            cause = waiting.pop()
            if cause not in reached:
                reached[cause] = None
                below = self.reader.below.get(cause, ())
                waiting += reversed([b for b in below if b in self.reader.tree_of])
        taken: set[str] = set()
        # its own name where that is unique, else its model's too
        for i, cause in enumerate(reached):
            name, owner = self.reader.name_of(cause, f"cause{i}"), self.reader.tree_of[cause]
            long = f"{self.reader.names[owner]}/{name}"
            candidates = [*([name] if owner is self.element else []), long, f"{long}#{i}"]
            self.ids[cause] = next(id_ for id_ in candidates if id_ not in taken)
            taken.add(self.ids[cause])
        for cause, id_ in self.ids.items():
            stated = self.document.attribute(cause, word.CAUSE_TYPE) or _CAUSE_TYPES[0]
            if fold(stated) not in map(fold, _CAUSE_TYPES):
                fields = {"value": stated, "cause_types": ", ".join(_CAUSE_TYPES)}
                subject = self.document.describe(cause)
                self.findings.report("X011.cause_type", cause, cause=subject, **fields)
            if fold(stated) not in _EVENTS or self.reader.is_gate(cause):  # a port, or a gate
                self.gates[id_] = self._gate(cause, id_)
            else:
                self.events[id_] = self._event(cause, id_)
        top = self._join_common_causes().get(self.ids[self.top], self.ids[self.top])
        laws, first = [event.law for event in self.events.values()], dict[Place, str]()
        for name in dict.fromkeys(law.model for law in laws if law and law.model):
            other = first.setdefault(self.reader.chains[name].place, name)
            if other != name:  # two states of one chain are not independent
                fields = {"subject": self.document.describe(self.element), "first": other}
                self.findings.report("R009.one_chain", self.element, **fields, second=name)
        return system.FaultTree(top, self.events, self.gates)

    def _gate(self, cause: Element, id_: str) -> system.Gate:
        below = []
        for target in self.reader.below.get(cause, []):
            if target in self.ids:
                below.append(self.ids[target])
            else:
                self.findings.report("X009.cause", cause, name=self.document.describe(target))
        subject = self.document.describe(cause)
        stated = (self.document.attribute(cause, word.TREE_GATE_TYPE) or "OR").strip()
        is_port = stated.upper() in ("INPUTEVENT", "OUTPUTEVENT")
        is_port = is_port or not (below or self.reader.is_gate(cause))
        kind = stated.upper() if stated.upper() in system.GATES else "OR"
        if kind != stated.upper() and not is_port:
            self.findings.report("X011.gate_type", cause, subject=subject, value=stated)
        if is_port and not below:
            self.findings.count("X014.no_input", cause, subject=subject)
        text = self.findings.key_value(cause, "k") or "" if kind == "VOTE" else ""
        k = int(text) if text.isdecimal() and len(text) < 10 else None
        return system.Gate(id_, kind, tuple(below), k, self.document.place(cause), is_port)

    def _event(self, cause: Element, id_: str) -> system.BasicEvent:
        place, subject = self.document.place(cause), self.document.describe(cause)
        failures = self.reader.failures_of(cause, word.FAILURE)
        if len(failures) > 1:
            self.findings.report("X011.failures", cause, cause=subject, number=len(failures))
        states = self.reader.targets_of(cause, word.STATE)
        others = [state for state in states if state not in self.reader.states]
        if others or len(states) > 1:
            state = self.document.describe([*others, *states][0])
            self.findings.report("X009.state_of_chain", cause, cause=subject, subject=state)
            return system.BasicEvent(id_, None, place=place)
        failure = failures[0] if failures else None if states else self._failure_of_name(cause)
        name = self.reader.chain_with(states) if states else None
        law = system.Law("model", model=name) if name else None
        if failure is not None:
            self.failures.setdefault(failure, []).append(id_)
            self.reader.common_causes.warn_alone(failure, f"event {id_!r}")
            law = self._law(failure, id_, name)
        return system.BasicEvent(id_, law, place=place)

    def _law(self, failure: Element, id_: str, model: str | None = None) -> system.Law | None:
        states = self.reader.states_of.get(failure, [])
        if model is None and states:
            if len({self.reader.states[state][0] for state in states}) > 1:
                subject = self.document.describe(failure)
                self.findings.report("X011.several_chains", failure, failure=subject)
            model = self.reader.chain_with(states)
        return self.reader.laws.of_failure(failure, id_, model)

    def _failure_of_name(self, cause: Element) -> Element | None:
        name = self.document.attribute(cause, word.NAME)
        failures = self.document.children(self.reader.tree_of[cause], word.FAILURES)
        same = [f for f in failures if name and self.document.attribute(f, word.NAME) == name]
        if len(same) == 1:
            self.findings.count("X014.same_name", cause)
            return same[0]
        subject = self.document.describe(cause)
        self.findings.report("X014.no_failure", cause, subject=subject, number=len(same) or "no")
        return None

    def _join_common_causes(self) -> Mapping[str, str]:
        """Add the common causes of events; return event -> gate that stands for it and these."""
        shared: dict[str, list[str]] = {}
        members: dict[Element, list[str]] = {}
        for failure, ids in list(self.failures.items()):
            for cause in self.reader.common_causes.of(failure):
                members.setdefault(cause, []).extend(ids)
                if cause not in self.failures:  # it may be an event of the tree already
                    name = self._new(self.reader.name_of(cause, "common cause0"))
                    place = self.document.place(cause)
                    self.events[name] = system.BasicEvent(name, self._law(cause, name), place=place)
                    self.failures[cause] = [name]
                for id_ in ids:
                    shared.setdefault(id_, []).append(self.failures[cause][0])
        for cause, ids in members.items():
            subject = self.document.describe(cause)
            self.findings.report("R013.common_cause", cause, cause=subject, events=", ".join(ids))
        instead: dict[str, str] = {}
        for id_, causes in shared.items():
            instead[id_] = self._new(" or ".join([id_, *causes]))
            place = self.events[id_].place
            self.gates[instead[id_]] = system.Gate(instead[id_], "OR", (id_, *causes), place=place)
        for key, gate in self.gates.items():
            if key not in instead.values():
                of = tuple(instead.get(below, below) for below in gate.of)
                self.gates[key] = replace(gate, of=of)
        return instead

    def _new(self, name: str) -> str:
        while name in self.events or name in self.gates:
            name += "'"
        return name

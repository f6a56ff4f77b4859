"""Fault trees and Markov chains from EDDI XML (failure logic package of the metamodel)."""

from __future__ import annotations

from collections.abc import Iterator

from eddi_scaffold.kinds.reliability import IN_EDDI
from eddi_scaffold.kinds.reliability.dependencies import order
from eddi_scaffold.kinds.reliability.eddi_laws import Laws
from eddi_scaffold.kinds.reliability.model import (
    GATES,
    Arc,
    BasicEvent,
    Chain,
    ComponentModel,
    FaultTree,
    Gate,
    ReliabilitySystem,
)
from eddi_scaffold.problems import Place, Problem
from eddi_scaffold.readers.document import EddiDocument
from eddi_scaffold.readers.findings import EddiFindings
from eddi_scaffold.readers.spelling import Spelling, fold
from eddi_scaffold.readers.xmi import Element, select
from eddi_scaffold.source import Source

_NAME = Spelling("name")
_FAILURES = Spelling("failures", ("failure",))
_FAILURE, _FAIL_STATE = Spelling("failure"), Spelling("failState")
_CAUSES = Spelling("causes", ("cause",))
_STATES, _TRANSITIONS = Spelling("states", ("state",)), Spelling("transitions", ("transition",))
_FROM, _TO = Spelling("fromStates", ("fromState",)), Spelling("toStates", ("toState",))
_INITIAL, _IS_FAIL = Spelling("isInitialState"), Spelling("isFailState")
_CAUSE_TYPE, _GATE_TYPE = Spelling("causeType"), Spelling("gateType")
_ORIGIN = Spelling("originType")
_CUT_SETS, _SETS = Spelling("minimalCutsets"), Spelling("cutsets", ("cutset",))
_K = ("k", "voteThreshold", "vote", "n")


def read_eddi(
    document: EddiDocument, source: Source
) -> tuple[list[ReliabilitySystem], list[Problem]]:
    """Read every chain and every top event of a document, in document order.

    Returns:
        One system for each, with the models that it uses, and all problems found.
    """
    findings = EddiFindings(document)
    reader = _Reader(document, source, findings)
    systems = reader.systems()
    return systems, findings.problems()


class _Reader:
    def __init__(self, document: EddiDocument, source: Source, findings: EddiFindings) -> None:
        self.document, self.source, self.findings = document, source, findings
        self.laws = Laws(document, findings)
        self.chain_of: dict[Element, str] = {}
        self.chains: dict[str, ComponentModel] = {}
        self.trees: list[Element] = []
        self.names: dict[Element, str] = {}
        self.below: dict[Element, list[Element]] = {}
        self.model_of: dict[Element, Element] = {}

    def systems(self) -> list[ReliabilitySystem]:
        elements: list[Element] = []
        for root in self.document.roots:
            elements += select(root, IN_EDDI)
        for element in elements:
            kind = self.document.class_of(element).name
            if kind == "markovchain":
                self.names[element] = self._unique(element)
                self._chain(element)
            elif kind == "faulttree":
                self.names[element] = self._unique(element)
                self.trees.append(element)
        for tree in self.trees:
            for cause in self.document.children(tree, _CAUSES):
                self.model_of[cause] = tree
        for cause in self.model_of:
            self.below[cause] = self._targets(cause, _CAUSES)
        used = {b for cause, below in self.below.items() for b in below if b is not cause}
        found: list[ReliabilitySystem] = []
        for element in elements:
            name = self.names.get(element)
            if name in self.chains:
                found.append(
                    ReliabilitySystem({name: self.chains[name]}, name, place=self._place(element))
                )
            elif element in self.trees and name is not None:
                found += self._tops(element, name, used)
        return found

    def _unique(self, element: Element) -> str:
        name = self.document.attribute(element, _NAME) or self.source.stem
        taken = set(self.names.values())
        if name not in taken:
            return name
        number = 2
        while f"{name}#{number}" in taken:
            number += 1
        self.findings.warning("R013", f"two models are called {name!r}", element)
        return f"{name}#{number}"

    def _place(self, element: Element) -> Place:
        return self.document.place(element)

    def _targets(self, element: Element, spelling: Spelling) -> list[Element]:
        found, problems, _ = self.document.targets(element, spelling)
        self.findings.add(*problems)
        return found

    def _named(self, element: Element, index: int, letter: str) -> str:
        return self.document.attribute(element, _NAME) or f"{letter}{index}"

    def _is(self, element: Element, spelling: Spelling) -> bool:
        return (self.document.attribute(element, spelling) or "").strip().lower() in ("true", "1")

    # chains

    def _chain(self, element: Element) -> None:
        name = self.names[element]
        states: dict[Element, str] = {}
        for i, state in enumerate(self.document.children(element, _STATES)):
            label = self._named(state, i, "S")
            states[state] = label if label not in states.values() else f"{label}#{i}"
        arcs: list[Arc] = []
        for transition in self.document.children(element, _TRANSITIONS):
            arcs += self._arcs(transition, states)
        fail = []
        for state, label in states.items():
            failures = self._targets(state, _FAIL_STATE)
            self.chain_of.update(dict.fromkeys(failures, name))
            if failures or self._is(state, _IS_FAIL):
                fail.append(label)
        chain = Chain(
            tuple(states.values()),
            tuple(label for state, label in states.items() if self._is(state, _INITIAL)),
            tuple(fail),
            tuple(arcs),
        )
        self.chains[name] = ComponentModel(name, "markov", chain, place=self._place(element))

    def _arcs(self, transition: Element, states: dict[Element, str]) -> Iterator[Arc]:
        sources, targets = self._targets(transition, _FROM), self._targets(transition, _TO)
        what = self.document.describe(transition)
        if not sources or not targets:
            self.findings.error("X020", f"{what} has no fromStates or no toStates", transition)
            return
        if len(sources) * len(targets) > 1:
            message = f"{what} joins several states: each pair gets its rate"
            self.findings.count("info", "X020", message, transition)
        rate = self.laws.transition(transition)
        for source in sources:
            for target in targets:
                if source not in states or target not in states:
                    message = f"{what} points at a state of another model"
                    self.findings.error("X020", message, transition)
                elif source is target:
                    message = f"{what} leads from {states[source]!r} to itself"
                    self.findings.error("X020", message, transition)
                elif rate is not None:
                    place = self._place(transition)
                    yield Arc(states[source], states[target], rate, place)

    # trees

    def _tops(self, tree: Element, name: str, used: set[Element]) -> Iterator[ReliabilitySystem]:
        causes = self.document.children(tree, _CAUSES)
        free = [cause for cause in causes if cause not in used]
        tops = [cause for cause in free if self._is_output(cause)] or [
            cause for cause in free if self._is_gate(cause)
        ]
        if not tops and causes and not free and self._cycle(causes):
            tops = causes[:1]
        for top in tops:
            full = name if len(tops) == 1 else f"{name}/{self._named(top, 0, 'top')}"
            content, uses = self._tree(top, tree)
            place = self._place(tree if len(tops) == 1 else top)
            component = ComponentModel(full, "fault_tree", content, place=place)
            chains = {one: self.chains[one] for one in uses}
            yield ReliabilitySystem({**chains, full: component}, full, place=place)

    def _cycle(self, causes: list[Element]) -> bool:
        ids = {cause: str(i) for i, cause in enumerate(self.below)}
        below = {ids[c]: [ids[b] for b in of if b in ids] for c, of in self.below.items()}
        return any(order(ids[cause], below)[1] for cause in causes)

    def _is_output(self, cause: Element) -> bool:
        failures = self._targets(cause, _FAILURE)
        return any(fold(self.document.attribute(f, _ORIGIN) or "") == "output" for f in failures)

    def _is_gate(self, cause: Element) -> bool:
        return self.document.class_of(cause).name == "gate"

    def _tree(self, top: Element, tree: Element) -> tuple[FaultTree, list[str]]:
        reached: dict[Element, None] = {}
        waiting = [top]
        while waiting:
            cause = waiting.pop()
            if cause not in reached:
                reached[cause] = None
                waiting += reversed([b for b in self.below.get(cause, []) if b in self.model_of])
        ids = self._ids(list(reached), tree)
        events: dict[str, BasicEvent] = {}
        gates: dict[str, Gate] = {}
        uses: dict[str, None] = {}
        for cause in reached:
            is_port = fold(self.document.attribute(cause, _CAUSE_TYPE) or "") != "basicevent"
            if self._is_gate(cause) or (is_port and self.below.get(cause)):
                gates[ids[cause]] = self._gate(cause, ids)
            elif is_port:
                self._empty(cause)
                place = self._place(cause)
                gates[ids[cause]] = Gate(ids[cause], "OR", (), place=place, is_port=True)
            else:
                events[ids[cause]] = event = self._event(cause, ids[cause])
                if event.law is not None and event.law.model:
                    uses[event.law.model] = None
        cut_sets = self._cut_sets(tree)
        return FaultTree(ids[top], events, gates, cut_sets=cut_sets), list(uses)

    def _ids(self, causes: list[Element], tree: Element) -> dict[Element, str]:
        """Return a name for each cause: its own where it is unique, else with its model's."""
        ids: dict[Element, str] = {}
        taken: set[str] = set()
        for i, cause in enumerate(causes):
            name = self._named(cause, i, "cause")
            owner = self.model_of[cause]
            candidates = [name] if owner is tree else []
            candidates += [f"{self.names[owner]}/{name}", f"{self.names[owner]}/{name}#{i}"]
            ids[cause] = next(one for one in candidates if one not in taken)
            taken.add(ids[cause])
        return ids

    def _gate(self, cause: Element, ids: dict[Element, str]) -> Gate:
        given = (self.document.attribute(cause, _GATE_TYPE) or "OR").strip()
        kind = given.upper()
        is_port = kind in ("INPUTEVENT", "OUTPUTEVENT")
        if is_port:
            kind = "OR"
        if kind not in GATES:
            what = self.document.describe(cause)
            self.findings.error("X011", f"{what} has the unknown gateType {given!r}", cause)
            kind = "OR"
        below = []
        for one in self.below.get(cause, []):
            if one in ids:
                below.append(ids[one])
            else:
                message = f"causes points at {self.document.describe(one)}, not at a cause"
                self.findings.error("X009", message, cause)
        if not below and is_port:
            self._empty(cause)
        k = self._votes(cause) if kind == "VOTE" else None
        return Gate(ids[cause], kind, tuple(below), k, self._place(cause), is_port)

    def _empty(self, cause: Element) -> None:
        what = self.document.describe(cause)
        message = f"{what} has no input: it never occurs"
        self.findings.count("warning", "X017", message, cause)

    def _votes(self, cause: Element) -> int | None:
        found = {key: text for key in _K if (text := self.laws.key_value(cause, key))}
        if len(set(found.values())) > 1:
            shown = ", ".join(f"{key}={text}" for key, text in found.items())
            message = f"{self.document.describe(cause)} has contradicting keys: {shown}"
            self.findings.error("R005", message, cause)
        text = next(iter(found.values()), "")
        return int(text) if text.isdecimal() and len(text) < 10 else None

    def _event(self, cause: Element, name: str) -> BasicEvent:
        failures = self._targets(cause, _FAILURE)
        if len(failures) > 1:
            message = f"{self.document.describe(cause)} has {len(failures)} failures, expected 1"
            self.findings.error("X011", message, cause)
        failure = failures[0] if failures else self._by_name(cause)
        place = self._place(cause)
        if failure is None:
            return BasicEvent(name, None, place=place)
        law = self.laws.law(failure, name, self.chain_of.get(failure))
        return BasicEvent(name, law, place=place)

    def _by_name(self, cause: Element) -> Element | None:
        own = self.document.attribute(cause, _NAME)
        failures = self.document.children(self.model_of[cause], _FAILURES)
        same = [f for f in failures if own and self.document.attribute(f, _NAME) == own]
        what = self.document.describe(cause)
        if len(same) == 1:
            message = "a basic event has no failure: the one with the same name is used"
            self.findings.count("info", "X018", message, cause)
            return same[0]
        count = "no" if not same else str(len(same))
        message = f"{what} has no failure, and {count} failures of its name are there"
        self.findings.warning("X018", message, cause)
        return None

    def _cut_sets(self, tree: Element) -> frozenset[frozenset[str]] | None:
        found = set()
        for group in self.document.children(tree, _CUT_SETS):
            for one in self.document.children(group, _SETS):
                failures = self._targets(one, _FAILURES)
                names = (self.document.attribute(f, _NAME) or "" for f in failures)
                found.add(frozenset(names))
        return frozenset(found) or None

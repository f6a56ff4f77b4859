"""Fault trees and Markov chains from EDDI XML (failure logic package of the metamodel)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Place, Problem
from eddi_scaffold.eddi_xml import vocabulary as word
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.eddi_xml.findings import EddiFindings
from eddi_scaffold.eddi_xml.parsing import Element, select
from eddi_scaffold.eddi_xml.survey import has_rate, kind_of_model
from eddi_scaffold.eddi_xml.vocabulary import CHAINS_AND_TREES, Spelling, fold
from eddi_scaffold.kinds.reliability.read_eddi_laws import CommonCauses, Laws, joined
from eddi_scaffold.kinds.reliability.system import (
    GATES,
    Arc,
    BasicEvent,
    Chain,
    ComponentModel,
    FaultTree,
    Gate,
    Law,
    ReliabilitySystem,
    order,
)

_EVENTS = ("basicevent", "normalevent")
_CAUSE_TYPES = ("InputEvent", "OutputEvent", "BasicEvent", "NormalEvent", "Gate")
_OTHERS_OF_SETS = tuple(map(Spelling, ("state", "event", "isNegated")))
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
        self.common = CommonCauses(document, findings)
        self.chains: dict[str, ComponentModel] = {}
        """Also those of which only a state counts."""
        self.labels: dict[Element, tuple[str, str]] = {}
        """State -> its chain and its name there."""
        self.states_of: dict[Element, list[Element]] = {}
        """Failure -> the states that are it."""
        self.trees: list[Element] = []
        self.names: dict[Element, str] = {}
        self.below: dict[Element, list[Element]] = {}
        self.model_of: dict[Element, Element] = {}

    def systems(self) -> list[ReliabilitySystem]:
        elements: list[Element] = []
        for root in self.document.roots:
            elements += select(root, CHAINS_AND_TREES)
        for element in elements:
            kind = kind_of_model(self.document, element)
            if kind == "markov_chain":
                self.names[element] = self._unique(element)
                self._chain(element)
            elif kind == "fault_tree":
                self.names[element] = self._unique(element)
                self.trees.append(element)
            elif kind == "state_machine":
                self._machine(element)
        for tree in self.trees:
            for cause in self.document.children(tree, word.CAUSES):
                self.model_of[cause] = tree
        for cause in self.model_of:
            self.below[cause] = self._targets(cause, word.CAUSES)
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
        name = self.document.attribute(element, word.NAME) or self.source.stem
        taken = set(self.names.values())
        if name not in taken:
            return name
        number = 2
        while f"{name}#{number}" in taken:
            number += 1
        self.findings.report("R013.same_name", element, name=name)
        return f"{name}#{number}"

    def _place(self, element: Element) -> Place:
        return self.document.place(element)

    def _children(self, element: Element, spelling: Spelling) -> list[Element]:
        return self.document.children(element, spelling)

    def _targets(self, element: Element, spelling: Spelling) -> list[Element]:
        found, problems, _ = self.document.targets(element, spelling)
        self.findings.add(*problems)
        return found

    def _failures(self, element: Element, spelling: Spelling) -> list[Element]:
        return self.findings.targets(element, spelling, word.FAILURES)

    def _named(self, element: Element, index: int, letter: str) -> str:
        return self.document.attribute(element, word.NAME) or f"{letter}{index}"

    def _is(self, element: Element, spelling: Spelling) -> bool:
        return (self.document.attribute(element, spelling) or "").strip().lower() in ("true", "1")

    # chains

    def _chain(self, element: Element) -> None:
        name = self.names[element]
        states: dict[Element, str] = {}
        for i, state in enumerate(self.document.children(element, word.STATES)):
            label = self._named(state, i, "S")
            states[state] = label if label not in states.values() else f"{label}#{i}"
        arcs: list[Arc] = []
        for transition in self.document.children(element, word.TRANSITIONS):
            arcs += self._arcs(transition, states)
        fail, stated = [], []
        for state, label in states.items():
            self.labels[state] = name, label
            older, failures = (
                self._failures(state, word.FAIL_STATE),
                self._failures(state, word.FAILURES),
            )
            for failure in [*older, *failures]:
                self.states_of.setdefault(failure, []).append(state)
            if older or self._is(state, word.IS_FAIL):
                fail.append(label)
            elif failures:
                stated.append(label)
        self._unused(element, list(states))
        chain = Chain(
            tuple(states.values()),
            tuple(label for state, label in states.items() if self._is(state, word.IS_INITIAL)),
            tuple(fail or stated),
            tuple(arcs),
        )
        self.chains[name] = ComponentModel(name, "markov", chain, place=self._place(element))

    def _unused(self, machine: Element, states: Sequence[Element]) -> None:
        """Warn of what would change the probabilities of a chain, and is not used."""
        found = [
            (word.INITIAL_PROBABILITY, child)
            for state in states
            for child in self._children(state, word.INITIAL_PROBABILITY)
        ]
        found += [
            (word.TRANSITION_MATRICES, child)
            for child in self._children(machine, word.TRANSITION_MATRICES)
        ]
        for feature, element in found:
            self.findings.count(
                "X014.of_machine",
                element,
                machine=self.document.describe(machine),
                feature=feature.name,
            )

    def _machine(self, element: Element) -> None:
        """Warn of a state machine that is none by its rates alone."""
        transitions = self.document.children(element, word.TRANSITIONS)
        rates = [transition for transition in transitions if has_rate(self.document, transition)]
        if rates:
            what = self.document.describe(element)
            self.findings.report(
                "X014.no_chain", rates[0], machine=what, rates=len(rates), number=len(transitions)
            )
        self._unused(element, self.document.children(element, word.STATES))

    def _chain_with(self, states: Sequence[Element]) -> str:
        """Return the chain that fails in these of its states: the chain itself, or another one."""
        name = self.labels[states[0]][0]
        component, labels = self.chains[name], [self.labels[state][1] for state in states]
        assert isinstance(component.content, Chain)
        fail = tuple(state for state in component.content.states if state in labels)
        if fail == component.content.fail:
            return name
        variant = f"{name}/{' or '.join(fail)}"
        content = replace(component.content, fail=fail)
        self.chains[variant] = replace(component, name=variant, content=content)
        return variant

    def _arcs(self, transition: Element, states: dict[Element, str]) -> Iterator[Arc]:
        sources, targets = (
            self._targets(transition, word.FROM_STATES),
            self._targets(transition, word.TO_STATES),
        )
        what = self.document.describe(transition)
        if not sources or not targets:
            self.findings.report("X020.no_states", transition, subject=what)
            return
        if len(sources) * len(targets) > 1:
            self.findings.count("X020.joins", transition, subject=what)
        rate = self.laws.transition(transition)
        for source in sources:
            for target in targets:
                if source not in states or target not in states:
                    self.findings.report("X020.other_model", transition, subject=what)
                elif source is target:
                    self.findings.report(
                        "X020.itself", transition, subject=what, state=states[source]
                    )
                elif rate is not None:
                    place = self._place(transition)
                    yield Arc(states[source], states[target], rate, place)

    # trees

    def _tops(self, tree: Element, name: str, used: set[Element]) -> Iterator[ReliabilitySystem]:
        causes = self.document.children(tree, word.CAUSES)
        free = [cause for cause in causes if cause not in used]
        stated, problems, given = self.document.targets(tree, word.TOP_EVENT)
        self.findings.add(*problems)
        if given and (len(stated) != 1 or stated[0] not in self.model_of):
            if not problems:
                self.findings.report("X009.top_event", tree, tree=self.document.describe(tree))
            return
        tops = stated or [cause for cause in free if self._is_output(cause)]
        tops = tops or [cause for cause in free if self._is_gate(cause)]
        if not tops and causes and not free and self._cycle(causes):
            tops = causes[:1]
        for top in tops:
            full = name if len(tops) == 1 else f"{name}/{self._named(top, 0, 'top')}"
            content, uses = self._tree(top, tree)
            place = self._place(tree if len(tops) == 1 else top)
            component = ComponentModel(full, "fault_tree", content, place=place)
            chains = {use: self.chains[use] for use in uses}
            yield ReliabilitySystem({**chains, full: component}, full, place=place)

    def _cycle(self, causes: list[Element]) -> bool:
        ids = {cause: str(i) for i, cause in enumerate(self.below)}
        below = {ids[c]: [ids[b] for b in of if b in ids] for c, of in self.below.items()}
        return any(order(ids[cause], below)[1] for cause in causes)

    def _is_output(self, cause: Element) -> bool:
        failures = self._failures(cause, word.FAILURE)
        return any(
            fold(self.document.attribute(f, word.ORIGIN_TYPE) or "") == "output" for f in failures
        )

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
        failures: dict[Element, list[str]] = {}
        for cause in reached:
            stated = self.document.attribute(cause, word.CAUSE_TYPE) or _CAUSE_TYPES[0]
            if fold(stated) not in map(fold, _CAUSE_TYPES):
                self.findings.report(
                    "X011.cause_type",
                    cause,
                    cause=self.document.describe(cause),
                    value=stated,
                    cause_types=", ".join(_CAUSE_TYPES),
                )
            is_port = fold(stated) not in _EVENTS
            if self._is_gate(cause) or (is_port and self.below.get(cause)):
                gates[ids[cause]] = self._gate(cause, ids)
            elif is_port:
                self._empty(cause)
                place = self._place(cause)
                gates[ids[cause]] = Gate(ids[cause], "OR", (), place=place, is_port=True)
            else:
                events[ids[cause]], failure = self._event(cause, ids[cause])
                if failure is not None:
                    failures.setdefault(failure, []).append(ids[cause])
        gates, instead = self._common_causes(events, gates, failures)
        uses = dict.fromkeys(e.law.model for e in events.values() if e.law and e.law.model)
        self._one_state_each(tree, list(uses))
        own = self._failures(top, word.FAILURE)
        cut_sets = self._cut_sets(tree, own, failures)
        name = instead.get(ids[top], ids[top])
        return FaultTree(name, events, gates, cut_sets=cut_sets), list(uses)

    def _one_state_each(self, tree: Element, uses: Sequence[str]) -> None:
        """Refuse two states of one chain in a tree, which are not independent."""
        first: dict[Place, str] = {}
        for name in uses:
            other = first.setdefault(self.chains[name].place, name)
            if other != name:
                what = self.document.describe(tree)
                self.findings.report("R009.one_chain", tree, subject=what, first=other, second=name)

    def _common_causes(
        self,
        events: dict[str, BasicEvent],
        gates: dict[str, Gate],
        failures: dict[Element, list[str]],
    ) -> tuple[dict[str, Gate], Mapping[str, str]]:
        """Add the common causes of the events to them, and join them."""
        shared: dict[str, list[str]] = {}
        members: dict[Element, list[str]] = {}
        for failure, own in list(failures.items()):
            for cause in self.common.of(failure):
                members.setdefault(cause, []).extend(own)
                common = self._shared(cause, events, gates, failures)
                for event in own:
                    shared.setdefault(event, []).append(common)
        for cause, of in members.items():
            described, events_of = self.document.describe(cause), ", ".join(of)
            self.findings.report("R013.common_cause", cause, cause=described, events=events_of)
        return joined(gates, shared, {key: event.place for key, event in events.items()})

    def _shared(
        self,
        failure: Element,
        events: dict[str, BasicEvent],
        gates: dict[str, Gate],
        failures: dict[Element, list[str]],
    ) -> str:
        """Return the event that is a common cause, which may be one of the tree already."""
        if failure not in failures:
            name = self._named(failure, 0, "common cause")
            while name in events or name in gates:
                name += "'"
            law = self.laws.law(failure, name, self._chain_of(failure))
            events[name] = BasicEvent(name, law, place=self._place(failure))
            failures[failure] = [name]
        return failures[failure][0]

    def _ids(self, causes: list[Element], tree: Element) -> dict[Element, str]:
        """Return a name for each cause: its own where it is unique, else with its model's."""
        ids: dict[Element, str] = {}
        taken: set[str] = set()
        for i, cause in enumerate(causes):
            name = self._named(cause, i, "cause")
            owner = self.model_of[cause]
            candidates = [name] if owner is tree else []
            candidates += [f"{self.names[owner]}/{name}", f"{self.names[owner]}/{name}#{i}"]
            ids[cause] = next(candidate for candidate in candidates if candidate not in taken)
            taken.add(ids[cause])
        return ids

    def _gate(self, cause: Element, ids: dict[Element, str]) -> Gate:
        given = (self.document.attribute(cause, word.TREE_GATE_TYPE) or "OR").strip()
        kind = given.upper()
        is_port = kind in ("INPUTEVENT", "OUTPUTEVENT")
        if is_port:
            kind = "OR"
        if kind not in GATES:
            what = self.document.describe(cause)
            self.findings.report("X011.gate_type", cause, subject=what, value=given)
            kind = "OR"
        below = []
        for one in self.below.get(cause, []):
            if one in ids:
                below.append(ids[one])
            else:
                self.findings.report("X009.cause", cause, name=self.document.describe(one))
        if not below and is_port:
            self._empty(cause)
        k = self._votes(cause) if kind == "VOTE" else None
        return Gate(ids[cause], kind, tuple(below), k, self._place(cause), is_port)

    def _empty(self, cause: Element) -> None:
        what = self.document.describe(cause)
        self.findings.count("X014.no_input", cause, subject=what)

    def _votes(self, cause: Element) -> int | None:
        found = {key: text for key in _K if (text := self.laws.key_value(cause, key))}
        if len(set(found.values())) > 1:
            shown = ", ".join(f"{key}={text}" for key, text in found.items())
            self.findings.report(
                "R005.keys", cause, cause=self.document.describe(cause), shown=shown
            )
        text = next(iter(found.values()), "")
        return int(text) if text.isdecimal() and len(text) < 10 else None

    def _event(self, cause: Element, name: str) -> tuple[BasicEvent, Element | None]:
        """Return a basic event and its failure."""
        failures = self._failures(cause, word.FAILURE)
        if len(failures) > 1:
            self.findings.report(
                "X011.failures", cause, cause=self.document.describe(cause), number=len(failures)
            )
        states = self._targets(cause, word.STATE)
        others = [state for state in states if state not in self.labels]
        if others or len(states) > 1:
            what = self.document.describe([*others, *states][0])
            self.findings.report(
                "X009.state_of_chain", cause, cause=self.document.describe(cause), subject=what
            )
            return BasicEvent(name, None, place=self._place(cause)), None
        failure = failures[0] if failures else None if states else self._by_name(cause)
        place = self._place(cause)
        chain = self._chain_with(states) if states else None
        if failure is None:
            law = Law("model", model=chain) if chain else None
            return BasicEvent(name, law, place=place), None
        self.common.warn_alone(failure, f"event {name!r}")
        law = self.laws.law(failure, name, chain or self._chain_of(failure))
        return BasicEvent(name, law, place=place), failure

    def _chain_of(self, failure: Element) -> str | None:
        """Return the chain of which some states are a failure."""
        states = self.states_of.get(failure, [])
        if len({self.labels[state][0] for state in states}) > 1:
            self.findings.report(
                "X011.several_chains", failure, failure=self.document.describe(failure)
            )
        return self._chain_with(states) if states else None

    def _by_name(self, cause: Element) -> Element | None:
        own = self.document.attribute(cause, word.NAME)
        failures = self.document.children(self.model_of[cause], word.FAILURES)
        same = [f for f in failures if own and self.document.attribute(f, word.NAME) == own]
        what = self.document.describe(cause)
        if len(same) == 1:
            self.findings.count("X014.same_name", cause)
            return same[0]
        count = "no" if not same else str(len(same))
        self.findings.report("X014.no_failure", cause, subject=what, number=count)
        return None

    def _cut_sets(
        self, tree: Element, own: Sequence[Element], failures: Mapping[Element, Sequence[str]]
    ) -> frozenset[frozenset[str]] | None:
        """Return the cut sets that the file states for the top, as names of events."""
        found: set[frozenset[str]] = set()
        left_out = []
        for group in self._children(tree, word.CUT_SETS):
            about = self._failures(group, word.FAILURE)
            if about and not set(about) & set(own):
                if self.document.attribute(tree, word.TOP_EVENT):  # else it is another top
                    described = self.document.describe(tree)
                    self.findings.count("R013.not_compared", group, tree=described)
                continue
            for child in self._children(group, word.SETS):
                causes = self._children(child, word.CAUSES)
                of = self._failures(child, word.FAILURES)
                of += [
                    failure for cause in causes for failure in self._failures(cause, word.FAILURE)
                ]
                names = [failures.get(f, [self._named(f, 0, "?")]) for f in of]
                odd = any(self.document.attribute(c, n) for c in causes for n in _OTHERS_OF_SETS)
                if odd or self._children(child, word.SEQUENCES) or any(len(n) > 1 for n in names):
                    left_out.append(child)
                found.add(frozenset(name[0] for name in names))
        if left_out:
            described, number = self.document.describe(tree), len(left_out)
            self.findings.count("R013.odd_sets", left_out[0], number=number, tree=described)
        return frozenset(found) if found and not left_out else None

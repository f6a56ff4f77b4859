"""Bayesian networks from EDDI XML (SESAME D7.2 Fig 11): bound by reference, never by position."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Place, Problem
from eddi_scaffold.eddi_xml import vocabulary
from eddi_scaffold.eddi_xml.document import EddiDocument, EddiFindings
from eddi_scaffold.eddi_xml.parsing import Element, feature_of, select
from eddi_scaffold.eddi_xml.vocabulary import Spelling
from eddi_scaffold.kinds.bayesian_network.checks import check_network
from eddi_scaffold.kinds.bayesian_network.network import Draft, Named, Network, Row

CLASS = "bayesiannetwork"
_FEATURES = ("bayesiannetwork", "bayesiannetworks")


def read_networks(document: EddiDocument, source: Source) -> tuple[list[Network], list[Problem]]:
    """Read every network of a document, in document order, with all problems."""
    networks: list[Network] = []
    problems: list[Problem] = []
    elements = [e for root in document.roots for e in select(root, vocabulary.NETWORKS)]
    for element in elements:
        class_name = document.class_of(element).name
        feature = vocabulary.fold(feature_of(element))
        if class_name != CLASS and (class_name or feature not in _FEATURES):
            continue
        reader = _Reader(document, element)
        drafts = reader.read()
        name = document.attribute(element, vocabulary.NAME) or source.stem
        network, faults = check_network(name, drafts, document.place(element))
        problems += [*reader.findings.problems(), *faults]
        if network is not None and not reader.findings.errors:
            networks.append(replace(network, known=tuple(reader.known.items())))
    return networks, problems


@dataclass(eq=False)
class _Node:
    element: Element
    name: str
    states: Mapping[Element, str]
    parents: list[tuple[Element, Place]] = field(default_factory=list)


class _Reader:
    def __init__(self, document: EddiDocument, network: Element) -> None:
        self.document, self.network = document, network
        self.findings = EddiFindings(document)
        self.nodes: dict[Element, _Node] = {}
        self.known: dict[str, str | None] = {}
        """Node that is expected to be known -> the event that tells."""

    def read(self) -> list[Draft]:
        """Return the nodes as drafts."""
        children = self.document.children
        for element in children(self.network, vocabulary.NODES):
            states = children(element, vocabulary.NODE_STATES)
            names = {state: self._name(state) or "" for state in states}
            self.nodes[element] = _Node(element, self._name(element) or "", names)
        for connection in children(self.network, vocabulary.CONNECTIONS):
            sources = self._ends(connection, vocabulary.FROM)
            place = self.document.place(connection)
            for target in self._ends(connection, vocabulary.TO):
                self.nodes[target].parents += [(source, place) for source in sources]
        targets: set[Element] = set()
        for intent in children(self.network, vocabulary.INTENTS):
            for target in children(intent, vocabulary.INFERENCE_TARGETS):
                targets.update(self._ends(target, vocabulary.NODE))
            for evidence in children(intent, vocabulary.REQUIRED_EVIDENCES):
                events, _, _ = self.document.targets(evidence, vocabulary.EVENT)
                for node in self._ends(evidence, vocabulary.NODE):
                    self.known[self.nodes[node].name] = next(map(self._name, events), None)
        return [self._draft(node, targets) for node in self.nodes.values()]

    def _name(self, element: Element) -> str | None:
        return self.document.attribute(element, vocabulary.NAME)

    def _ends(self, element: Element, end: Spelling) -> list[Element]:
        """Return the nodes that an element points at."""
        targets, problems, is_stated = self.document.targets(element, end)
        self.findings.add(*problems)
        if not is_stated:
            shown = self.document.describe(element)
            self.findings.report("X010.connection_end", element, connection=shown, end=end.name)
        for target in targets:
            if target not in self.nodes:
                shown = self.document.describe(target)
                self.findings.report("X009.end", element, end=end.name, target=shown)
        return [target for target in targets if target in self.nodes]

    def _draft(self, node: _Node, targets: Collection[Element]) -> Draft:
        place = self.document.place
        elements = self.document.children(node.element, vocabulary.ROWS)
        before = self.findings.errors
        rows = self._rows(node, elements) if elements else None
        return Draft(
            node.name,
            node.name,
            tuple(Named(name, place(state)) for state, name in node.states.items()),
            tuple(Named(self.nodes[parent].name, where) for parent, where in node.parents),
            None,
            place(node.element),
            place(node.element),
            rows,
            target=node.element in targets,
            broken=self.findings.errors > before,
        )

    def _rows(self, node: _Node, elements: Sequence[Element]) -> Mapping[tuple[str, ...], Row]:
        """Return the rows by the names of the parents' states."""
        parents = [self.nodes[parent] for parent in dict.fromkeys(p for p, _ in node.parents)]
        rows: dict[tuple[Element, ...], tuple[tuple[str, ...], Row]] = {}
        for element in elements:
            states, values = self._states(node, element, parents), self._values(node, element)
            if states is None:
                continue
            place = self.document.place(element)
            names = tuple(parent.states[s] for parent, s in zip(parents, states, strict=True))
            if states in rows:
                pairs = zip(parents, names, strict=True)
                shown = ", ".join(f"{p.name}={s}" for p, s in pairs) or "the only row"
                line = rows[states][1][1].line
                name = node.name
                self.findings.report("B110.duplicate_row", element, row=shown, name=name, line=line)
            rows.setdefault(states, (names, (values, place)))
        return dict(rows.values())

    def _states(
        self, node: _Node, row: Element, parents: Sequence[_Node]
    ) -> tuple[Element, ...] | None:
        """Return the state of each parent that a row is about, in the order of the parents."""
        before = self.findings.errors
        targets, problems, _ = self.document.targets(row, vocabulary.PARENT_STATES)
        self.findings.add(*problems)
        chosen: dict[Element, Element] = {}
        for state in targets:
            parent_element = state.getparent()
            owner = None if parent_element is None else self.nodes.get(parent_element)
            if owner is None or state not in owner.states:
                subject = self.document.describe(state)
                self.findings.report("X009.row_state", row, subject=subject)
            elif owner not in parents:
                self.findings.report("X009.row_parent", row, parent=owner.name, node=node.name)
            elif owner.element in chosen:
                self.findings.report("B105.parent_twice", row, node=node.name, parent=owner.name)
            else:
                chosen[owner.element] = state
        lacking = [parent.name for parent in parents if parent.element not in chosen]
        if lacking and self.findings.errors == before:
            self.findings.report("B110.no_state", row, node=node.name, parent=", ".join(lacking))
        if self.findings.errors > before:
            return None
        return tuple(chosen[parent.element] for parent in parents)

    def _values(self, node: _Node, row: Element) -> list[str]:
        """Return the text of each own state; what is not written is 0, as EMF leaves it out."""
        texts: dict[Element, str] = {}
        for value in self.document.children(row, vocabulary.PROBABILITIES):
            targets, problems, is_stated = self.document.targets(value, vocabulary.NODE_STATE)
            self.findings.add(*problems)
            if not is_stated:
                self.findings.report("X010.node_state", value)
            for state in targets:
                if state not in node.states:
                    fields = {"node": node.name, "subject": self.document.describe(state)}
                    self.findings.report("X009.state_of_other", value, **fields)
                elif state in texts:
                    fields = {"node": node.name, "state": node.states[state]}
                    self.findings.report("B110.duplicate_value", value, **fields)
                else:
                    text = self.document.attribute(value, vocabulary.VALUE)
                    texts[state] = "0.0" if text is None else text.strip()
        return [texts.get(state, "0.0") for state in node.states]

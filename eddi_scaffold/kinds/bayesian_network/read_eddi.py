"""Bayesian networks from EDDI XML (SESAME D7.2 Fig 11): bound by reference, never by position."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import product

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Place, Problem
from eddi_scaffold.eddi_xml import vocabulary as word
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.eddi_xml.findings import EddiFindings
from eddi_scaffold.eddi_xml.parsing import Element, select
from eddi_scaffold.eddi_xml.vocabulary import NETWORKS, Spelling, fold
from eddi_scaffold.kinds.bayesian_network.checks import check_network, first_missing
from eddi_scaffold.kinds.bayesian_network.network import Draft, Named, Network

CLASS = "bayesiannetwork"
_FEATURES = ("bayesiannetwork", "bayesiannetworks")


def read_eddi(document: EddiDocument, source: Source) -> tuple[list[Network], list[Problem]]:
    """Read every network of a document, in document order, with all problems."""
    networks: list[Network] = []
    problems: list[Problem] = []
    for element in network_elements(document):
        findings = EddiFindings(document)
        reader = _Reader(document, element, findings)
        drafts = reader.read()
        name = document.attribute(element, word.NAME) or source.stem
        network, found = check_network(name, drafts, document.place(element))
        problems += [*findings.problems(), *found]
        if network is not None and not findings.errors:
            networks.append(replace(network, known=reader.known))
    return networks, problems


def network_elements(document: EddiDocument) -> Iterator[Element]:
    """Yield the elements of class BayesianNetwork, wherever they are contained."""
    for root in document.roots:
        for element in select(root, NETWORKS):
            stated = document.class_of(element).name
            if stated == CLASS or (not stated and fold(document.feature(element)) in _FEATURES):
                yield element


@dataclass
class _Node:
    element: Element
    name: str
    states: dict[Element, str] = field(default_factory=dict)
    parents: list[tuple[Element, Place]] = field(default_factory=list)


class _Reader:
    def __init__(self, document: EddiDocument, network: Element, findings: EddiFindings) -> None:
        self.document, self.network, self.findings = document, network, findings
        self.nodes: dict[Element, _Node] = {}
        self.known: tuple[tuple[str, str | None], ...] = ()
        self.wanted: set[Element] = set()

    def read(self) -> list[Draft]:
        """Return the nodes as drafts."""
        for element in self.document.children(self.network, word.NODES):
            name = self.document.attribute(element, word.NAME) or ""
            node = _Node(element, name)
            for state in self.document.children(element, word.NODE_STATES):
                node.states[state] = self.document.attribute(state, word.NAME) or ""
            self.nodes[element] = node
        for connection in self.document.children(self.network, word.CONNECTIONS):
            self._connect(connection)
        self._intents()
        return [self._draft(node) for node in self.nodes.values()]

    def _intents(self) -> None:
        """Read which nodes are expected to be known, and which are wanted."""
        known: dict[str, str | None] = {}
        for intent in self.document.children(self.network, word.INTENTS):
            for wanted in self.document.children(intent, word.INFERENCE_TARGETS):
                self.wanted.update(self._ends(wanted, word.NODE))
            for child in self.document.children(intent, word.REQUIRED_EVIDENCES):
                told, _, _ = self.document.targets(child, word.EVENT)
                events = [self.document.attribute(event, word.NAME) for event in told]
                for node in self._ends(child, word.NODE):
                    known[self.nodes[node].name] = next(iter(events), None)
        self.known = tuple(known.items())
        inferences = self.document.children(self.network, word.INFERENCES)
        states = [state for node in self.nodes.values() for state in node.states]
        of_states = [child for s in states for child in self.document.children(s, word.DIMENSION)]
        for feature, found in (
            (word.INFERENCES, inferences),
            (word.DIMENSION, of_states),
        ):
            if found:
                self.findings.count(
                    "X014.feature",
                    found[0],
                    len(found),
                    feature=feature.name,
                    owner=self.document.describe(self.network),
                )

    def _connect(self, connection: Element) -> None:
        sources = self._ends(connection, word.FROM)
        targets = self._ends(connection, word.TO)
        place = self.document.place(connection)
        for target in targets:
            for source in sources:
                self.nodes[target].parents.append((source, place))

    def _ends(self, connection: Element, end: Spelling) -> list[Element]:
        found, problems, given = self.document.targets(connection, end)
        self.findings.add(*problems)
        if not given:
            self.findings.report(
                "X010.connection_end",
                connection,
                connection=self.document.describe(connection),
                end=end.name,
            )
        for target in found:
            if target not in self.nodes:
                self.findings.report(
                    "X009.end", connection, end=end.name, target=self.document.describe(target)
                )
        return [target for target in found if target in self.nodes]

    def _draft(self, node: _Node) -> Draft:
        place = self.document.place(node.element)
        rows = self.document.children(node.element, word.ROWS)
        broken = False
        values: tuple[str, ...] | None = None
        places: tuple[Place, ...] = ()
        if rows:
            before = self.findings.errors
            table = self._table(node, rows)
            broken = self.findings.errors > before
            if not broken and table is not None:
                values, places = table
            elif not broken:
                broken = True  # names are missing: reported elsewhere
        return Draft(
            node.name,
            node.name,
            tuple(Named(name, self.document.place(e)) for e, name in node.states.items()),
            tuple(Named(self.nodes[parent].name, where) for parent, where in node.parents),
            values,
            place,
            self.document.place(rows[0]) if rows else place,
            places,
            node.element in self.wanted,
            broken,
        )

    def _table(
        self, node: _Node, rows: list[Element]
    ) -> tuple[tuple[str, ...], tuple[Place, ...]] | None:
        """Return the texts of the table in order and the place of each row."""
        parents = list(dict.fromkeys(parent for parent, _ in node.parents))
        found: dict[tuple[Element, ...], tuple[Element, list[str]]] = {}
        before = self.findings.errors
        for row in rows:
            key = self._combination(node, row, parents)
            values = self._values(node, row)
            if key is None:
                continue
            if key in found:
                first = self.document.place(found[key][0]).line
                self.findings.report(
                    "B110.duplicate_row",
                    row,
                    row=self._shown(parents, key),
                    name=node.name,
                    line=first,
                )
            else:
                found[key] = (row, values)
        states = [list(self.nodes[parent].states) for parent in parents]
        if self.findings.errors > before:
            return None  # which rows are missing would only repeat that
        if not self._complete(node, parents, states, found):
            return None
        order = [found[key] for key in product(*states)]
        texts = tuple(text for _, values in order for text in values)
        return texts, tuple(self.document.place(row) for row, _ in order)

    def _complete(
        self,
        node: _Node,
        parents: list[Element],
        states: list[list[Element]],
        found: dict[tuple[Element, ...], tuple[Element, list[str]]],
    ) -> bool:
        names = [self.nodes[parent].name for parent in parents]
        labels = [
            [self.nodes[p].states[s] for s in of] for p, of in zip(parents, states, strict=True)
        ]
        if any(len(set(of)) < len(of) for of in labels):
            return False
        there = {
            tuple(self.nodes[p].states[s] for p, s in zip(parents, key, strict=True))
            for key in found
        }
        count, shown = first_missing(names, labels, there)
        if count:
            more = ", ..." if count > len(shown) else ""
            self.findings.report(
                "B110.missing_rows",
                node.element,
                name=node.name,
                number=count,
                rows="row" if count == 1 else "rows",
                shown="; ".join(shown),
                rest=more,
            )
        return not count

    def _combination(
        self, node: _Node, row: Element, parents: list[Element]
    ) -> tuple[Element, ...] | None:
        """Return the state of each parent that a row is about, in the order of the parents."""
        targets, problems, _ = self.document.targets(row, word.PARENT_STATES)
        self.findings.add(*problems)
        chosen: dict[Element, Element] = {}
        wrong = bool(problems)
        for state in targets:
            owner = state.getparent()
            if owner is None or owner not in self.nodes or state not in self.nodes[owner].states:
                what = self.document.describe(state)
                self.findings.report("X009.row_state", row, subject=what)
                wrong = True
            elif owner not in parents:
                self.findings.report(
                    "X009.row_parent", row, parent=self.nodes[owner].name, node=node.name
                )
                wrong = True
            elif owner in chosen:
                self.findings.report(
                    "B105.parent_twice", row, node=node.name, parent=self.nodes[owner].name
                )
                wrong = True
            else:
                chosen[owner] = state
        lacking = [self.nodes[parent].name for parent in parents if parent not in chosen]
        if lacking and not wrong:
            self.findings.report("B110.no_state", row, node=node.name, parent=", ".join(lacking))
        return None if wrong or lacking else tuple(chosen[parent] for parent in parents)

    def _values(self, node: _Node, row: Element) -> list[str]:
        """Return the text of each own state; what is not written is 0, as EMF leaves it out."""
        texts: dict[Element, str] = {}
        for value in self.document.children(row, word.PROBABILITIES):
            targets, problems, given = self.document.targets(value, word.NODE_STATE)
            self.findings.add(*problems)
            if not given:
                self.findings.report("X010.node_state", value)
            for state in targets:
                if state not in node.states:
                    what = self.document.describe(state)
                    self.findings.report("X009.state_of_other", value, node=node.name, subject=what)
                elif state in texts:
                    self.findings.report(
                        "B110.duplicate_value", value, node=node.name, state=node.states[state]
                    )
                else:
                    text = self.document.attribute(value, word.VALUE)
                    texts[state] = "0.0" if text is None else text.strip()
        return [texts.get(state, "0.0") for state in node.states]

    def _shown(self, parents: list[Element], key: tuple[Element, ...]) -> str:
        pairs = (
            f"{self.nodes[p].name}={self.nodes[p].states[s]}"
            for p, s in zip(parents, key, strict=True)
        )
        return ", ".join(pairs) or "the only row"

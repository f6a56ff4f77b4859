"""ConSerts from EDDI XML."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Place, Problem
from eddi_scaffold.eddi_xml import vocabulary as names
from eddi_scaffold.eddi_xml.document import EddiDocument, EddiFindings
from eddi_scaffold.eddi_xml.parsing import Element, feature_of
from eddi_scaffold.eddi_xml.vocabulary import Spelling
from eddi_scaffold.kinds.consert import consert as model
from eddi_scaffold.kinds.consert.read_eddi_dimensions import DimensionReader

MAX_EDGES = 1_000_000
_INTEGER = re.compile(r"\s*[-+]?[0-9]{1,9}\s*")
_FUNCTIONS: dict[str, model.GateFunction] = {"and": "And", "or": "Or"}
_NODES = (names.GUARANTEES, names.DEMANDS, names.EVIDENCE, names.GATES, names.INVARIANT)


def read_eddi(document: EddiDocument, source: Source) -> tuple[list[model.ConSert], list[Problem]]:
    """Read every ConSert of a document without an error of the XML form, and what is wrong.

    The file's stem names one without a name.
    """
    findings = EddiFindings(document)
    conserts: list[model.ConSert] = []
    first: dict[str, Element] = {}
    for package in document.packages():
        is_untyped = not document.class_of(package).name
        if is_untyped and document.children(package, names.CONSERTS):
            findings.report("X010.package_type", package)
    for element in _conserts(document):
        reader = _ConSertReader(element, findings)
        name = document.attribute(element, names.NAME) or source.stem
        consert = reader.read(name)
        if name in first:
            line = document.place(first[name]).line
            findings.report("C007.duplicate_name", element, name=name, line=line)
        elif consert is not None:
            conserts.append(consert)
        first.setdefault(name, element)
    return conserts, findings.problems()


def _conserts(document: EddiDocument) -> Iterator[Element]:
    """Yield the ConSerts of both dialects, in document order."""
    for package in document.packages():
        class_name = document.class_of(package).name
        if class_name == "consert" and document.is_root(package):
            yield package
        elif class_name == names.PACKAGE_CLASS:
            yield from document.children(package, names.CONSERTS)
        elif class_name == "system":
            for configuration in document.children(package, names.CONFIGURATIONS):
                yield from document.children(configuration, names.CONSERTS)


class _ConSertReader:
    """Reads one ConSert; after an error with placeholders, which nobody sees."""

    def __init__(self, element: Element, findings: EddiFindings) -> None:
        self.element, self.findings = element, findings
        self.document = findings.document
        self.dimensions = DimensionReader(findings)
        self.ids: dict[Element, str] = {}  # of all nodes; holding elements keeps their identity

    def read(self, name: str) -> model.ConSert | None:
        """Return the ConSert, ``None`` when it has an error."""
        errors = self.findings.errors
        children = {part: self.document.children(self.element, part) for part in _NODES}
        place, dimensions = self.document.place, self.dimensions
        guarantees = [
            model.Guarantee(
                self._id(element),
                dimensions.read(element),
                self._description(element),
                bool(dimensions.boolean(element, names.DEFAULT)),
                self._ranking(element),
                place(element),
            )
            for element in children[names.GUARANTEES]
        ]
        demands = [
            model.Demand(self._id(e), dimensions.read(e), self._description(e), place(e))
            for e in children[names.DEMANDS]
        ]
        evidence = [self._evidence(element) for element in children[names.EVIDENCE]]
        gates = [self._gate(element) for element in children[names.GATES]]
        invariants = [self._gate(element, "Invariant") for element in children[names.INVARIANT]]
        edges = self._edges()
        for gate, element in zip(invariants, children[names.INVARIANT], strict=True):
            supported = {edge.target for edge in edges}
            if gate.id not in supported:
                self.findings.report("X006.unused_invariant", element, id=gate.id)
                continue
            # Without the invariant no guarantee that has support.
            self.findings.count("X006.invariant", element, id=gate.id)
            gates.append(gate)
            edges += [
                model.Propagation(gate.id, guarantee.id, gate.place)
                for guarantee in guarantees
                if not guarantee.default and guarantee.id in supported
            ]
        own = names.REQUIRED_SERVICES, names.PROVIDED_SERVICES
        rows = self._services(
            children, names.DEMANDS, names.REQUIRED_SERVICE, names.PROVIDED_ELSEWHERE, *own
        )
        required_services = tuple(model.RequiredService(*row) for row in rows)
        rows = self._services(
            children, names.GUARANTEES, names.PROVIDED_SERVICE, names.ALLOCATED, *own[::-1]
        )
        provided_services = tuple(model.ProvidedService(*row) for row in rows)
        if self.findings.errors > errors:
            return None
        link, ends = names.SERVICE_CONFIGURATION, names.SERVICE_CONFIGURATIONS
        targets = self.findings.targets(self.element, link, ends)
        systems = [system for end in targets if (system := end.getparent()) is not None]
        return model.ConSert(
            name,
            tuple(guarantees),
            tuple(demands),
            tuple(evidence),
            tuple(gates),
            tuple(edges),
            required_services,
            provided_services,
            self.document.place(self.element),
            (systems[0].get("name") or "") if systems else "",
        )

    def _name(self, element: Element) -> str:
        """Return the name of a node or a service; X010 when it has none."""
        name = self.document.attribute(element, names.NAME)
        if not name:
            kind = self.document.describe(element)
            self.findings.report("X010.name", element, kind=kind)
        return name or ""

    def _id(self, element: Element) -> str:
        self.ids[element] = self._name(element)
        return self.ids[element]

    def _description(self, element: Element) -> str | None:
        return self.document.attribute(element, names.DESCRIPTION) or None

    def _ranking(self, element: Element) -> int | None:
        text = self.document.attribute(element, names.RANKING)
        if text is None or _INTEGER.fullmatch(text):
            return None if text is None else int(text)
        fields = {"attribute": names.RANKING.name, "text": text[:60]}
        self.findings.report("X011.integer", element, **fields)
        return None

    def _evidence(self, element: Element) -> model.Evidence:
        id_, place = self._id(element), self.document.place(element)
        dimensions = self.dimensions.read(element) or self._described(element)
        has_property = bool(self.document.children(element, names.PROPERTY))
        if not dimensions and not has_property and not (element.text or "").strip():
            self.findings.report("X014.no_property", element, name=id_)
            dimensions = (model.BinaryDimension(id_, place),)
        if not dimensions:
            self.findings.report("C006.no_dimension", element, name=id_)
        elif len(dimensions) > 1:
            self.findings.report("C002.dimensions", element, name=id_, number=len(dimensions))
        dimension = dimensions[0] if dimensions else model.BinaryDimension("")
        return model.Evidence(id_, dimension, self._description(element), place)

    def _described(self, element: Element) -> tuple[model.Dimension, ...]:
        """Read the English description: only the older dialect has a dimension there."""
        if self._configuration() is None:
            return ()
        text = self._description(element)
        if text is None or not text.strip():
            text = self.document.attribute(element, names.NAME) or ""
            self.findings.report("X014.no_description", element, text=text)
        return (self.dimensions.english(text, element),) if text.strip() else ()

    def _gate(self, element: Element, default_name: str = "") -> model.Gate:
        id_ = self.document.attribute(element, names.NAME) or default_name or self._name(element)
        self.ids[element] = id_
        # EMF omits the first literal of an enumeration, which is AND here (OR in fault trees).
        text = self.document.attribute(element, names.GATE_TYPE)
        function = _FUNCTIONS.get(("and" if text is None else text).strip().casefold())
        if function is None:
            subject = f'{self.document.attribute_name(element, names.GATE_TYPE)} is "{text}"'
            self.findings.report("X011.operator", element, subject=subject)
        return model.Gate(id_, function or "And", self.document.place(element))

    def _edges(self) -> list[model.Propagation]:
        """Read an edge from each source to each target of each propagation, unless too many."""
        edges: list[model.Propagation] = []
        for element in self.document.children(self.element, names.PROPAGATIONS):
            sources, targets = self._ends(element, names.SOURCE), self._ends(element, names.TARGET)
            number = len(edges) + len(sources) * len(targets)
            if number > MAX_EDGES:
                self.findings.report("X003.edges", element, number=number, limit=MAX_EDGES)
                break
            place = self.document.place(element)
            edges += [
                model.Propagation(source, target, place) for source in sources for target in targets
            ]
        return edges

    def _ends(self, element: Element, spelling: Spelling) -> list[str]:
        ends, problems, is_present = self.document.targets(element, spelling)
        self.findings.add(*problems)
        if not is_present:
            owner = self.document.describe(element)
            self.findings.report("X010.attribute", element, attribute=spelling.name, owner=owner)
        for end in ends:
            if end in self.ids:
                continue
            fields = {"feature": spelling.name, "end": self.document.describe(end)}
            self.findings.report("X009.edge", element, **fields)
        return [self.ids[end] for end in ends if end in self.ids]

    def _services(
        self,
        nodes: Mapping[Spelling, Sequence[Element]],
        member: Spelling,
        link: Spelling,
        allocation: Spelling,
        feature: Spelling,
        allocated: Spelling,
    ) -> Iterator[tuple[str, str, tuple[str, ...], Place, tuple[Place, ...]]]:
        """Yield id, type, members, place of services, and to what they are allocated.

        Demands or guarantees refer to their services with ``link``; services, also those of the
        configuration around a ConSert, list these in ``member``.
        """
        members: dict[Element, list[str]] = {}
        for element in nodes[member]:
            for service in self.findings.targets(element, link, feature):
                members.setdefault(service, []).append(self.ids[element])
        configuration = self._configuration()
        for service in (
            self.document.children(configuration, feature) if configuration is not None else ()
        ):
            ends, problems, _ = self.document.targets(service, member)
            self.findings.add(*problems)
            members[service] = []
            for end in ends:
                if end in self.ids and member.accepts(feature_of(end)):
                    members[service].append(self.ids[end])
                else:
                    fields = {"link": member.name, "actual": self.document.describe(end)}
                    self.findings.report("X009.other_configuration", service, **fields)
        for service, ids in members.items():
            child = self.findings.only(service, names.SERVICE_TYPE)
            type_ = self.document.attribute(child, names.NAME) if child is not None else None
            if not type_:
                owner = self.document.describe(service)
                self.findings.report("X010.service_type", service, owner=owner)
            others = self.findings.targets(service, allocation, allocated)
            places = tuple(map(self.document.place, others))
            place = self.document.place(service)
            yield self._name(service), type_ or "", tuple(ids), place, places

    def _configuration(self) -> Element | None:
        """Return the configuration that holds a ConSert of the older dialect."""
        owner = self.element.getparent()
        is_older = owner is not None and names.CONFIGURATIONS.accepts(feature_of(owner))
        return owner if is_older else None

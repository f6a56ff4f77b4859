"""The parts of one ConSert in EDDI XML: its nodes, edges and invariant."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from eddi_scaffold.eddi_xml import vocabulary as names
from eddi_scaffold.kinds.consert.model import (
    BinaryDimension,
    Demand,
    Dimension,
    Evidence,
    Gate,
    GateFunction,
    Guarantee,
    Propagation,
)
from eddi_scaffold.kinds.consert.read_eddi_dimensions import (
    english_dimension,
    english_dimensions,
    read_boolean,
    sesame_dimensions,
)

if TYPE_CHECKING:
    from eddi_scaffold.eddi_xml.findings import EddiFindings
    from eddi_scaffold.eddi_xml.parsing import Element
    from eddi_scaffold.eddi_xml.vocabulary import Spelling


MAX_NODES = 100_000
MAX_EDGES = 1_000_000
_FUNCTIONS: dict[str, GateFunction] = {"and": "And", "or": "Or"}


@dataclass
class ConSertParts:
    """What was read of one ConSert.

    Attributes:
        ids: element -> id of every node; holding the elements keeps their identity.
        services: elements of the services that its nodes refer to.
    """

    guarantees: list[Guarantee] = field(default_factory=list)
    demands: list[Demand] = field(default_factory=list)
    evidence: list[Evidence] = field(default_factory=list)
    gates: list[Gate] = field(default_factory=list)
    edges: list[Propagation] = field(default_factory=list)
    ids: dict[Element, str] = field(default_factory=dict)
    services: list[Element] = field(default_factory=list)


def read_parts(consert: Element, findings: EddiFindings) -> ConSertParts:
    """Read nodes and edges of a ``conSerts`` or ``conSert`` element."""
    parts = ConSertParts()
    invariants = findings.document.children(consert, names.INVARIANT)
    if _read_nodes(consert, parts, findings):
        for element in invariants:
            _gate(element, parts, findings, name="Invariant")
        _read_edges(consert, parts, findings)
        for element in invariants:
            _apply_invariant(element, parts, findings)
    return parts


def _read_nodes(consert: Element, parts: ConSertParts, findings: EddiFindings) -> bool:
    """Read evidence, demands, gates and guarantees, unless there are too many."""
    readers = {
        names.GUARANTEES: _guarantee,
        names.DEMANDS: _demand,
        names.EVIDENCE: _evidence,
        names.GATES: _gate,
    }
    groups = [(r, findings.document.children(consert, part)) for part, r in readers.items()]
    count = sum(len(elements) for _, elements in groups)
    if count > MAX_NODES:
        findings.report("X003.nodes", consert, number=count, limit=MAX_NODES)
        return False
    for reader, elements in groups:
        for element in elements:
            reader(element, parts, findings)
    return True


def _read_edges(consert: Element, parts: ConSertParts, findings: EddiFindings) -> None:
    """Read an edge from each source to each target of each propagation, unless too many."""
    for element in findings.document.children(consert, names.PROPAGATIONS):
        sources = _ends(element, names.SOURCE, consert, parts, findings)
        targets = _ends(element, names.TARGET, consert, parts, findings)
        total = len(parts.edges) + len(sources) * len(targets)
        if total > MAX_EDGES:
            findings.report("X003.edges", element, number=total, limit=MAX_EDGES)
            return
        place = findings.document.place(element)
        parts.edges += [Propagation(s, t, place) for s in sources for t in targets]


def node_name(element: Element, findings: EddiFindings) -> str | None:
    """Return the name of an element that needs one; X010 when it has none."""
    name = findings.document.attribute(element, names.NAME)
    if not name:
        kind = findings.document.describe(element)
        findings.report("X010.name", element, kind=kind)
    return name or None


def description_of(element: Element, findings: EddiFindings) -> str | None:
    """Return the description, ``None`` when it is absent or empty."""
    return findings.document.attribute(element, names.DESCRIPTION) or None


def _dimensions(element: Element, findings: EddiFindings) -> tuple[Dimension, ...]:
    return sesame_dimensions(element, findings) + english_dimensions(element, findings)


def _guarantee(element: Element, parts: ConSertParts, findings: EddiFindings) -> None:
    name = node_name(element, findings)
    dimensions = _dimensions(element, findings)
    default = _boolean(element, names.DEFAULT, findings)
    ranking = _integer(element, names.RANKING, findings)
    if name is None:
        return
    parts.ids[element] = name
    place = findings.document.place(element)
    description = description_of(element, findings)
    parts.guarantees.append(Guarantee(name, dimensions, description, default, ranking, place))


def _demand(element: Element, parts: ConSertParts, findings: EddiFindings) -> None:
    name = node_name(element, findings)
    dimensions = _dimensions(element, findings)
    if name is None:
        return
    parts.ids[element] = name
    place = findings.document.place(element)
    parts.demands.append(Demand(name, dimensions, description_of(element, findings), place))


def _evidence(element: Element, parts: ConSertParts, findings: EddiFindings) -> None:
    errors = findings.errors
    name = node_name(element, findings)
    dimensions = _dimensions(element, findings) or _described(element, findings)
    if name is None:
        return
    has_property = bool(findings.document.children(element, names.PROPERTY))
    if not dimensions and not has_property and not (element.text or "").strip():
        findings.report("X014.no_property", element, name=name)
        dimensions = (BinaryDimension(name, findings.document.place(element)),)
    parts.ids[element] = name
    if len(dimensions) != 1:
        # A dimension with an error of its own is not missing.
        if dimensions or findings.errors == errors:
            if dimensions:
                findings.report("C002.dimensions", element, name=name, number=len(dimensions))
            else:
                findings.report("C006.no_dimension", element, name=name)
        return
    place = findings.document.place(element)
    description = description_of(element, findings)
    parts.evidence.append(Evidence(name, dimensions[0], description, place))


def _described(element: Element, findings: EddiFindings) -> tuple[Dimension, ...]:
    """Read the English description of evidence: only the older dialect has its dimension there."""
    if not is_older(element, findings):
        return ()
    text = description_of(element, findings)
    if text is None or not text.strip():
        text = findings.document.attribute(element, names.NAME) or ""
        findings.report("X014.no_description", element, text=text)
    return (english_dimension(text, element, findings),) if text.strip() else ()


def is_older(part: Element, findings: EddiFindings) -> bool:
    """Return whether a part of a ConSert is of the older dialect: ``configurations / conSert``."""
    consert = part.getparent()
    owner = consert.getparent() if consert is not None else None
    return owner is not None and names.CONFIGURATIONS.accepts(findings.document.feature(owner))


def _gate(
    element: Element, parts: ConSertParts, findings: EddiFindings, name: str | None = None
) -> None:
    document = findings.document
    id_ = document.attribute(element, names.NAME) or name or node_name(element, findings)
    text = document.attribute(element, names.GATE_TYPE)
    # EMF omits the first literal of an enumeration, which is AND here (OR in fault trees).
    function = "And" if text is None else _FUNCTIONS.get(text.strip().casefold())
    if function is None:
        message = f'{document.attribute_name(element, names.GATE_TYPE)} is "{text}"'
        findings.report("X011.operator", element, subject=message)
    if id_ is None or function is None:
        return
    parts.ids[element] = id_
    parts.gates.append(Gate(id_, "Or" if function == "Or" else "And", document.place(element)))


def _ends(
    element: Element,
    spelling: Spelling,
    consert: Element,
    parts: ConSertParts,
    findings: EddiFindings,
) -> list[str]:
    found, problems, present = findings.document.targets(element, spelling)
    findings.add(*problems)
    if not present:
        kind = findings.document.describe(element)
        findings.report("X010.attribute", element, attribute=spelling.name, owner=kind)
    ids = []
    for end in found:
        if end in parts.ids:
            ids.append(parts.ids[end])
        elif end.getparent() is not consert or not _is_node(end, findings):
            _wrong_end(element, spelling, end, findings)
    return ids


def _is_node(end: Element, findings: EddiFindings) -> bool:
    feature = findings.document.feature(end)
    parts = (names.GUARANTEES, names.DEMANDS, names.EVIDENCE, names.GATES, names.INVARIANT)
    return any(part.accepts(feature) for part in parts)


def _wrong_end(element: Element, spelling: Spelling, end: Element, findings: EddiFindings) -> None:
    hint = None
    if _is_node(end, findings):
        where = "of another ConSert"
        hint = "ConSerts are connected by services: a demand there, a guarantee here"
    else:
        where = "which is not a node"
    findings.report(
        "X009.edge",
        element,
        hint=hint,
        feature=spelling.name,
        end=findings.document.describe(end),
        where=where,
    )


def _apply_invariant(element: Element, parts: ConSertParts, findings: EddiFindings) -> None:
    """Let the invariant support every guarantee that has support: no invariant, no guarantee."""
    id_ = parts.ids.get(element)
    if id_ is None:
        return
    supported = {edge.target for edge in parts.edges}
    if id_ not in supported:
        parts.gates = [gate for gate in parts.gates if gate.id != id_]
        findings.report("X006.unused_invariant", element, id=id_)
        return
    place = findings.document.place(element)
    guarded = [g.id for g in parts.guarantees if not g.default and g.id in supported]
    parts.edges += [Propagation(id_, target, place) for target in guarded]
    findings.count("X006.invariant", element, id=id_)


def _boolean(element: Element, spelling: Spelling, findings: EddiFindings) -> bool:
    text = findings.document.attribute(element, spelling)
    if text is None:
        return False
    return read_boolean(text, spelling.name, element, findings) or False


def _integer(element: Element, spelling: Spelling, findings: EddiFindings) -> int | None:
    text = findings.document.attribute(element, spelling)
    if text is None:
        return None
    digits = text.strip().removeprefix("-").removeprefix("+")
    if digits.isascii() and digits.isdigit() and len(digits) <= 9:
        return int(text)
    findings.report("X011.integer", element, attribute=spelling.name, text=text[:60])
    return None

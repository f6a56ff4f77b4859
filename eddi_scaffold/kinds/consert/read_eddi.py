"""ConSerts from EDDI XML."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eddi_scaffold.eddi_xml import vocabulary as names
from eddi_scaffold.eddi_xml.findings import EddiFindings
from eddi_scaffold.eddi_xml.parsing import stray_texts
from eddi_scaffold.eddi_xml.vocabulary import Spelling, is_misprint, local_name
from eddi_scaffold.kinds.consert.default_guarantees import with_default_guarantees
from eddi_scaffold.kinds.consert.model import ConSert, ProvidedService, RequiredService
from eddi_scaffold.kinds.consert.read_eddi_parts import node_name, read_parts

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Iterator, Mapping, Sequence

    from eddi_scaffold.common.files import Source
    from eddi_scaffold.common.problems import Place, Problem
    from eddi_scaffold.eddi_xml.document import EddiDocument
    from eddi_scaffold.eddi_xml.parsing import Element
    from eddi_scaffold.kinds.consert.read_eddi_parts import ConSertParts

    _Row = tuple[str, str, tuple[str, ...], Place, tuple[Place, ...]]
    """What both kinds of services have: id, type, members, place, to what they are allocated."""


def required_services(
    consert: Element, parts: ConSertParts, findings: EddiFindings
) -> tuple[RequiredService, ...]:
    """Return the services that the demands need, in the order of their first use."""
    demands = findings.document.children(consert, names.DEMANDS)
    members = _referred(demands, names.REQUIRED_SERVICE, names.REQUIRED_SERVICES, parts, findings)
    members |= _listed(consert, names.REQUIRED_SERVICES, names.SERVICE_DEMANDS, parts, findings)
    rows = _rows(members, names.PROVIDED_ELSEWHERE, names.PROVIDED_SERVICES, parts, findings)
    return tuple(RequiredService(*row) for row in rows)


def provided_services(
    consert: Element, parts: ConSertParts, findings: EddiFindings
) -> tuple[ProvidedService, ...]:
    """Return the services that the guarantees provide, in the order of their first use."""
    guarantees = findings.document.children(consert, names.GUARANTEES)
    wanted = names.PROVIDED_SERVICES
    members = _referred(guarantees, names.PROVIDED_SERVICE, wanted, parts, findings)
    members |= _listed(consert, wanted, names.SERVICE_GUARANTEES, parts, findings)
    rows = _rows(members, names.ALLOCATED, names.REQUIRED_SERVICES, parts, findings)
    return tuple(ProvidedService(*row) for row in rows)


def _rows(
    members: Mapping[Element, list[str]],
    allocation: Spelling,
    wanted: Spelling,
    parts: ConSertParts,
    findings: EddiFindings,
) -> Iterator[_Row]:
    """Yield what is known of each service that has a name and a type."""
    parts.services += members
    for service, ids in members.items():
        name = node_name(service, findings)
        kind = _service_type(service, findings) if name else None
        if name and kind:
            place = findings.document.place(service)
            others = findings.targets(service, allocation, wanted)
            yield name, kind, tuple(ids), place, tuple(map(findings.document.place, others))


def _referred(
    elements: Iterable[Element],
    link: Spelling,
    wanted: Spelling,
    parts: ConSertParts,
    findings: EddiFindings,
) -> dict[Element, list[str]]:
    """Return the services that elements refer to, with the ids of these elements."""
    members: dict[Element, list[str]] = {}
    for element in elements:
        for service in findings.targets(element, link, wanted):
            if element in parts.ids:
                members.setdefault(service, []).append(parts.ids[element])
    return members


def _listed(
    consert: Element, feature: Spelling, link: Spelling, parts: ConSertParts, findings: EddiFindings
) -> dict[Element, list[str]]:
    """Return the services of the configuration around a ConSert, with the ids that they list."""
    configuration = consert.getparent()
    document = findings.document
    if configuration is None or not names.CONFIGURATIONS.accepts(document.feature(configuration)):
        return {}
    members: dict[Element, list[str]] = {}
    for service in document.children(configuration, feature):
        found, problems, _ = document.targets(service, link)
        findings.add(*problems)
        members[service] = []
        for end in found:
            if end in parts.ids and link.accepts(document.feature(end)):
                members[service].append(parts.ids[end])
            elif end.getparent() is not consert or not link.accepts(document.feature(end)):
                findings.report(
                    "X009.other_configuration",
                    service,
                    link=link.name,
                    actual=document.describe(end),
                )
    return members


def _service_type(service: Element, findings: EddiFindings) -> str | None:
    child = findings.only(service, names.SERVICE_TYPE)
    kind = findings.document.attribute(child, names.NAME) if child is not None else None
    if kind:
        return kind
    owner = findings.document.describe(service)
    findings.report("X010.service_type", service, owner=owner)
    return None


_PROPERTY_PARTS = (names.PROPERTY, names.SAFETY_PROPERTIES, names.INTEGRITY_LEVEL)
_DIMENSION_PARTS = (
    names.DIMENSION_TYPE,
    names.PUBLIC_TYPE,
    names.COVERED,
    names.SUBSET,
    names.UNIT,
    names.PUBLIC_UNIT,
    names.VALUE,
    names.START,
    names.END,
)
_BOUNDARY_PARTS = (names.INCLUSIVE, names.VALUE)
_KNOWN: Mapping[Spelling, tuple[Spelling, ...]] = {
    names.CONSERTS: (
        names.GUARANTEES,
        names.DEMANDS,
        names.EVIDENCE,
        names.GATES,
        names.PROPAGATIONS,
        names.INVARIANT,
        names.SERVICE_CONFIGURATION,
        names.PROPERTY_TYPES,
    ),
    names.GUARANTEES: (
        names.PROVIDED_SERVICE,
        names.DEFAULT,
        names.RANKING,
        names.REQUIREMENT,
        *_PROPERTY_PARTS,
    ),
    names.DEMANDS: (
        names.REQUIRED_SERVICE,
        names.RELATIONS,
        names.REQUIREMENT,
        *_PROPERTY_PARTS,
    ),
    names.EVIDENCE: (names.EVENTS, names.REQUIREMENT, *_PROPERTY_PARTS),
    names.GATES: (names.GATE_TYPE,),
    names.INVARIANT: (names.GATE_TYPE,),
    names.PROPAGATIONS: (names.SOURCE, names.TARGET),
    names.PROPERTY: (names.PROPERTY_TYPE, names.DIMENSION, names.REQUIREMENT),
    names.SAFETY_PROPERTIES: (names.REFINEMENT, names.INTEGRITY_LEVEL),
    names.DIMENSION: _DIMENSION_PARTS,
    names.COVERED: (names.VALUE, names.START, names.END, names.INCLUSIVE),
    names.START: _BOUNDARY_PARTS,
    names.END: _BOUNDARY_PARTS,
    names.VALUE: (names.NUMBER, names.NUMBER_TYPE, names.EPSILON),
    names.RELATIONS: (names.RELATION_TYPE, names.DIMENSION),
    names.DIMENSION_TYPE: (),
    names.PUBLIC_TYPE: (),
    names.REFINEMENT: (),
}
"""Feature -> what an object there may have besides the common names."""


def check_consert_names(consert: Element, findings: EddiFindings) -> None:
    """Report names below a ConSert that are misspelt or unknown, once per name and file."""
    waiting: list[tuple[Element, Spelling]] = [(consert, names.CONSERTS)]
    while waiting:
        element, feature = waiting.pop()
        known = (*_KNOWN[feature], *names.COMMON)
        for key in map(str, element.attrib):
            if not key.startswith("{"):
                _match(key, "attribute", known, element, findings)
        found: list[tuple[Element, Spelling]] = []
        for child in element.iterchildren():
            name = local_name(str(child.tag))
            match = _match(name, "child", known, child, findings)
            if match is not None and match in _KNOWN:
                found.append((child, match))
        waiting += reversed(found)


def check_stray_text(parts: Sequence[Element], findings: EddiFindings) -> None:
    """Report character data around these parts of a file: between objects there should be none."""
    roots = frozenset(findings.document.roots)
    texts = [found for root in findings.document.roots for found in stray_texts(root, deep=False)]
    for top in dict.fromkeys(_top(part, roots) for part in parts):
        texts += stray_texts(top)
    for element, text in texts:
        findings.count("X006.text", element, text=text[:20])


def _top(part: Element, roots: Container[Element]) -> Element:
    """Return the child of a root that a part lies in."""
    parent = part.getparent()
    while parent is not None and parent not in roots:
        part, parent = parent, parent.getparent()
    return part


def _match(
    name: str, what: str, known: Sequence[Spelling], element: Element, findings: EddiFindings
) -> Spelling | None:
    """Return the feature that a printed name means."""
    match = next((spelling for spelling in known if spelling.accepts(name)), None)
    if match is None:
        owner = element.getparent() if what == "child" else element
        place = findings.document.feature(owner) if owner is not None else "the root"
        findings.count("X006.unknown", element, subject=what, name=name, owner=place)
    elif not match.is_exact(name):
        case = "X006.misprint" if is_misprint(name) else "X006.spelling"
        findings.count(case, element, subject=what, name=name, meant=match.name)
    return match


def read_eddi(
    document: EddiDocument, source: Source, default_guarantees: Sequence[str] = ()
) -> tuple[tuple[ConSert, ...], list[Problem]]:
    """Read every ConSert of a document, in document order.

    Args:
        document: the parsed file.
        source: the same file; its stem names a ConSert without a name.
        default_guarantees: ids, or ``CONSERT/ID``, of guarantees that are marked as default.

    Returns:
        The ConSerts without an error of the XML form, and all problems found. A file without
        ConSerts gives neither.
    """
    findings = EddiFindings(document)
    conserts: list[ConSert] = []
    parts: list[Element] = []
    first: dict[str, Element] = {}
    _check_untyped(document, findings)
    for element in consert_elements(document):
        _check_class(element, findings)
        consert, services = _consert(element, source, findings)
        parts += [element, *services]
        name = _name(element, source, document)
        if name in first:
            line = document.place(first[name]).line
            findings.report("C007.duplicate_name", element, name=name, line=line)
        elif consert is not None:
            conserts.append(consert)
        first.setdefault(name, element)
    if parts:
        check_stray_text(parts, findings)
        _count_misprints(parts[0], findings)
    marked, unclear = with_default_guarantees(
        conserts, default_guarantees if parts else (), source.name
    )
    return marked, [*findings.problems(), *unclear]


def consert_elements(document: EddiDocument) -> Iterator[Element]:
    """Yield the elements that hold a ConSert, of both dialects, in document order."""
    for package in document.packages():
        stated = document.class_of(package)
        if stated.name == names.CONSERT_CLASS and document.is_root(package):
            yield package
        elif stated.name == names.PACKAGE_CLASS:
            yield from document.children(package, names.CONSERTS)
        elif stated.name == names.SYSTEM_CLASS:
            for configuration in document.children(package, names.CONFIGURATIONS):
                yield from document.children(configuration, names.CONSERTS)


def _consert(
    element: Element, source: Source, findings: EddiFindings
) -> tuple[ConSert | None, list[Element]]:
    """Read one ConSert; ``None`` when it has an error. Also return its services."""
    errors = findings.errors
    check_consert_names(element, findings)
    parts = read_parts(element, findings)
    required = required_services(element, parts, findings)
    provided = provided_services(element, parts, findings)
    if findings.errors > errors:
        return None, parts.services
    consert = ConSert(
        _name(element, source, findings.document),
        tuple(parts.guarantees),
        tuple(parts.demands),
        tuple(parts.evidence),
        tuple(parts.gates),
        tuple(parts.edges),
        required,
        provided,
        findings.document.place(element),
        _system(element, findings),
    )
    return consert, parts.services


def _system(element: Element, findings: EddiFindings) -> str:
    """Return the name of the system whose configuration of services a ConSert is for."""
    wanted = names.SERVICE_CONFIGURATIONS
    found = findings.targets(element, names.SERVICE_CONFIGURATION, wanted)
    systems = [configuration.getparent() for configuration in found]
    return next((system.get("name") or "" for system in systems if system is not None), "")


def _name(element: Element, source: Source, document: EddiDocument) -> str:
    return document.attribute(element, names.NAME) or source.stem


def _check_class(element: Element, findings: EddiFindings) -> None:
    package = element.getparent()
    printed = findings.document.class_of(package).printed if package is not None else ""
    if package is not None and is_misprint(local_name(printed)):
        findings.count("X006.class", package, class_name=printed)


def _check_untyped(document: EddiDocument, findings: EddiFindings) -> None:
    """Refuse packages that contain ConSerts and are not declared as ConSert packages."""
    for package in document.packages():
        if not document.class_of(package).name and any(
            names.CONSERTS.accepts(document.feature(child)) for child in package.iterchildren()
        ):
            findings.report("X010.package_type", package)


def _count_misprints(element: Element, findings: EddiFindings) -> None:
    for (printed, intended), times in findings.document.references.misprints.items():
        case = "X006.path_misprint" if is_misprint(printed) else "X006.path_spelling"
        findings.count(case, element, times, name=printed, meant=intended)

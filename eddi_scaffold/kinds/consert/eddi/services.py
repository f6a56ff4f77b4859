"""Services of a ConSert in EDDI XML: referred to by its demands and guarantees, or listing them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eddi_scaffold.kinds.consert.eddi.parts import node_name
from eddi_scaffold.kinds.consert.model import ProvidedService, RequiredService
from eddi_scaffold.readers import vocabulary as names

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from eddi_scaffold.kinds.consert.eddi.parts import ConSertParts
    from eddi_scaffold.problems import Place
    from eddi_scaffold.readers.findings import EddiFindings
    from eddi_scaffold.readers.spelling import Spelling
    from eddi_scaffold.readers.xmi import Element

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
                message = (
                    f"{link.name} points at {document.describe(end)}, expected one of "
                    f"{link.name} of the ConSert of this configuration"
                )
                findings.error("X009", message, service)
    return members


def _service_type(service: Element, findings: EddiFindings) -> str | None:
    child = findings.only(service, names.SERVICE_TYPE)
    kind = findings.document.attribute(child, names.NAME) if child is not None else None
    if kind:
        return kind
    owner = findings.document.describe(service)
    message = f"the type of {owner} is missing: a child serviceType with a name"
    findings.error("X010", message, service)
    return None

"""ConSerts from EDDI XML: the extension of SESAME D7.2 (Figs 4 and 36) and the older dialect.

What only XML can get wrong is reported here (codes X and C003, C006, C007 of the XML form); what
ConSerts of any source can get wrong is reported by ``check``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from eddi_scaffold.kinds.consert.default_guarantees import mark_defaults
from eddi_scaffold.kinds.consert.eddi.names import check_consert_names, check_stray_text
from eddi_scaffold.kinds.consert.eddi.parts import read_parts
from eddi_scaffold.kinds.consert.eddi.services import provided_services, required_services
from eddi_scaffold.kinds.consert.model import ConSert
from eddi_scaffold.readers import vocabulary as names
from eddi_scaffold.readers.findings import EddiFindings
from eddi_scaffold.readers.spelling import is_misprint, local_name

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from eddi_scaffold.problems import Level, Problem
    from eddi_scaffold.readers.document import EddiDocument
    from eddi_scaffold.readers.xmi import Element
    from eddi_scaffold.source import Source


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
            message = f'the ConSert name "{name}" is used twice, first in line {line}'
            findings.error("C007", message, element, "rename one of them")
        elif consert is not None:
            conserts.append(consert)
        first.setdefault(name, element)
    if parts:
        check_stray_text(parts, findings)
        _count_misprints(parts[0], findings)
    marked, unclear = mark_defaults(conserts, default_guarantees if parts else (), source.name)
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
    return next((one.get("name") or "" for one in systems if one is not None), "")


def _name(element: Element, source: Source, document: EddiDocument) -> str:
    return document.attribute(element, names.NAME) or source.stem


def _check_class(element: Element, findings: EddiFindings) -> None:
    package = element.getparent()
    printed = findings.document.class_of(package).printed if package is not None else ""
    if package is not None and is_misprint(local_name(printed)):
        message = f'class "{printed}" is read as "ConSertPackage"'
        findings.count("warning", "X006", message, package)


def _check_untyped(document: EddiDocument, findings: EddiFindings) -> None:
    """Refuse packages that contain ConSerts and are not declared as ConSert packages."""
    for package in document.packages():
        if not document.class_of(package).name and any(
            names.CONSERTS.accepts(document.feature(child)) for child in package.iterchildren()
        ):
            message = "the xsi:type of a package with conSerts is missing"
            findings.error("X010", message, package, "expected a ConSertPackage")


def _count_misprints(element: Element, findings: EddiFindings) -> None:
    for (printed, intended), times in findings.document.references.misprints.items():
        level: Level = "warning" if is_misprint(printed) else "info"
        message = f'"{printed}" in a path is read as "{intended}"'
        findings.count(level, "X006", message, element, times)

"""Remarks about names and texts that the reader of ConSerts does not use: X006, X013, X015."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eddi_scaffold.readers import vocabulary as names
from eddi_scaffold.readers.spelling import Spelling, is_misprint, local_name
from eddi_scaffold.readers.xmi import stray_texts

if TYPE_CHECKING:
    from collections.abc import Container, Mapping, Sequence

    from eddi_scaffold.problems import Level
    from eddi_scaffold.readers.findings import EddiFindings
    from eddi_scaffold.readers.xmi import Element

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
        findings.count("warning", "X013", f'unexpected text "{text[:20]}"', element)


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
        findings.count("info", "X015", f'unknown {what} "{name}" of {place} is ignored', element)
    elif not match.is_exact(name):
        level: Level = "warning" if is_misprint(name) else "info"
        message = f'{what} "{name}" is read as "{match.name}"'
        findings.count(level, "X006", message, element)
    return match

"""Dimensions of ConSerts in EDDI XML: the SESAME form, and English in the older dialect."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from eddi_scaffold.kinds.consert.eddi import vocabulary as names
from eddi_scaffold.kinds.consert.english import read_english
from eddi_scaffold.kinds.consert.model import (
    BinaryDimension,
    Bound,
    CategoricalDimension,
    Dimension,
    NumericDimension,
    Range,
    Subset,
)

if TYPE_CHECKING:
    from eddi_scaffold.readers.findings import EddiFindings
    from eddi_scaffold.readers.spelling import Spelling
    from eddi_scaffold.readers.xmi import Element

_NUMBER = re.compile(r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
_INFINITE = re.compile(r"(?i)([-+]?)\.?inf(?:inity)?")
_SUBSETS: dict[str, Subset] = {"guarantee": "Guarantee", "demand": "Demand"}
_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}


def sesame_dimensions(element: Element, findings: EddiFindings) -> tuple[Dimension, ...]:
    """Read the dimensions of a guarantee, demand or evidence, those of all its properties."""
    document = findings.document
    dimensions = []
    for part in document.children(element, names.PROPERTY):
        _check_property_type(part, findings)
        for child in document.children(part, names.DIMENSION):
            dimension = _dimension(child, findings)
            if dimension is not None:
                dimensions.append(dimension)
    return tuple(dimensions)


def english_dimensions(element: Element, findings: EddiFindings) -> tuple[Dimension, ...]:
    """Read the refinements of the safety properties of a guarantee or demand."""
    document = findings.document
    dimensions = []
    for part in document.children(element, names.SAFETY_PROPERTIES):
        for refinement in document.children(part, names.REFINEMENT):
            text = document.attribute(refinement, names.NAME)
            if text is None or not text.strip():
                findings.error(
                    "X010", "a refinement has no name to read a property from", refinement
                )
            else:
                dimensions.append(english_dimension(text, refinement, findings))
    return tuple(dimensions)


def english_dimension(text: str, element: Element, findings: EddiFindings) -> Dimension:
    """Read one English text."""
    read = read_english(text)
    if read.remark is not None:
        message = f'the bound in "{_shortened(text)}" cannot be read: {read.remark}'
        hint = f'it is taken as the binary property "{read.dimension.type}"'
        findings.warning("X014", message, element, hint)
    return read.dimension


def read_boolean(value: str, what: str, element: Element, findings: EddiFindings) -> bool | None:
    """Read ``true`` or ``false``; ``None`` and X011 for anything else."""
    found = _BOOLEANS.get(value.strip().casefold())
    if found is None:
        findings.error("X011", f'{what} is "{_shortened(value)}", allowed: true, false', element)
    return found


def _check_property_type(part: Element, findings: EddiFindings) -> None:
    document = findings.document
    found, problems, _ = document.targets(part, names.PROPERTY_TYPE)
    findings.add(*problems)
    for target in found:
        if not names.PROPERTY_TYPES.accepts(document.feature(target)):
            message = (
                f"dependabilityPropertyType points at {document.describe(target)}, "
                "expected one of dependabilityPropertyTypes"
            )
            findings.error("X009", message, part)


def _dimension(element: Element, findings: EddiFindings) -> Dimension | None:
    stated = findings.document.class_of(element)
    allowed = "BinaryDimension, CategoricalDimension, NumericDimension"
    if not stated.name:
        findings.error("X010", f"a dimension has no xsi:type; allowed: {allowed}", element)
        return None
    shape = stated.name.removesuffix("dimension")
    if shape not in ("binary", "categorical", "numeric"):
        findings.error("X011", f'xsi:type is "{stated.printed}", allowed: {allowed}', element)
        return None
    kind = _dimension_type(element, findings)
    if kind is None:
        return None
    place = findings.document.place(element)
    if shape == "binary":
        return BinaryDimension(kind, place)
    subset = _subset(element, findings)
    parts = findings.document.children(element, names.COVERED)
    if shape == "categorical":
        values = [_mandatory(part, names.VALUE, findings) for part in parts]
        return CategoricalDimension(kind, tuple(v for v in values if v is not None), subset, place)
    ranges = [_range(part, findings) for part in parts]
    unit = findings.document.attribute(element, names.UNIT)
    covered = tuple(r for r in ranges if r is not None)
    return NumericDimension(kind, covered, subset, unit, place)


def _dimension_type(element: Element, findings: EddiFindings) -> str | None:
    document = findings.document
    child = findings.only(element, names.DIMENSION_TYPE)
    kind = document.attribute(child, names.NAME) if child is not None else None
    kind = kind or document.attribute(element, names.DIMENSION_TYPE_ATTRIBUTE)
    if not kind:
        message = "a dimension has no type: a child dimensionType with a name is missing"
        findings.error("X010", message, element)
    return kind or None


def _subset(element: Element, findings: EddiFindings) -> Subset:
    text = findings.document.attribute(element, names.SUBSET)
    if text is None:
        message = "subset is absent, taken as Guarantee (a demand asks at most)"
        findings.warning("X014", message, element, 'write subset="Guarantee" or subset="Demand"')
        return "Guarantee"
    subset = _SUBSETS.get(text.strip().casefold())
    if subset is None:
        message = f'subset is "{_shortened(text)}", allowed: Guarantee, Demand'
        findings.error("X011", message, element)
    return subset or "Guarantee"


def _range(part: Element, findings: EddiFindings) -> Range | None:
    start = _bound(part, names.START, findings)
    end = _bound(part, names.END, findings)
    text = findings.document.attribute(part, names.INCLUSIVE)
    inclusive: bool | None = True
    if text is not None:
        inclusive = read_boolean(text, "inclusive", part, findings)
    else:
        message = "inclusive is absent, taken as true (the end lies inside)"
        findings.warning("X014", message, part, 'write inclusive="true" or inclusive="false"')
    if start is None or end is None or inclusive is None:
        return None
    return Range(start, end, inclusive, findings.document.place(part))


def _bound(part: Element, spelling: Spelling, findings: EddiFindings) -> Bound | None:
    text = _mandatory(part, spelling, findings)
    if text is None:
        return None
    text = text.strip()
    infinite = _INFINITE.fullmatch(text)
    if infinite:
        sign = infinite.group(1).replace("+", "")
        return Bound(f"{sign}inf", float(f"{sign}inf"))
    if _NUMBER.fullmatch(text) and not math.isinf(float(text)):
        return Bound(text, float(text))
    message = f'{spelling.name} is "{_shortened(text)}", allowed: a decimal number, inf, -inf'
    findings.error("X011", message, part)
    return None


def _mandatory(element: Element, spelling: Spelling, findings: EddiFindings) -> str | None:
    value = findings.document.attribute(element, spelling)
    if value is None:
        owner = findings.document.describe(element)
        findings.error("X010", f'the attribute "{spelling.name}" of {owner} is missing', element)
    return value


def _shortened(text: str) -> str:
    return text if len(text) <= 60 else f"{text[:57]}..."

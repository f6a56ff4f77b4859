"""Dimensions of ConSerts in EDDI XML: the forms of SESAME, and English in the older dialect.

In DEIS 2019 ``Communication Delay bound to < 300.5 ms: ASIL B`` is a numeric dimension with an
integrity level. Rules: those of conserts-rs 0.1.6, except that an open bound is infinite, that
``> x`` excludes x, and that a bound which cannot be read gives a binary dimension and a remark.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from eddi_scaffold.common.units import find as find_unit
from eddi_scaffold.eddi_xml import vocabulary as names
from eddi_scaffold.kinds.consert.model import (
    BinaryDimension,
    Bound,
    CategoricalDimension,
    Dimension,
    NumericDimension,
    Range,
    Subset,
)
from eddi_scaffold.kinds.consert.names import class_name

if TYPE_CHECKING:
    from collections.abc import Mapping

    from eddi_scaffold.eddi_xml.findings import EddiFindings
    from eddi_scaffold.eddi_xml.parsing import Element
    from eddi_scaffold.eddi_xml.vocabulary import Spelling


_NUMBER = re.compile(r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
_INFINITE = re.compile(r"(?i)([-+]?)\.?inf(?:inity)?")
_SUBSETS: dict[str, Subset] = {"guarantee": "Guarantee", "demand": "Demand"}
_RELATION_TYPES: dict[str, Subset] = {
    "DinG": "Demand",
    "GinD": "Guarantee",
    "Equals": "Equals",
    "IntersectionNotEmpty": "Intersection",
}
_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}
# The first of this order that occurs anywhere wins, as in the peer.
_OPERATORS = ("<=", ">=", "<", ">", "bound to")
_BOUND = re.compile(r"([0-9]+(?:\.[0-9]*)?|\.[0-9]+)\s*(\S+)?")
_ZERO = Bound("0.0", 0.0)
_INFINITY = Bound("inf", math.inf)


def sesame_dimensions(element: Element, findings: EddiFindings) -> tuple[Dimension, ...]:
    """Read the dimensions of a guarantee, demand or evidence, those of all its properties."""
    document = findings.document
    dimensions: dict[Element, Dimension | None] = {}
    for part in document.children(element, names.PROPERTY):
        findings.targets(part, names.PROPERTY_TYPE, names.PROPERTY_TYPES)
        for child in document.children(part, names.DIMENSION):
            dimensions[child] = _dimension(child, findings)
    related = _relations(element, dimensions, findings)
    is_demand = names.DEMANDS.accepts(document.feature(element))
    return tuple(
        _with_relation(child, dimension, related.get(child), findings) if is_demand else dimension
        for child, dimension in dimensions.items()
        if dimension is not None
    )


def english_dimensions(element: Element, findings: EddiFindings) -> tuple[Dimension, ...]:
    """Read the refinements of the safety properties of a guarantee or demand."""
    document = findings.document
    dimensions = []
    for part in document.children(element, names.SAFETY_PROPERTIES):
        for refinement in document.children(part, names.REFINEMENT):
            text = document.attribute(refinement, names.NAME)
            if text is None or not text.strip():
                findings.report("X010.refinement", refinement)
            else:
                dimensions.append(english_dimension(text, refinement, findings))
    return tuple(dimensions)


def english_dimension(text: str, element: Element, findings: EddiFindings) -> Dimension:
    """Read one English text."""
    read = read_english(text)
    if read.remark is not None:
        findings.report(
            "X014.bound",
            element,
            text=_shortened(text),
            reason=read.remark,
            type=read.dimension.type,
        )
    return read.dimension


def read_boolean(value: str, what: str, element: Element, findings: EddiFindings) -> bool | None:
    """Read ``true`` or ``false``; ``None`` and X011 for anything else."""
    found = _BOOLEANS.get(value.strip().casefold())
    if found is None:
        findings.report("X011.boolean", element, subject=what, value=_shortened(value))
    return found


def _dimension(element: Element, findings: EddiFindings) -> Dimension | None:
    document = findings.document
    stated = document.class_of(element)
    allowed = "BinaryDimension, CategoricalDimension, NumericDimension, NumericRangeDimension"
    if not stated.name:
        findings.report("X010.dimension", element, allowed=allowed)
        return None
    shape = stated.name.removesuffix("dimension").removesuffix("range")
    if shape not in ("binary", "categorical", "numeric"):
        findings.report("X011.type", element, type_name=stated.printed, allowed=allowed)
        return None
    kind = _dimension_type(element, findings)
    if kind is None:
        return None
    place = document.place(element)
    if shape == "binary":
        return BinaryDimension(kind, place, _binary_value(element, kind, findings))
    parts = document.children(element, names.COVERED)
    is_public = _is_public(element, findings)
    subset = _subset(element, findings, is_public=is_public)
    if shape == "categorical":
        category = names.NAME if is_public else names.VALUE
        values = [_mandatory(part, category, findings) for part in parts]
        return CategoricalDimension(kind, tuple(v for v in values if v is not None), subset, place)
    if is_public:
        ranges = [_public_range(element, findings)]
    else:
        ranges = [_range(part, findings) for part in parts]
    covered = tuple(r for r in ranges if r is not None)
    unit = _unit(element, kind, findings, is_public=is_public)
    return NumericDimension(kind, covered, subset, unit, place)


def _is_public(element: Element, findings: EddiFindings) -> bool:
    """Tell whether a dimension is written with names of the public metamodel of SESAME.

    X011 where one thing is written in both ways.
    """
    document = findings.document
    covered = document.children(element, names.COVERED)
    ends = [*document.children(element, names.START), *document.children(element, names.END)]
    for part in covered:
        if document.attribute_name(part, names.NAME) and document.attribute_name(part, names.VALUE):
            findings.report("X011.name_or_value", part)
    if ends and covered:
        findings.report("X011.covered_or_ends", element)
    if not covered:
        return bool(ends) or document.class_of(element).name.endswith("rangedimension")
    return bool(ends) or any(document.attribute_name(one, names.NAME) for one in covered)


def _dimension_type(element: Element, findings: EddiFindings) -> str | None:
    document = findings.document
    child = findings.only(element, names.DIMENSION_TYPE)
    public = findings.only(element, names.PUBLIC_TYPE)
    if child is not None and public is not None:
        findings.report("X011.type_or_dimension_type", element)
    child = public if child is None else child
    kind = document.attribute(child, names.NAME) if child is not None else None
    kind = kind or document.attribute(element, names.PUBLIC_TYPE)
    if not kind:
        findings.report("X010.dimension_child", element)
    return kind or None


def _binary_value(element: Element, kind: str, findings: EddiFindings) -> bool:
    text = findings.document.attribute(element, names.VALUE)
    if text is not None:
        return read_boolean(text, "value", element, findings) is not False
    if not findings.document.children(element, names.PUBLIC_TYPE):
        return True
    findings.report("X014.value", element, kind=kind)
    return False


def _subset(element: Element, findings: EddiFindings, *, is_public: bool) -> Subset | None:
    document = findings.document
    text = document.attribute(element, names.SUBSET)
    if text is not None:
        subset = _SUBSETS.get(text.strip().casefold())
        if subset is None:
            findings.report("X011.subset", element, text=_shortened(text))
        return subset or "Guarantee"
    if document.children(element, names.PUBLIC_TYPE) or is_public:
        return None  # the demand says it, by a relation
    findings.report("X014.subset", element)
    return "Guarantee"


def _relations(
    owner: Element, dimensions: Mapping[Element, Dimension | None], findings: EddiFindings
) -> dict[Element, Subset]:
    """Return what the relation elements of a demand say of its dimensions."""
    document = findings.document
    related: dict[Element, Subset] = {}
    for part in document.children(owner, names.RELATIONS):
        text = document.attribute(part, names.RELATION_TYPE)
        allowed = ", ".join(_RELATION_TYPES)
        # EMF omits the first literal of an enumeration.
        relation = _RELATION_TYPES.get("DinG" if text is None else text.strip())
        if relation is None:
            findings.report(
                "X011.relation_type", part, text=_shortened(text or ""), allowed=allowed
            )
            continue
        ends, problems, present = document.targets(part, names.DIMENSION)
        findings.add(*problems)
        if not present and len(dimensions) == 1:
            ends = list(dimensions)
        elif not present:
            findings.report("X010.relation_dimension", part)
        for end in ends:
            if end in dimensions:
                related[end] = relation
            else:
                findings.report("X009.dimension", part, actual=document.describe(end))
    return related


def _with_relation(
    element: Element, dimension: Dimension, relation: Subset | None, findings: EddiFindings
) -> Dimension:
    """Return a dimension of a demand with its relation to what fulfils it."""
    if isinstance(dimension, BinaryDimension):
        return dimension
    if dimension.subset is not None and relation is not None:
        findings.report("X011.subset_or_relation", element)
    if dimension.subset is not None:
        return dimension
    if relation is None:
        findings.report("X014.relation", element, type=dimension.type)
    return replace(dimension, subset=relation or "Equals")


def _unit(element: Element, kind: str, findings: EddiFindings, *, is_public: bool) -> str | None:
    document = findings.document
    text = document.attribute(element, names.PUBLIC_UNIT)
    text = document.attribute(element, names.UNIT) if text is None else text
    if text is None and is_public:
        findings.report("X014.unit", element, kind=kind, units=", ".join(names.PUBLIC_UNITS))
        return names.PUBLIC_UNITS["MPS"]
    return None if text is None else names.PUBLIC_UNITS.get(text.strip(), text)


def _public_range(element: Element, findings: EddiFindings) -> Range | None:
    errors = findings.errors
    start, is_start_inside = _boundary(element, names.START, "-inf", findings)
    end, is_end_inside = _boundary(element, names.END, "inf", findings)
    if findings.errors > errors:
        return None
    place = findings.document.place(element)
    return Range(start, end, is_end_inside, place, is_start_inside)


def _boundary(
    element: Element, spelling: Spelling, unbounded: str, findings: EddiFindings
) -> tuple[Bound, bool]:
    """Return one end of a range and whether it lies inside; absent, there is no bound."""
    document = findings.document
    nothing = Bound(unbounded, float(unbounded)), True
    part = findings.only(element, spelling)
    if part is None:
        return nothing
    value = findings.only(part, names.VALUE)
    text = document.attribute(part, names.INCLUSIVE)
    is_inside = text is not None and read_boolean(text, "inclusive", part, findings)
    if value is None:
        findings.report("X010.nil", part, feature=spelling.name)
        return nothing
    epsilon = document.attribute(value, names.EPSILON)
    if epsilon is not None and epsilon.strip() not in ("0", "0.0"):
        findings.count("X014.epsilon", value, epsilon=_shortened(epsilon))
    if document.attribute(value, names.NUMBER_TYPE) is not None:
        findings.count("X014.number_type", value)
    number = document.attribute(value, names.NUMBER)
    bound = Bound("0", 0.0) if number is None else _number(number, names.NUMBER, value, findings)
    return bound or nothing[0], bool(is_inside)


def _range(part: Element, findings: EddiFindings) -> Range | None:
    start = _bound(part, names.START, findings)
    end = _bound(part, names.END, findings)
    text = findings.document.attribute(part, names.INCLUSIVE)
    inclusive: bool | None = True
    if text is not None:
        inclusive = read_boolean(text, "inclusive", part, findings)
    else:
        findings.report("X014.inclusive", part)
    if start is None or end is None or inclusive is None:
        return None
    return Range(start, end, inclusive, findings.document.place(part))


def _bound(part: Element, spelling: Spelling, findings: EddiFindings) -> Bound | None:
    text = _mandatory(part, spelling, findings)
    return None if text is None else _number(text, spelling, part, findings)


def _number(text: str, spelling: Spelling, part: Element, findings: EddiFindings) -> Bound | None:
    text = text.strip()
    infinite = _INFINITE.fullmatch(text)
    if infinite:
        sign = infinite.group(1).replace("+", "")
        return Bound(f"{sign}inf", float(f"{sign}inf"))
    if _NUMBER.fullmatch(text) and not math.isinf(float(text)):
        return Bound(text, float(text))
    findings.report("X011.decimal", part, attribute=spelling.name, text=_shortened(text))
    return None


def _mandatory(element: Element, spelling: Spelling, findings: EddiFindings) -> str | None:
    value = findings.document.attribute(element, spelling)
    if value is None:
        owner = findings.document.describe(element)
        findings.report("X010.attribute", element, attribute=spelling.name, owner=owner)
    return value


def _shortened(text: str) -> str:
    return text if len(text) <= 60 else f"{text[:57]}..."


@dataclass(frozen=True)
class EnglishDimension:
    """Meaning of one text.

    Attributes:
        dimension: the dimension.
        integrity_level: the text behind the first colon (``ASIL D``), ``None`` without one.
        remark: why a bound could not be read, ``None`` when all is well.
    """

    dimension: Dimension
    integrity_level: str | None = None
    remark: str | None = None


def read_english(text: str) -> EnglishDimension:
    """Read a dimension from English text."""
    statement, colon, level = text.partition(":")
    statement = statement.strip()
    integrity_level = level.strip() or None if colon else None
    operator = next((o for o in _OPERATORS if o in statement), None)
    if operator is None:
        remark = "there is no operator <=, >=, <, > or bound to" if "=" in statement else None
        return EnglishDimension(_binary(statement), integrity_level, remark)
    subject, _, rest = statement.partition(operator)
    bound = _BOUND.fullmatch(rest.strip())
    remark = _objection(subject, rest, bound)
    if bound is None or remark is not None:
        return EnglishDimension(_binary(statement), integrity_level, remark)
    covered = _english_range(operator, Bound(bound.group(1), float(bound.group(1))))
    kind = class_name(subject)
    dimension = NumericDimension(kind, (covered,), "Guarantee", bound.group(2))
    return EnglishDimension(dimension, integrity_level)


def _objection(subject: str, rest: str, bound: re.Match[str] | None) -> str | None:
    if bound is None:
        return f'"{rest.strip()}" is not a number with a unit'
    unit = bound.group(2)
    if unit is not None and find_unit(unit) is None:
        return f'the unit "{unit}" is unknown'
    return None if class_name(subject) else "there is nothing before the operator"


def _binary(statement: str) -> BinaryDimension:
    return BinaryDimension(class_name(statement) or statement)


def _english_range(operator: str, bound: Bound) -> Range:
    if operator == ">=":
        return Range(bound, _INFINITY, inclusive=True)
    if operator == ">":
        # A range always contains its start, so it starts at the next double.
        above = math.nextafter(bound.value, math.inf)
        return Range(Bound(repr(above), above), _INFINITY, inclusive=True)
    return Range(_ZERO, bound, inclusive=operator != "<")

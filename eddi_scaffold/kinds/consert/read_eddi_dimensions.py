"""Dimensions of ConSerts in EDDI XML: the forms of SESAME, and English in the older dialect.

In DEIS 2019 ``Communication Delay bound to < 300.5 ms: ASIL B`` is a numeric dimension with an
integrity level. Rules: those of conserts-rs 0.1.6, except that an open bound is infinite, that
``> x`` excludes x, and that a bound which cannot be read gives a binary dimension and a remark.

After an error there is a placeholder, which nobody sees: no ConSert is made of such an element.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

from eddi_scaffold.common import units
from eddi_scaffold.eddi_xml import vocabulary as names
from eddi_scaffold.eddi_xml.document import EddiFindings
from eddi_scaffold.eddi_xml.parsing import Element, feature_of
from eddi_scaffold.eddi_xml.vocabulary import Spelling
from eddi_scaffold.kinds.consert import class_name
from eddi_scaffold.kinds.consert import consert as model

_NUMBER = re.compile(r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
_INFINITE = re.compile(r"(?i)([-+]?)\.?inf(?:inity)?")
_SUBSETS: dict[str, model.Subset] = {"guarantee": "Guarantee", "demand": "Demand"}
_PUBLIC_UNITS = {
    "MPS": "m/s",
    "KMH": "km/h",
    "METER": "m",
    "KILOMETER": "km",
    "SECOND": "s",
    "NEWTON": "N",
}
_RELATIONS: dict[str, model.Subset] = {
    "DinG": "Demand",
    "GinD": "Guarantee",
    "Equals": "Equals",
    "IntersectionNotEmpty": "Intersection",
}
_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}
_CLASSES = "BinaryDimension, CategoricalDimension, NumericDimension, NumericRangeDimension"
_PLACEHOLDER = model.BinaryDimension("")
# The first of this order that occurs anywhere wins, as in conserts-rs.
_OPERATORS = ("<=", ">=", "<", ">", "bound to")
_ENGLISH_BOUND = re.compile(r"([0-9]+(?:\.[0-9]*)?|\.[0-9]+)\s*(\S+)?")


class DimensionReader:
    """Reads the dimensions of guarantees, demands and evidence."""

    def __init__(self, findings: EddiFindings) -> None:
        self.findings = findings
        self.document = findings.document

    def read(self, element: Element) -> tuple[model.Dimension, ...]:
        """Read the dimensions of all properties of an element."""
        dimensions: dict[Element, model.Dimension] = {}
        for part in self.document.children(element, names.PROPERTY):
            self.findings.targets(part, names.PROPERTY_TYPE, names.PROPERTY_TYPES)
            for child in self.document.children(part, names.DIMENSION):
                dimensions[child] = self._dimension(child)
        relations = self._relations(element, dimensions)
        if names.DEMANDS.accepts(feature_of(element)):
            for child, dimension in dimensions.items():
                if isinstance(dimension, model.BinaryDimension):
                    continue
                own, relation = dimension.subset, relations.get(child)
                if own is not None and relation is not None:
                    self.findings.report("X011.subset_or_relation", child)
                if own is None and relation is None:
                    self.findings.report("X014.relation", child, type=dimension.type)
                dimensions[child] = replace(dimension, subset=own or relation or "Equals")
        all_dimensions = [*dimensions.values()]
        for part in self.document.children(element, names.SAFETY_PROPERTIES):
            for refinement in self.document.children(part, names.REFINEMENT):
                text = self.document.attribute(refinement, names.NAME)
                if text is None or not text.strip():
                    self.findings.report("X010.refinement", refinement)
                else:
                    all_dimensions.append(self.english(text, refinement))
        return tuple(all_dimensions)

    def english(self, text: str, element: Element) -> model.Dimension:
        """Read one English text."""
        dimension, is_read = read_english(text)
        if not is_read:
            fields = {"text": _shortened(text), "type": dimension.type}
            self.findings.report("X014.bound", element, **fields)
        return dimension

    def boolean(self, element: Element, spelling: Spelling) -> bool | None:
        """Read an attribute that is true or false; ``None`` where it is absent."""
        text = self.document.attribute(element, spelling)
        if text is None:
            return None
        value = _BOOLEANS.get(text.strip().casefold())
        if value is None:
            name = spelling.name
            self.findings.report("X011.boolean", element, subject=name, value=_shortened(text))
        return bool(value)

    def _dimension(self, element: Element) -> model.Dimension:
        class_of = self.document.class_of(element)
        shape = class_of.name.removesuffix("dimension").removesuffix("range")
        if not class_of.name:
            self.findings.report("X010.dimension", element, allowed=_CLASSES)
            return _PLACEHOLDER
        if shape not in ("binary", "categorical", "numeric"):
            name = class_of.printed
            self.findings.report("X011.type", element, type_name=name, allowed=_CLASSES)
            return _PLACEHOLDER
        type_, place = self._type(element), self.document.place(element)
        if shape == "binary":
            value = self.boolean(element, names.VALUE)
            if value is None and self.document.children(element, names.PUBLIC_TYPE):
                self.findings.report("X014.value", element, kind=type_)
                value = False
            return model.BinaryDimension(type_, place, value is not False)
        parts = self.document.children(element, names.COVERED)
        is_public = self._is_public(element, parts)
        text, subset = self.document.attribute(element, names.SUBSET), None
        if text is not None:
            subset = _SUBSETS.get(text.strip().casefold())
            if subset is None:
                self.findings.report("X011.subset", element, text=_shortened(text))
                subset = "Guarantee"
        elif not self.document.children(element, names.PUBLIC_TYPE) and not is_public:
            self.findings.report("X014.subset", element)
            subset = "Guarantee"  # else the demand says it, by a relation
        if shape == "categorical":
            spelling = names.NAME if is_public else names.VALUE
            categories = tuple(self._mandatory(part, spelling) for part in parts)
            return model.CategoricalDimension(type_, categories, subset, place)
        if is_public:
            start, is_start_inside = self._boundary(element, names.START, "-inf")
            end, is_end_inside = self._boundary(element, names.END, "inf")
            ranges: tuple[model.Range, ...] = (
                model.Range(start, end, is_end_inside, place, is_start_inside),
            )
        else:
            ranges = tuple(self._range(part) for part in parts)
        unit = self.document.attribute(element, names.PUBLIC_UNIT)
        unit = self.document.attribute(element, names.UNIT) if unit is None else unit
        if unit is None and is_public:
            known = ", ".join(_PUBLIC_UNITS)
            self.findings.report("X014.unit", element, kind=type_, units=known)
            unit = "MPS"
        unit = unit and _PUBLIC_UNITS.get(unit.strip(), unit)
        return model.NumericDimension(type_, ranges, subset, unit, place)

    def _is_public(self, element: Element, covered: Sequence[Element]) -> bool:
        """Tell whether a dimension is written with names of the public metamodel of SESAME.

        X011 where one thing is written in both ways.
        """
        children, attribute = self.document.children, self.document.attribute_name
        has_ends = bool(children(element, names.START) or children(element, names.END))
        for part in covered:
            if attribute(part, names.NAME) and attribute(part, names.VALUE):
                self.findings.report("X011.name_or_value", part)
        if has_ends and covered:
            self.findings.report("X011.covered_or_ends", element)
        if not covered:
            return has_ends or self.document.class_of(element).name.endswith("rangedimension")
        return has_ends or any(attribute(part, names.NAME) for part in covered)

    def _type(self, element: Element) -> str:
        child = self.findings.only(element, names.DIMENSION_TYPE)
        public = self.findings.only(element, names.PUBLIC_TYPE)
        if child is not None and public is not None:
            self.findings.report("X011.type_or_dimension_type", element)
        child = public if child is None else child
        type_ = self.document.attribute(child, names.NAME) if child is not None else None
        type_ = type_ or self.document.attribute(element, names.PUBLIC_TYPE) or ""
        if not type_:
            self.findings.report("X010.dimension_child", element)
        return type_

    def _relations(
        self, owner: Element, dimensions: Mapping[Element, model.Dimension]
    ) -> dict[Element, model.Subset]:
        """Return what the relation elements of a demand say of its dimensions."""
        relations: dict[Element, model.Subset] = {}
        for part in self.document.children(owner, names.RELATIONS):
            # EMF omits the first literal of an enumeration.
            text = self.document.attribute(part, names.RELATION_TYPE)
            text = "DinG" if text is None else text
            relation = _RELATIONS.get(text.strip())
            if relation is None:
                fields = {"text": _shortened(text), "allowed": ", ".join(_RELATIONS)}
                self.findings.report("X011.relation_type", part, **fields)
                continue
            ends, problems, is_present = self.document.targets(part, names.DIMENSION)
            self.findings.add(*problems)
            if not is_present and len(dimensions) == 1:
                ends = list(dimensions)
            elif not is_present:
                self.findings.report("X010.relation_dimension", part)
            for end in ends:
                if end not in dimensions:
                    self.findings.report("X009.dimension", part, actual=self.document.describe(end))
                relations[end] = relation
        return relations

    def _boundary(
        self, element: Element, spelling: Spelling, unbounded: str
    ) -> tuple[model.Bound, bool]:
        """Return one end of a range and whether it lies inside; absent, there is no bound."""
        part = self.findings.only(element, spelling)
        if part is None:
            return model.Bound(unbounded, float(unbounded)), True
        is_inside = bool(self.boolean(part, names.INCLUSIVE))
        value = self.findings.only(part, names.VALUE)
        if value is None:
            self.findings.report("X010.nil", part, feature=spelling.name)
            return model.Bound("nan", math.nan), is_inside
        epsilon = self.document.attribute(value, names.EPSILON)
        if epsilon is not None and epsilon.strip() not in ("0", "0.0"):
            self.findings.count("X014.epsilon", value, epsilon=_shortened(epsilon))
        number = self.document.attribute(value, names.NUMBER)
        return self._number("0" if number is None else number, names.NUMBER, value), is_inside

    def _range(self, part: Element) -> model.Range:
        start, end = (
            self._number(self._mandatory(part, spelling), spelling, part)
            for spelling in (names.START, names.END)
        )
        is_inside = self.boolean(part, names.INCLUSIVE)
        if is_inside is None:
            self.findings.report("X014.inclusive", part)
        return model.Range(start, end, is_inside is not False, self.document.place(part))

    def _number(self, text: str, spelling: Spelling, part: Element) -> model.Bound:
        text = text.strip()
        infinite = _INFINITE.fullmatch(text)
        if infinite:
            text = f"{infinite[1].replace('+', '')}inf"
        elif not _NUMBER.fullmatch(text) or math.isinf(float(text)):
            fields = {"attribute": spelling.name, "text": _shortened(text)}
            self.findings.report("X011.decimal", part, **fields)
            return model.Bound("nan", math.nan)
        return model.Bound(text, float(text))

    def _mandatory(self, element: Element, spelling: Spelling) -> str:
        value = self.document.attribute(element, spelling)
        if value is None:
            owner = self.document.describe(element)
            self.findings.report("X010.attribute", element, attribute=spelling.name, owner=owner)
        return "0" if value is None else value


def _shortened(text: str) -> str:
    return text if len(text) <= 60 else f"{text[:57]}..."


def read_english(text: str) -> tuple[model.Dimension, bool]:
    """Read a dimension from English text, and return whether its bound, if any, could be read."""
    statement = text.partition(":")[0].strip()  # an integrity level follows, which is not used
    operator = next((operator for operator in _OPERATORS if operator in statement), None)
    binary = model.BinaryDimension(class_name(statement) or statement)
    if operator is None:
        return binary, "=" not in statement
    subject, _, rest = statement.partition(operator)
    bound = _ENGLISH_BOUND.fullmatch(rest.strip())
    if bound is None or (bound[2] and units.find(bound[2]) is None) or not class_name(subject):
        return binary, False
    limit = model.Bound(bound[1], float(bound[1]))
    if operator == ">":
        # A range always contains its start, so it starts at the next double.
        above = math.nextafter(limit.value, math.inf)
        limit = model.Bound(repr(above), above)
    covered = model.Range(limit, model.Bound("inf", math.inf), inclusive=True)
    if operator not in (">", ">="):
        covered = model.Range(model.Bound("0.0", 0.0), limit, inclusive=operator != "<")
    return model.NumericDimension(class_name(subject), (covered,), "Guarantee", bound[2]), True

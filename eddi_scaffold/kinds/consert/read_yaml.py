"""ConSert YAML (SESAME D7.2 Fig 6) -> model: what each key holds, and its place."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar, cast

from eddi_scaffold.common.problems import Place, Problem, has_errors
from eddi_scaffold.kinds.consert.model import (
    BinaryDimension,
    Bound,
    CategoricalDimension,
    ConSert,
    Demand,
    Dimension,
    Evidence,
    Gate,
    Guarantee,
    NumericDimension,
    Propagation,
    ProvidedService,
    Range,
    RequiredService,
    Subset,
)
from eddi_scaffold.kinds.consert.yaml_shape import Element, Shape
from eddi_scaffold.yaml_text import nodes as y

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from eddi_scaffold.common.files import Source


_Part = TypeVar("_Part")

KINDS = ("Binary", "Categorical", "Numeric")
RANGES = ("Inclusive", "Exclusive")
SUBSETS = ("Demand", "Guarantee")
_FIELDS = {
    "Binary": (("type",), ()),
    "Categorical": (("type", "covered", "subset"), ()),
    "Numeric": (("type", "covered", "subset"), ("uom",)),
}
_UNREADABLE = BinaryDimension("")
"""Stands where a dimension could not be read (an error that stops every command)."""


def read_dimensions(shape: Shape, item: Element) -> tuple[Dimension, ...]:
    """Read the list of dimensions of a guarantee or demand."""
    node, what = item.get("dimensions"), f"'dimensions' of {item.what}"
    nodes = None if node is None else shape.items(node, what)
    if nodes is None:
        return (_UNREADABLE,)
    if not nodes:
        shape.report(
            "C006.empty_gate",
            item.place if node is None else node.place,
            subject=what,
            type=item.what.split()[0],
        )
        return (_UNREADABLE,)
    return tuple(read_dimension(shape, one, f"a dimension of {item.what}") for one in nodes)


def read_dimension(shape: Shape, node: y.Node | None, what: str) -> Dimension:
    """Read one dimension; a placeholder when it is missing or faulty (which is reported)."""
    if node is None:
        return _UNREADABLE
    variant = _variant(shape, node, what, KINDS, "kind of dimension")
    if variant is None:
        return _UNREADABLE
    name, content = variant
    item = shape.element(content, f"{name!r} in {what}", *_FIELDS[name])
    if item is None:
        return _UNREADABLE
    type_ = shape.text(item, "type") or ""
    if name == "Binary":
        return BinaryDimension(type_, node.place)
    subset = cast("Subset | None", shape.variant(item, "subset", SUBSETS, "subset"))
    if name == "Categorical":
        return _categorical(shape, item, type_, subset, node) or _UNREADABLE
    return _numeric(shape, item, type_, subset, node) or _UNREADABLE


def _variant(
    shape: Shape, node: y.Node, what: str, allowed: tuple[str, ...], title: str
) -> tuple[str, y.Node] | None:
    keys = f"one key ({', '.join(allowed)})"
    if not isinstance(node, y.Map) or len(node.entries) != 1:
        found = y.describe(node)
        if isinstance(node, y.Map):
            found = f"a map with {len(node.entries)} keys"
        shape.report("C002.map_with_keys", node.place, subject=what, keys=keys, actual=found)
        return None
    key, content = node.entries[0]
    if key.text not in allowed:
        shape.unknown_variant(key.text, allowed, title, key.place)
        return None
    return key.text, content


def _covered(
    shape: Shape, item: Element, read_one: Callable[[Shape, y.Node, str], _Part | None], part: str
) -> tuple[_Part, ...] | None:
    node, what = item.get("covered"), f"'covered' of {item.what}"
    nodes = None if node is None else shape.items(node, what)
    if node is None or nodes is None:
        return None
    if not nodes:
        shape.report("C006.empty_list", node.place, subject=what)
    read = [read_one(shape, one, f"a {part} of {item.what}") for one in nodes]
    kept = tuple(one for one in read if one is not None)
    return kept if kept and len(kept) == len(read) else None


def _categorical(
    shape: Shape, item: Element, type_: str, subset: Subset | None, node: y.Node
) -> Dimension | None:
    categories = _covered(shape, item, _category, "category")
    if categories is None or subset is None:
        return None
    return CategoricalDimension(type_, categories, subset, node.place)


def _category(shape: Shape, node: y.Node, what: str) -> str | None:
    return shape.scalar(node, what)


def _numeric(
    shape: Shape, item: Element, type_: str, subset: Subset | None, node: y.Node
) -> Dimension | None:
    ranges = _covered(shape, item, _range, "range")
    uom = shape.optional_text(item, "uom")
    if ranges is None or subset is None:
        return None
    return NumericDimension(type_, ranges, subset, uom, node.place)


def _range(shape: Shape, node: y.Node, what: str) -> Range | None:
    variant = _variant(shape, node, what, RANGES, "kind of range")
    if variant is None:
        return None
    name, content = variant
    ends = _ends(shape, content, f"{name!r} in {what}")
    if ends is None:
        return None
    first, last = _bound(shape, ends[0], "start", what), _bound(shape, ends[1], "end", what)
    if first is None or last is None:
        return None
    return Range(first, last, name == "Inclusive", node.place)


def _ends(shape: Shape, node: y.Node, what: str) -> tuple[y.Node, y.Node] | None:
    if isinstance(node, y.Items) and len(node.items) == 2:
        return node.items[0], node.items[1]
    item = shape.element(node, what, ("start", "end"))
    if item is None:
        return None
    start, end = item.get("start"), item.get("end")
    return None if start is None or end is None else (start, end)


def _bound(shape: Shape, node: y.Node, key: str, what: str) -> Bound | None:
    number = y.as_number(node)
    if number is not None:
        return Bound(number.text, number.value)
    hint = None
    if isinstance(node, y.Scalar):
        unquoted = y.as_number(y.Scalar(node.text, plain=True))
        hint = f"write {node.text} without quotes" if unquoted is not None else None
    shape.report("C002.number", node.place, hint=hint, key=key, subject=what, node=y.describe(node))
    return None


SECTIONS = (
    "guarantees",
    "demands",
    "evidence",
    "gates",
    "tree_propagations",
    "required_services",
    "provided_services",
)
"""The mandatory keys of the top level, in the order of SESAME D7.2 Fig 6."""

GATE_FUNCTIONS = ("And", "Or")

_Item = TypeVar("_Item")


def read_consert(source: Source, name: str | None = None) -> tuple[ConSert | None, list[Problem]]:
    """Read one ConSert.

    Args:
        source: the YAML file.
        name: name of the ConSert; the stem of the file when ``None``.

    Returns:
        The ConSert, ``None`` when anything is wrong with its shape (C001 to C006, C016); and
        all problems.
    """
    consert, problems = read_draft(source, name)
    return (None if has_errors(problems) else consert), problems


def read_draft(source: Source, name: str | None = None) -> tuple[ConSert | None, list[Problem]]:
    """Read one ConSert as far as possible, so that checking can go on behind a faulty part.

    Returns:
        A ConSert in which faulty parts are left out or replaced, ``None`` when an id or an edge
        could not be read (checking would report its consequences); and all problems.
    """
    root, problems = y.read_map(source, "C001")
    if root is None:
        return None, problems
    shape = Shape()
    top = shape.element(root, "the ConSert", SECTIONS, lists=True)
    sections = {key: _Section(shape, top, key) for key in SECTIONS}
    consert = ConSert(
        name=source.stem if name is None else name,
        guarantees=sections["guarantees"].read(_guarantee),
        demands=sections["demands"].read(_demand),
        evidence=sections["evidence"].read(_evidence),
        gates=sections["gates"].read(_gate),
        tree_propagations=sections["tree_propagations"].read(_propagation),
        required_services=sections["required_services"].read(_required),
        provided_services=sections["provided_services"].read(_provided),
        place=Place(source.name, root.place.line, root.place.col),
    )
    whole = all(section.whole for section in sections.values())
    return (consert if whole else None), [*problems, *shape.problems]


class _Section:
    """One list of the top level.

    Attributes:
        whole: every element of the list could be read far enough to be referred to.
    """

    def __init__(self, shape: Shape, top: Element | None, key: str) -> None:
        self._shape, self._key = shape, key
        node = None if top is None else top.get(key)
        self._nodes = None if node is None else shape.items(node, f"{key!r}")
        self.whole = self._nodes is not None

    def read(self, read_one: Callable[[Shape, y.Node, str], _Item | None]) -> tuple[_Item, ...]:
        read = [
            read_one(self._shape, node, f"item {number} of {self._key!r}")
            for number, node in enumerate(self._nodes or (), 1)
        ]
        kept = tuple(item for item in read if item is not None)
        self.whole = self.whole and len(kept) == len(read)
        return kept


def _guarantee(shape: Shape, node: y.Node, what: str) -> Guarantee | None:
    item = shape.element(
        node, what, ("id", "dimensions"), ("description", "default", "ranking"), kind="guarantee"
    )
    if item is None or item.id is None:
        return None
    return Guarantee(
        item.id,
        read_dimensions(shape, item),
        shape.optional_text(item, "description"),
        shape.boolean(item, "default", otherwise=False),
        shape.integer(item, "ranking"),
        item.place,
    )


def _demand(shape: Shape, node: y.Node, what: str) -> Demand | None:
    item = shape.element(node, what, ("id", "dimensions"), ("description",), kind="demand")
    if item is None or item.id is None:
        return None
    description = shape.optional_text(item, "description")
    return Demand(item.id, read_dimensions(shape, item), description, item.place)


def _evidence(shape: Shape, node: y.Node, what: str) -> Evidence | None:
    item = shape.element(node, what, ("id", "dimension"), ("description",), kind="evidence")
    if item is None or item.id is None:
        return None
    dimension = read_dimension(shape, item.get("dimension"), f"'dimension' of {item.what}")
    return Evidence(item.id, dimension, shape.optional_text(item, "description"), item.place)


def _gate(shape: Shape, node: y.Node, what: str) -> Gate | None:
    item = shape.element(node, what, ("id", "function"), kind="gate")
    if item is None or item.id is None:
        return None
    function = shape.variant(item, "function", GATE_FUNCTIONS, "gate function", _GATE_HINTS)
    return Gate(item.id, "Or" if function == "Or" else "And", item.place)


_GATE_HINTS = dict.fromkeys(
    ("not", "xor", "nand", "nor"),
    "a ConSert has no negation: describe the negated property as evidence",
)


def _propagation(shape: Shape, node: y.Node, what: str) -> Propagation | None:
    item = shape.element(node, what, ("from", "to"))
    if item is None:
        return None
    source, target = shape.text(item, "from"), shape.text(item, "to")
    if source is None or target is None:
        return None
    return Propagation(source, target, item.place)


def _required(shape: Shape, node: y.Node, what: str) -> RequiredService | None:
    service = _service(shape, node, what, "demands")
    return None if service is None else RequiredService(*service)


def _provided(shape: Shape, node: y.Node, what: str) -> ProvidedService | None:
    service = _service(shape, node, what, "guarantees")
    return None if service is None else ProvidedService(*service)


def _service(
    shape: Shape, node: y.Node, what: str, members: str
) -> tuple[str, str, tuple[str, ...], Place] | None:
    keys = ("id", "functional_service_type", members)
    item = shape.element(node, what, keys, kind="service")
    if item is None:
        return None
    type_ = shape.text(item, "functional_service_type")
    names = _names(shape, item, members)
    if item.id is None or type_ is None or names is None:
        return None
    return item.id, type_, names, item.place


def _names(shape: Shape, item: Element, key: str) -> tuple[str, ...] | None:
    node = item.get(key)
    nodes: Sequence[y.Node] | None = None
    if node is not None:
        nodes = shape.items(node, f"{key!r} of {item.what}")
    if nodes is None:
        return None
    read = [shape.scalar(one, f"a member of {key!r} of {item.what}") for one in nodes]
    names = tuple(name for name in read if name is not None)
    return names if len(names) == len(read) else None

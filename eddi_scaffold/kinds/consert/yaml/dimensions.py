"""Dimensions of a ConSert file: ``Binary``, ``Categorical`` and ``Numeric`` with their ranges."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar, cast

from eddi_scaffold.kinds.consert.model import (
    BinaryDimension,
    Bound,
    CategoricalDimension,
    Dimension,
    NumericDimension,
    Range,
    Subset,
)
from eddi_scaffold.positioned_yaml import nodes as y

if TYPE_CHECKING:
    from collections.abc import Callable

    from eddi_scaffold.kinds.consert.yaml.shape import Element, Shape

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
        message = f"{what} is empty: a {item.what.split()[0]} needs at least one"
        shape.report("C006", message, item.place if node is None else node.place)
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
        shape.report("C003", f"{what} must be a map with {keys}, not {found}", node.place)
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
        shape.report("C006", f"{what} is empty: nothing would count", node.place)
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
    message = f"{key!r} of {what} must be a number, not {y.describe(node)}"
    shape.report("C003", message, node.place, hint)
    return None

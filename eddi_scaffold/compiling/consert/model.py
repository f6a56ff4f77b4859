"""The ``model`` part of a ConSert's model file as typed data."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from eddi_scaffold.compiling.document import InputData, ModelError, ModelFile, take
from eddi_scaffold.compiling.program.instructions import Interval

_BOUND = re.compile(r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?|[-+]?inf")
_ELEMENTS = ("evidence", "demands", "gates", "guarantees")
_FILTERS = {"debounce": "regain_after", "majority": "window"}
_MAX_SAMPLES = 100_000
"""Longest history of a filter; at 1 kHz that is 100 s."""
_MAX_BOUND = 1000
"""Characters of a bound: longer texts are no measurement, and exact arithmetic would be slow."""


@dataclass(frozen=True)
class BinaryLeaf:
    """A leaf with the value True or False, of which one is good: evidence, or any demand."""

    id: str
    good: bool = True


@dataclass(frozen=True)
class CategoricalLeaf:
    """A leaf with a text as value, which should be among the covered ones."""

    id: str
    covered: tuple[str, ...]


@dataclass(frozen=True)
class NumericLeaf:
    """A leaf with a number as value, which should lie in one of the ranges.

    Attributes:
        ranges: in the unit of the input (a factor is already in the bounds).
        text: the ranges as in the model, for people.
    """

    id: str
    ranges: tuple[Interval, ...]
    text: str


Leaf = BinaryLeaf | CategoricalLeaf | NumericLeaf


@dataclass(frozen=True)
class GuaranteeData:
    """One guarantee.

    Attributes:
        id: as in the model.
        published: the id in the output (``guarantee_ids``).
        default: holds always, without support.
        ranking: lowest is best, ``None`` when not given.
    """

    id: str
    published: str
    default: bool
    ranking: int | None


@dataclass(frozen=True)
class Service:
    """A provided service: its id and the ids of its guarantees."""

    id: str
    guarantees: tuple[str, ...]


@dataclass(frozen=True)
class ConSertData:
    """A ConSert as the runtime needs it; lists keep the order of the file.

    Attributes:
        leaves: evidence and demands, in the order of ``inputs``.
        gates: id -> True for And, False for Or.
        edges: (from, to) ids.
        paths: id -> fragment path of the element in the EDDI, where it came from one.
        filter: ``debounce`` or ``majority`` of the leaves, and over how many steps; None for none.
    """

    leaves: tuple[Leaf, ...]
    gates: Mapping[str, bool]
    guarantees: tuple[GuaranteeData, ...]
    edges: tuple[tuple[str, str], ...]
    services: tuple[Service, ...]
    paths: Mapping[str, str]
    filter: tuple[str, int] | None


def read_consert(model_file: ModelFile) -> ConSertData:
    """Return the ConSert of a model file.

    Raises:
        ModelError: something is missing, of a wrong type, or names nothing.
    """
    model = model_file.model
    leaves = _leaves(model, model_file.inputs)
    gates = _gates(take(model, "gates", list, "the model"))
    published = _guarantee_ids(model_file.settings)
    guarantees = tuple(
        _guarantee(item, published) for item in take(model, "guarantees", list, "the model")
    )
    for ids in ([g.id for g in guarantees], [g.published for g in guarantees]):
        _check_unique(ids, "guarantees")
    _check_unique([*(x.id for x in leaves), *gates, *(g.id for g in guarantees)], "elements")
    edges = [_edge(item) for item in take(model, "edges", list, "the model")]
    services = [_service(item) for item in take(model, "provided_services", list, "the model")]
    known = {g.id for g in guarantees}
    for service in services:
        _check_known(service.guarantees, known, f"provided service {service.id!r}")
    return ConSertData(
        leaves,
        gates,
        guarantees,
        tuple(dict.fromkeys(edges)),
        tuple(services),
        _paths(model),
        _filter(model_file.settings),
    )


def _paths(model: Mapping[str, Any]) -> dict[str, str]:
    items = (item for key in _ELEMENTS for item in model[key])
    return {item["id"]: item["path"] for item in items if isinstance(item.get("path"), str)}


def _leaves(model: Mapping[str, Any], inputs: tuple[InputData, ...]) -> tuple[Leaf, ...]:
    specs = {spec.id: spec for spec in inputs}
    found: dict[str, Leaf] = {}
    for key in ("evidence", "demands"):
        for item in take(model, key, list, "the model"):
            name = take(item, "id", str, f"an element of {key!r}")
            if name in found:
                raise ModelError("", f"two elements have the id {name!r}")
            if name not in specs:
                raise ModelError("", f"{name!r} of {key!r} has no entry in 'inputs'")
            found[name] = _leaf(item, name, specs[name], is_demand=key == "demands")
    _check_known(specs, set(found), "'inputs'")
    return tuple(found[spec.id] for spec in inputs)


def _leaf(item: Any, name: str, spec: InputData, *, is_demand: bool) -> Leaf:
    where = f"{name!r}"
    # A demand gets whether some guarantee that fulfils it is active, whatever its dimension.
    dimension = None if is_demand else take(item, "dimension", dict, where)
    kind = "binary" if dimension is None else take(dimension, "kind", str, where)
    if spec.factor is not None and kind != "numeric":
        raise ModelError("", f"input {where} has a factor but is not numeric")
    if dimension is None:
        return BinaryLeaf(name)
    if kind == "binary":
        return BinaryLeaf(name, good=dimension.get("value") is not False)
    covered = take(dimension, "covered", list, where)
    if kind == "categorical":
        if not all(isinstance(text, str) for text in covered):
            raise ModelError("", f"'covered' of {where} is not a list of texts")
        return CategoricalLeaf(name, tuple(dict.fromkeys(covered)))
    if kind == "numeric":
        ranges = tuple(_interval(one, where, spec.factor) for one in covered)
        text = _range_text(covered, dimension.get("uom"))
        if spec.factor is not None:
            text = f"{' or '.join(map(_shown, ranges))}, which is {text}"
        return NumericLeaf(name, ranges, text)
    raise ModelError("", f"the dimension of {where} has the unknown kind {kind!r}")


def _interval(item: Any, where: str, factor: tuple[int, int] | None) -> Interval:
    """Return a range in the unit of the input.

    The factor is divided out of the bound in exact arithmetic, and the result is rounded once to
    the nearest double, as a bound without a factor is. So ``36 km/h`` is exactly 10 m/s, and a
    value is never multiplied: that would round it, and could round it into the range.
    """
    ends = [_bound(take(item, key, str, f"a range of {where}"), where) for key in ("start", "end")]
    start, end = (
        _nearest_double(
            None if exact is None or factor is None else exact / Fraction(*factor), text
        )
        for text, exact in ends
    )
    closed = take(item, "inclusive", bool, f"a range of {where}")
    if item.get("start_inclusive") is False:
        start = math.nextafter(start, math.inf)
    if start > end:
        raise ModelError("", f"a range of {where} starts above its end")
    return Interval(start, end, closed)


def _bound(text: str, where: str) -> tuple[str, Fraction | None]:
    """Return the text and its exact value, ``None`` where a double is exact (0, infinity)."""
    if len(text) > _MAX_BOUND or not _BOUND.fullmatch(text):
        raise ModelError("", f"a bound of {where} is not a decimal number: {text[:40]!r}")
    value = float(text)
    # Testing the double first keeps 1e999999999 from becoming a whole number of 400 MB.
    if value == 0 or value in (float("inf"), float("-inf")):
        return text, None
    return text, Fraction(text)


def _shown(one: Interval) -> str:
    return f"[{one.start:.9g}, {one.end:.9g}{']' if one.closed else ')'}"


def _range_text(covered: list[Any], unit: Any) -> str:
    parts = [
        f"{'(' if one.get('start_inclusive') is False else '['}{one['start']}, {one['end']}"
        f"{']' if one['inclusive'] else ')'}"
        for one in covered
    ]
    return " or ".join(parts) + (f" {unit}" if isinstance(unit, str) and unit else "")


def _gates(items: list[Any]) -> dict[str, bool]:
    found: dict[str, bool] = {}
    for item in items:
        name = take(item, "id", str, "a gate")
        if name in found:
            raise ModelError("", f"two elements have the id {name!r}")
        function = take(item, "function", str, f"gate {name!r}")
        if function not in ("And", "Or"):
            raise ModelError("", f"gate {name!r} has the unknown function {function!r}")
        found[name] = function == "And"
    return found


def _guarantee_ids(settings: Mapping[str, Any]) -> str:
    value = settings.get("guarantee_ids", "source")
    if value not in ("source", "class"):
        raise ModelError("", f"guarantee_ids {value!r} is neither 'source' nor 'class'")
    return "id" if value == "source" else "class_name"


def _guarantee(item: Any, published: str) -> GuaranteeData:
    name = take(item, "id", str, "a guarantee")
    where = f"guarantee {name!r}"
    ranking = None if item.get("ranking") is None else take(item, "ranking", int, where)
    default = take(item, "default", bool, where) if "default" in item else False
    return GuaranteeData(name, take(item, published, str, where), default, ranking)


def _filter(settings: Mapping[str, Any]) -> tuple[str, int] | None:
    wanted: Any = settings.get("filter")
    kind: str = "none" if wanted is None else take(wanted, "kind", str, "the filter")
    if kind == "none":
        return None
    if kind not in _FILTERS:
        raise ModelError("", f"the filter {kind!r} is not known: none, debounce or majority")
    key = _FILTERS[kind]
    steps: int = take(wanted, key, int, "the filter") if key in wanted else 1
    if not 1 <= steps <= _MAX_SAMPLES:
        raise ModelError("", f"{key!r} of the filter is not from 1 to {_MAX_SAMPLES}")
    return (kind, steps) if steps > 1 else None


def _edge(item: Any) -> tuple[str, str]:
    if isinstance(item, list) and len(item) == 2 and all(isinstance(end, str) for end in item):
        return item[0], item[1]
    raise ModelError("", "an element of 'edges' is not a pair of ids")


def _service(item: Any) -> Service:
    name = take(item, "id", str, "a provided service")
    members = take(item, "guarantees", list, f"provided service {name!r}")
    if not all(isinstance(member, str) for member in members):
        raise ModelError("", f"'guarantees' of provided service {name!r} is not a list of texts")
    return Service(name, tuple(members))


def _check_unique(ids: list[str], what: str) -> None:
    known: set[str] = set()
    for id_ in ids:
        if id_ in known:
            raise ModelError("", f"two {what} have the id {id_!r}")
        known.add(id_)


def _check_known(ids: Iterable[str], known: set[str], where: str) -> None:
    for id_ in ids:
        if id_ not in known:
            raise ModelError("", f"{where} names {id_!r}, which does not exist")


def _nearest_double(exact: Fraction | None, text: str) -> float:
    """Return the double nearest to an exact bound, or to its text when there is no factor."""
    if exact is None:
        return float(text)
    try:
        return float(exact)
    except OverflowError:
        return math.inf if exact > 0 else -math.inf

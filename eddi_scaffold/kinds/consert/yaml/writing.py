"""ConSert -> YAML in the layout of SESAME D7.2 Fig 6, read alike by YAML 1.1 and 1.2."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from eddi_scaffold.kinds.consert.model import (
    BinaryDimension,
    Bound,
    CategoricalDimension,
    ConSert,
    Demand,
    Dimension,
    Evidence,
    Guarantee,
    Range,
)
from eddi_scaffold.positioned_yaml.writer import Verbatim, dump_plain

if TYPE_CHECKING:
    from collections.abc import Mapping


def to_yaml(consert: ConSert) -> str:
    """Return the YAML text of a ConSert; its name is that of the file and not inside."""
    return "---\n" + dump_plain(as_plain(consert))


def as_plain(consert: ConSert) -> Mapping[str, Any]:
    """Return a ConSert as the plain data of its YAML file, keys in the order of D7.2 Fig 6."""
    return {
        "guarantees": [_guarantee(guarantee) for guarantee in consert.guarantees],
        "demands": [_node(demand) | _dimensions(demand) for demand in consert.demands],
        "evidence": [_node(e) | {"dimension": _dimension(e.dimension)} for e in consert.evidence],
        "gates": [{"id": gate.id, "function": gate.function} for gate in consert.gates],
        "tree_propagations": [
            {"from": edge.source, "to": edge.target} for edge in consert.tree_propagations
        ],
        "required_services": [
            {
                "id": service.id,
                "functional_service_type": service.functional_service_type,
                "demands": service.demands,
            }
            for service in consert.required_services
        ],
        "provided_services": [
            {
                "id": service.id,
                "functional_service_type": service.functional_service_type,
                "guarantees": service.guarantees,
            }
            for service in consert.provided_services
        ],
    }


def _node(node: Evidence | Demand | Guarantee) -> dict[str, Any]:
    return {"id": node.id} | ({"description": node.description} if node.description else {})


def _dimensions(node: Demand | Guarantee) -> dict[str, Any]:
    return {"dimensions": [_dimension(dimension) for dimension in node.dimensions]}


def _guarantee(guarantee: Guarantee) -> dict[str, Any]:
    plain = _node(guarantee) | _dimensions(guarantee)
    if guarantee.default:
        plain["default"] = True
    if guarantee.ranking is not None:
        plain["ranking"] = guarantee.ranking
    return plain


def _dimension(dimension: Dimension) -> dict[str, Any]:
    if isinstance(dimension, BinaryDimension):
        return {"Binary": {"type": dimension.type}}
    head: dict[str, Any] = {"type": dimension.type}
    if isinstance(dimension, CategoricalDimension):
        content = head | {"covered": dimension.covered, "subset": dimension.subset}
        return {"Categorical": content}
    covered = [_range(one) for one in dimension.covered]
    content = head | {"covered": covered, "subset": dimension.subset}
    return {"Numeric": content | ({} if dimension.uom is None else {"uom": dimension.uom})}


def _range(one: Range) -> dict[str, Any]:
    name = "Inclusive" if one.inclusive else "Exclusive"
    return {name: {"start": _bound(one.start), "end": _bound(one.end)}}


def _bound(bound: Bound) -> Verbatim:
    if math.isinf(bound.value):
        return Verbatim(".inf" if bound.value > 0 else "-.inf")
    return Verbatim(bound.text)

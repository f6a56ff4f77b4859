"""ConSert -> YAML in the layout of SESAME D7.2 Fig 6, read alike by YAML 1.1 and 1.2."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from eddi_scaffold.kinds.consert.consert import (
    RANGES,
    BinaryDimension,
    Bound,
    CategoricalDimension,
    ConSert,
    Demand,
    Dimension,
    Evidence,
    Guarantee,
    Service,
)
from eddi_scaffold.yaml_text.writer import Verbatim, dump_plain


def to_yaml(consert: ConSert) -> str:
    """Return the YAML text of a ConSert; its name is that of the file and not inside."""
    plain = {
        "guarantees": [_node(guarantee) for guarantee in consert.guarantees],
        "demands": [_node(demand) for demand in consert.demands],
        "evidence": [_node(evidence) for evidence in consert.evidence],
        "gates": [{"id": gate.id, "function": gate.function} for gate in consert.gates],
        "tree_propagations": [
            {"from": e.source, "to": e.target} for e in consert.tree_propagations
        ],
        "required_services": [_service(service) for service in consert.required_services],
        "provided_services": [_service(service) for service in consert.provided_services],
        **({"system": consert.system} if consert.system else {}),
    }
    return "---\n" + dump_plain(plain)


def _node(node: Evidence | Demand | Guarantee) -> Mapping[str, Any]:
    plain: dict[str, Any] = {"id": node.id}
    if node.description:
        plain["description"] = node.description
    if isinstance(node, Evidence):
        return plain | {"dimension": _dimension(node.dimension)}
    plain["dimensions"] = [_dimension(dimension) for dimension in node.dimensions]
    if isinstance(node, Guarantee):
        plain |= {"default": True} if node.default else {}
        plain |= {"ranking": node.ranking} if node.ranking is not None else {}
    return plain


def _service(service: Service) -> Mapping[str, Any]:
    return {
        "id": service.id,
        "functional_service_type": service.functional_service_type,
        f"{service.member_kind}s": service.members,
    }


def _dimension(dimension: Dimension) -> Mapping[str, Any]:
    if isinstance(dimension, BinaryDimension):
        value = {} if dimension.value else {"value": False}
        return {"Binary": {"type": dimension.type, **value}}
    plain: dict[str, Any] = {"type": dimension.type, "covered": dimension.covered}
    plain |= {"subset": dimension.subset} if dimension.subset else {}
    if isinstance(dimension, CategoricalDimension):
        return {"Categorical": plain}
    plain["covered"] = [
        {
            RANGES[covered.start_inclusive, covered.inclusive]: {
                "start": _bound(covered.start),
                "end": _bound(covered.end),
            }
        }
        for covered in dimension.covered
    ]
    return {"Numeric": plain if dimension.uom is None else plain | {"uom": dimension.uom}}


def _bound(bound: Bound) -> Verbatim:
    if math.isinf(bound.value):
        return Verbatim(".inf" if bound.value > 0 else "-.inf")
    return Verbatim(bound.text)

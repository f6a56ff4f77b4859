"""ConSert -> YAML in the layout of SESAME D7.2 Fig 6, read alike by YAML 1.1 and 1.2."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from eddi_scaffold.common.problems import EddiError, Place, Problem, in_order, problem
from eddi_scaffold.kinds.consert.model import (
    BinaryDimension,
    Bound,
    CategoricalDimension,
    ConSert,
    Demand,
    Dimension,
    Evidence,
    Guarantee,
    NumericDimension,
)
from eddi_scaffold.kinds.consert.ranges import range_text
from eddi_scaffold.yaml_text.writer import Verbatim, dump_plain

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping


def to_yaml(consert: ConSert) -> str:
    """Return the YAML text of a ConSert; its name is that of the file and not inside.

    Raises:
        EddiError: an EDDI says something of it that this format cannot say (G004).
    """
    problems = list(_unsayable(consert))
    if problems:
        raise EddiError(*in_order(problems))
    return "---\n" + dump_plain(as_plain(consert))


def _unsayable(consert: ConSert) -> Iterator[Problem]:
    """Yield an error for each thing that an EDDI can say and YAML cannot."""
    nodes: tuple[Evidence | Demand | Guarantee, ...]
    nodes = (*consert.guarantees, *consert.demands, *consert.evidence)
    for node in nodes:
        is_evidence = isinstance(node, Evidence)
        dimensions = (node.dimension,) if isinstance(node, Evidence) else node.dimensions
        if not dimensions:
            yield _lost(f"{node.id!r} has no dimension", node.place)
        for dimension in dimensions:
            what = f"dimension {dimension.type!r} of {node.id!r}"
            if isinstance(dimension, BinaryDimension):
                if not dimension.value:
                    yield _lost(f"{what} is good when it is false", dimension.place)
                continue
            if dimension.subset not in ("Demand", "Guarantee") and not is_evidence:
                relation = (
                    "no direction"
                    if dimension.subset is None
                    else f"the relation {dimension.subset}"
                )
                yield _lost(f"{what} has {relation}", dimension.place)
            if isinstance(dimension, NumericDimension):
                for covered in dimension.covered:
                    if not covered.start_inclusive:
                        text = range_text(covered, dimension.uom)
                        yield _lost(f"the start of {text} of {what} lies outside", dimension.place)


def _lost(what: str, place: Place) -> Problem:
    return problem("G004.yaml", place, subject=what)


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
    subset = dimension.subset or "Demand"  # of evidence, where it means nothing
    if isinstance(dimension, CategoricalDimension):
        content = head | {"covered": dimension.covered, "subset": subset}
        return {"Categorical": content}
    covered = [
        {
            "Inclusive" if one.inclusive else "Exclusive": {
                "start": _bound(one.start),
                "end": _bound(one.end),
            }
        }
        for one in dimension.covered
    ]
    content = head | {"covered": covered, "subset": subset}
    return {"Numeric": content | ({} if dimension.uom is None else {"uom": dimension.uom})}


def _bound(bound: Bound) -> Verbatim:
    if math.isinf(bound.value):
        return Verbatim(".inf" if bound.value > 0 else "-.inf")
    return Verbatim(bound.text)

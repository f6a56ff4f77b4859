"""ConSert -> the ``model`` part of ``config/model.json``, which the runtime compiles and runs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from eddi_scaffold.kinds.consert import names
from eddi_scaffold.kinds.consert.model import (
    BinaryDimension,
    CategoricalDimension,
    ConSert,
    Demand,
    Dimension,
    Evidence,
    Guarantee,
)

if TYPE_CHECKING:
    from eddi_scaffold.common.problems import Place

Json = dict[str, Any]


def runtime_model(consert: ConSert) -> Json:
    """Return plain data for ``json``; lists keep the order of the file.

    Bounds are decimal texts (``inf`` and ``-inf`` for open ends), so that the runtime and a
    person see the digits of the model.
    """
    return {
        "evidence": [
            _node(e) | {"dimension": _dimension(e.dimension)} | _trace(e.place)
            for e in consert.evidence
        ],
        "demands": [_node(d) | _dimensions(d) | _trace(d.place) for d in consert.demands],
        "gates": [
            {"id": gate.id, "function": gate.function} | _trace(gate.place)
            for gate in consert.gates
        ],
        "guarantees": [_guarantee(guarantee) for guarantee in consert.guarantees],
        "edges": [[edge.source, edge.target] for edge in consert.tree_propagations],
        "required_services": [
            {
                "id": service.id,
                "functional_service_type": service.functional_service_type,
                "demands": list(service.demands),
            }
            for service in consert.required_services
        ],
        "provided_services": [
            {
                "id": service.id,
                "functional_service_type": service.functional_service_type,
                "guarantees": list(service.guarantees),
            }
            for service in consert.provided_services
        ],
    }


def _node(node: Evidence | Demand | Guarantee) -> Json:
    return {"id": node.id} | ({"description": node.description} if node.description else {})


def _trace(place: Place) -> Json:
    """Return the place of the element in the model's file, for traceability."""
    found = {"path": place.path, "line": place.line}
    return {key: value for key, value in found.items() if value is not None}


def _guarantee(guarantee: Guarantee) -> Json:
    facts = {
        "class_name": names.published_class(guarantee.id),
        "default": guarantee.default,
        "ranking": guarantee.ranking,
    }
    return _node(guarantee) | _dimensions(guarantee) | facts | _trace(guarantee.place)


def _dimensions(node: Demand | Guarantee) -> Json:
    return {"dimensions": [_dimension(dimension) for dimension in node.dimensions]}


def _dimension(dimension: Dimension) -> Json:
    if isinstance(dimension, BinaryDimension):
        expected = {} if dimension.value else {"value": False}
        return {"kind": "binary", "type": dimension.type, **expected}
    if isinstance(dimension, CategoricalDimension):
        return {
            "kind": "categorical",
            "type": dimension.type,
            "covered": list(dimension.covered),
            "subset": dimension.subset,
        }
    return {
        "kind": "numeric",
        "type": dimension.type,
        "covered": [
            {
                "start": one.start.text,
                "end": one.end.text,
                "inclusive": one.inclusive,
                **({} if one.start_inclusive else {"start_inclusive": False}),
            }
            for one in dimension.covered
        ],
        "subset": dimension.subset,
        "uom": dimension.uom,
    }

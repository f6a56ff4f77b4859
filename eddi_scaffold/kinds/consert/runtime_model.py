"""ConSert -> the ``model`` part of ``config/model.json``, which the runtime compiles and runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from eddi_scaffold.common.claims import Acceptance
from eddi_scaffold.common.graphs import reached
from eddi_scaffold.kinds.consert import names
from eddi_scaffold.kinds.consert.model import (
    BinaryDimension,
    CategoricalDimension,
    ConSert,
    ConSertModel,
    Demand,
    Dimension,
    Evidence,
    Guarantee,
)
from eddi_scaffold.kinds.consert.options import _FILTERS, options_of

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


def support(document: Mapping[str, Any]) -> Mapping[str, frozenset[str]]:
    """Return the evidence and demands on which each guarantee rests, by its id in messages."""
    model = document["model"]
    ids = [one["id"] for group in _GROUPS for one in model[group]]
    feeding: dict[str, list[str]] = {id_: [] for id_ in ids}
    for source, target in model["edges"]:
        feeding[target].append(source)
    leaves = frozenset(one["id"] for kind in ("evidence", "demands") for one in model[kind])
    publish = names.published_class if document["settings"]["guarantee_ids"] == "class" else str
    return {
        publish(name): frozenset() if is_default else leaves & reached(feeding, [name])
        for name, is_default in (
            (guarantee["id"], guarantee["default"]) for guarantee in model["guarantees"]
        )
    }


_GROUPS = ("evidence", "demands", "gates", "guarantees")


def settings(model: ConSertModel) -> dict[str, Any]:
    """Return the ``settings`` part of ``config/model.json``."""
    options = options_of(model)
    steps = {_FILTERS[options.filter]: options.filter_steps} if options.filter else {}
    filter_ = {"kind": options.filter or "none", **steps}
    return {"guarantee_ids": options.guarantee_ids, "filter": filter_}


def accepted(document: Mapping[str, Any], frequency: float) -> Sequence[Acceptance]:
    """Return what a filter by majority accepts, of ``config/model.json``."""
    seconds = lag(document, frequency)
    if not seconds:
        return ()
    key, what = "filter: majority", "the majority of old steps"
    return [Acceptance(key, what, f"for {seconds:g} s", seconds, path=("Model", "filter"))]


def lag(document: Mapping[str, Any], frequency: float) -> float:
    """Return for how many seconds a majority may hold after it was lost, of the same."""
    filtering = document["settings"]["filter"]
    return filtering.get("window", 1) // 2 / frequency if filtering["kind"] == "majority" else 0.0

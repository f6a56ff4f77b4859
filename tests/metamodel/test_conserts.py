"""ConSerts as EMF tools write them: content, verdicts, composition, and what YAML cannot say."""

import math
from typing import Any

import pytest

from eddi_scaffold.kinds.consert.compose import compose
from eddi_scaffold.kinds.consert.consert import (
    BinaryDimension,
    CategoricalDimension,
    ConSert,
    Dimension,
)
from eddi_scaffold.kinds.consert.consert_model import ConSertModel
from tests.cli.command import run
from tests.kinds.consert.example import monitor_of
from tests.metamodel.expected import FOLDER, cases, changed, expected, models

RELATIONS = {
    "DinG": "Demand",
    "GinD": "Guarantee",
    "Equals": "Equals",
    "IntersectionNotEmpty": "Intersection",
}


def consert(file: str, name: str) -> ConSertModel:
    (found,) = (model for model in models(file) if model.name == name)
    return found


CASES = cases("consert")


@pytest.mark.parametrize(("file", "want"), CASES, ids=[f"{f}:{w['name']}" for f, w in CASES])
def test_content(file: str, want: dict[str, Any]) -> None:
    read: ConSert = consert(file, want["name"]).data
    for evidence in read.evidence:
        dimensions = want["evidence"][evidence.id]["dimensions"]
        if dimensions:
            assert [plain(evidence.dimension)] == dimensions
        else:
            assert evidence.dimension == BinaryDimension(evidence.id)
    assert [one.id for one in read.evidence] == list(want["evidence"])
    assert [(demand.id, described(demand)) for demand in read.demands] == [
        (id_, wanted(one)) for id_, one in want["demands"].items()
    ]
    assert [(one.id, [plain(d) for d in one.dimensions]) for one in read.guarantees] == [
        (id_, one["dimensions"]) for id_, one in want["guarantees"].items()
    ]
    assert read.system == want.get("system", read.system)
    gates = {gate.id: gate.function for gate in read.gates}
    assert gates.pop(want.get("invariant"), "And") == "And"
    assert list(gates.items()) == list(want["gates"].items())
    edges = [[edge.source, edge.target] for edge in read.tree_propagations]
    assert [edge for edge in edges if edge[0] != want.get("invariant")] == want["edges"]
    provided = {id_: s.id for s in read.provided_services for id_ in s.members}
    assert provided == stated(want["guarantees"], "service")
    required = {id_: s.id for s in read.required_services for id_ in s.members}
    assert required == stated(want["demands"], "service")


@pytest.mark.parametrize(("file", "want"), CASES, ids=[f"{f}:{w['name']}" for f, w in CASES])
def test_requirements_and_events(file: str, want: dict[str, Any]) -> None:
    linked = {
        one.id: [link.name.partition(" (")[0] for link in one.links]
        for one in consert(file, want["name"]).links.values()
    }
    for part in ("evidence", "demands", "guarantees"):
        for id_, requirement in stated(want[part], "requirement").items():
            assert requirement in linked[id_]
        for id_, events in stated(want[part], "events").items():
            assert set(events) <= set(linked[id_])


def stated(parts: dict[str, Any], key: str) -> dict[str, Any]:
    return {id_: one[key] for id_, one in parts.items() if key in one}


def plain(dimension: Dimension) -> dict[str, Any]:
    if isinstance(dimension, BinaryDimension):
        return {"kind": "Binary", "type": dimension.type, "value": dimension.value}
    if isinstance(dimension, CategoricalDimension):
        covered = list(dimension.covered)
        return {"kind": "Categorical", "type": dimension.type, "covered": covered}
    (one,) = dimension.covered
    start = {"number": one.start.value, "inclusive": one.start_inclusive}
    end = {"number": one.end.value, "inclusive": one.inclusive}
    if one.start.value == -math.inf:
        start = None  # type: ignore[assignment]
    return {
        "kind": "Numeric",
        "type": dimension.type,
        "start": start,
        "end": end,
        "unit": dimension.uom,
    }


def described(demand: Any) -> tuple[Any, ...]:
    return (
        [plain(one) for one in demand.dimensions],
        [getattr(one, "subset", None) for one in demand.dimensions],
    )


def wanted(one: dict[str, Any]) -> tuple[Any, ...]:
    return one["dimensions"], [RELATIONS.get(each) for each in one.get("relations", ())]


JUDGED = [(file, want) for file, want in CASES if "verdicts" in want]


@pytest.mark.parametrize(("file", "want"), JUDGED, ids=[f"{f}:{w['name']}" for f, w in JUDGED])
def test_verdicts(file: str, want: dict[str, Any]) -> None:
    model = consert(file, want["name"])
    leaves = [*want["evidence"], *want["demands"]]
    assert len(want["verdicts"]) == 2 ** len(leaves)
    monitor, inputs = monitor_of(model)
    for row in want["verdicts"]:
        values = {leaf: leaf in row["true"] for leaf in leaves}
        rows = monitor.execute_step(inputs(values))
        assert [one["id"] for one in rows if one["active"]] == row["holds"]


GOOD = {"Calm": False, "Mode": "off duty", "Speed": 0.0, "Reach": 1.5e7, "Force": -12.5}
BAD = {
    "Calm": [True, None, 0.0],
    "Mode": ["off", None],
    "Speed": [0.25, -1e-300, math.nan],
    "Reach": [1e-9, 0.0, 1.6e7],
    "Force": [-12.4, math.inf],
}


def test_both_ends_of_ranges_and_what_is_good_when_it_is_false() -> None:
    monitor, inputs = monitor_of(consert("03_consert_dimensions.xml", "Arm"))

    def lifts(**changed: Any) -> bool:
        (row,) = monitor.execute_step(inputs({**GOOD, **changed}))
        return bool(row["active"])

    assert lifts()
    assert lifts(Reach=math.nextafter(1e-9, 1), Force=-math.inf, Speed=math.nextafter(0.25, 0))
    for name, values in BAD.items():
        for value in values:
            assert not lifts(**{name: value}), (name, value)


def test_relations_decide_what_fulfils_a_demand() -> None:
    file = "04_consert_relations.xml"
    composed = compose([(model.name, model.data) for model in models(file)])
    fulfils = expected()[file]["fulfils"]
    found = {demand: [id_ for _, id_ in refs] for (_, demand), refs in composed.bindings.items()}
    assert found == {demand: ids for demand, ids in fulfils.items() if ids}
    assert composed.unmatched_demands == ("SeesTooFar",)
    assert composed.reasons[0].startswith(
        "demand Robot/SeesTooFar is not fulfilled: dimension Range: [0, 20.0] km of SeesTooFar "
        "is not inside [0, 20.0] m of Scanner/Range"
    )


def test_a_relation_without_its_dimension_is_of_the_only_one() -> None:
    at = ' dimension="//@odeProductPackages.2/@conSerts.1/@demands.2/@dependabilityProperty'
    read = changed(FOLDER / "04_consert_relations.xml", (f'{at}/@dimensions.0"', ""))
    assert not [one for one in read.problems if one.level == "error"]
    demands = {one.id: one for one in read.models[1].data.demands}  # type: ignore[attr-defined]
    assert described(demands["Exact"])[1] == ["Guarantee"]


def test_an_allocation_that_does_not_fulfil_the_demands_is_said() -> None:
    file = "04_consert_relations.xml"
    composed = compose([(model.name, model.data) for model in models(file)])
    (said,) = composed.problems
    assert (said.level, said.code, said.place.line) == ("warning", "X009", 21)
    assert said.message == (
        "Robot/NeedsWatch is allocated to Scanner/Watch, which does not fulfil SeesTooFar"
    )
    printed = run("compose", file, cwd=FOLDER)
    assert said.message in printed.err

"""Bounds by minimal cut sets, for coherent trees whose diagram would be too large."""

import json
import math
import time
from random import Random
from typing import Any

import numpy as np
import pytest
from eddi_runtime.reliability.large_tree import BoundedTree, LargeTree
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds import Options
from eddi_scaffold.kinds.reliability.decision_diagram import build
from eddi_scaffold.kinds.reliability.fault_tree import Gate, minimal_cut_sets
from eddi_scaffold.kinds.reliability.lowering import lower_tree
from eddi_scaffold.kinds.reliability.system import FaultTree, ReliabilitySystem
from eddi_scaffold.monitors.loading import read_models
from tests.data_files import data_file
from tests.kinds.reliability import trees as written
from tests.kinds.reliability.monitors import at_start, compiled, read_text, sound
from tests.kinds.reliability.test_fault_tree_diagram import random_tree


def bounds_of(found: Any) -> BoundedTree:
    class Tree(BoundedTree):
        names = ()
        sets = tuple(tuple(sorted(one)) for one in found)

    return Tree()


@given(st.integers(0, 2**32), st.lists(st.floats(0.0, 1.0), min_size=8, max_size=8))
def test_cut_sets_bound_the_value_of_the_diagram(seed: int, q: list[float]) -> None:
    events, gates = random_tree(Random(seed), coherent=True)
    top, q = events + len(gates) - 1, q[:events]
    diagram = build(events, gates, top)
    sets = minimal_cut_sets(events, gates, top)
    assert sets is not None
    bounds, exact = bounds_of(sets), written.compiled(diagram, events).failure(q)
    assert bounds.lower(q) <= exact * (1 + 1e-12)
    assert exact <= bounds.failure(q) * (1 + 1e-12)
    assert bounds.survival(q) == pytest.approx(1 - bounds.failure(q), abs=1e-12)


VOTES = (
    "horizon: 1 h\nmodels:\n  t:\n    type: fault_tree\n    node_limit: 5\n"
    "    approximation: cut_sets\n"
    "    gates: {T: {type: VOTE, k: 3, of: [A, B, C, D, E]}}\n"
    "    events: {A: {p: 1e-6}, B: {p: 1e-6}, C: {p: 1e-6}, D: {p: 1e-6}, "
    "E: {p: 1e-6, observed: true}}\n"
    "thresholds: [{id: go, activate: 1.1e-17}]\n"
)


def test_a_tree_above_its_limit_is_bounded() -> None:
    model = sound(VOTES)
    found = at_start(model, t_E=False)
    assert found.valid
    assert found.p_fail_low == pytest.approx(1e-18, rel=1e-12, abs=0.0)
    assert found.p_fail_high == pytest.approx(10e-18, rel=1e-12, abs=0.0)
    assert (found.p_fail, found.evidence) == (found.p_fail_high, {"go": True})
    assert found.reliability == 1.0
    happened = at_start(model, t_E=True)
    assert happened.p_fail_low == pytest.approx(1e-12, rel=1e-12, abs=0.0)
    assert happened.p_fail_high == pytest.approx(6e-12 + 4e-18, rel=1e-9, abs=0.0)
    unknown = at_start(model)
    assert (unknown.valid, unknown.unknown, unknown.evidence) == (False, ("t_E",), {"go": False})
    assert unknown.p_fail_low == 1e-18 or math.isclose(unknown.p_fail_low, 1e-18)
    assert unknown.p_fail_high == happened.p_fail_high
    readme = "\n".join(model.readme())
    assert "with probability from 1e-18 to 1e-17 at mission start" in readme
    assert "Minimal cut sets of `t`: 10" in readme
    monitor = compiled(model)
    monitor.execute_step(type("Values", (), {"t_E": False})(), 0)
    assert len(monitor.importances()) == 5


def test_a_configuration_keeps_what_it_does_not_name() -> None:
    """A key of one event takes neither the bounds nor the repair of its tree away."""
    model, problems = read_text(VOTES.replace("    gates", "    repair: true\n    gates"))
    assert model is not None, problems
    change = {"models": {"t": {"events": {"A": {"p": 1e-5}}}}}
    configured, problems = model.configure(Options(values=change))
    assert configured is not None, problems
    tree = configured.data.components["t"].content
    assert (tree.approximate, tree.repair, tree.node_limit) == (True, True, 5)


def test_what_is_certain_and_what_never_happens() -> None:
    bounds = bounds_of([[0], [1, 2]])
    assert (bounds.lower([1.0, 0.0, 0.5]), bounds.failure([1.0, 0.0, 0.5])) == (1.0, 1.0)
    assert bounds.survival([1.0, 0.0, 0.5]) == 0.0
    never = bounds_of([])
    assert (never.lower([0.5]), never.failure([0.5]), never.survival([0.5])) == (0.0, 0.0, 1.0)


def test_many_cut_sets_are_found_soon() -> None:
    gates = [Gate("VOTE", tuple(range(20)), 4), Gate("OR", tuple(range(18, 21)), 0)]
    sets = minimal_cut_sets(20, gates, 21)
    assert sets is not None
    assert len(sets) == 2 + 3060
    assert minimal_cut_sets(20, [Gate("VOTE", tuple(range(20)), 5)], 20) is None
    wide = minimal_cut_sets(9000, [Gate("OR", tuple(range(9000)))], 9000)
    assert wide is not None
    assert bounds_of(wide).failure(np.full(9000, 1e-12)) < 1.1e-8


def _entangled(events: int, size: int, gates: int) -> list[Gate]:
    """An AND of ORs that share events: few minimal cut sets, and very many on the way."""
    chance = Random(1)
    ors = [Gate("OR", tuple(chance.sample(range(events), size))) for _ in range(gates)]
    return [*ors, Gate("AND", tuple(range(events, events + gates)))]


def test_the_way_to_few_cut_sets_is_bounded() -> None:
    assert minimal_cut_sets(20, _entangled(20, 5, 21), 41) is not None
    assert minimal_cut_sets(40, _entangled(40, 8, 30), 70) is None


pytestmark = pytest.mark.slow

VALUES = json.loads(data_file("large_trees.json").read_text("utf-8"))


def systems(file: str) -> dict[str, ReliabilitySystem]:
    source = Source(file.rpartition("/")[2], data_file(file).read_bytes())
    return {model.data.top: model.data for model in read_models(source).models}


def value(system: ReliabilitySystem) -> float:
    content = system.components[system.top].content
    assert isinstance(content, FaultTree)
    tree = lower_tree(system.top, content)
    assert tree.diagram is not None
    diagram = tree.diagram

    class Tree(LargeTree):
        names = ()
        nodes = diagram.nodes

    return Tree().failure([event.values[0] for event in tree.events])


@pytest.mark.parametrize(("name", "expected"), VALUES["aralia"].items())
def test_the_aralia_trees_have_the_values_of_another_program_within_a_minute(
    name: str, expected: float
) -> None:
    (system,) = systems(f"aralia/{name}.xml").values()
    start = time.process_time()
    assert value(system) == pytest.approx(expected, rel=1e-9, abs=0.0)
    assert time.process_time() - start < 60


@pytest.mark.parametrize(("file", "tree", "expected"), VALUES["generic-pwr"])
def test_trees_of_a_power_plant_have_the_values_of_another_program(
    file: str, tree: str, expected: float
) -> None:
    """With events of probability 0 and 1."""
    found = value(systems(f"generic-pwr/{file}")[tree])
    assert found == pytest.approx(expected, rel=1e-10, abs=0.0)

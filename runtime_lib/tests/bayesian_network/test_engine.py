"""Exact inference against the addition of all cases, in exact arithmetic."""

import os
import random
import subprocess
import sys
import tracemalloc
from pathlib import Path

import eddi_runtime
import pytest
from eddi_runtime.bayesian_network.tables import JointTables
from hypothesis import given
from hypothesis import strategies as st

from runtime_lib.tests.bayesian_network.networks import (
    engine,
    exactly,
    furthest,
    network,
    random_evidence,
    random_network,
)

SOURCES = Path(eddi_runtime.__file__).parents[1]


def engines(net, outputs, observable):
    """Return the tiers: with tables where they are small, and with the schedule only."""
    yield engine(net, outputs, observable)
    yield engine(net, outputs, observable, tables=False)


def lookup_only(made):
    return all(isinstance(one.running, JointTables) for one in made._parts)


@given(seed=st.integers(0, 10**9), count=st.integers(1, 6))
def test_posteriors_are_exact(seed, count):
    rng = random.Random(seed)
    net = random_network(rng, count, most_states=3)
    outputs = sorted(rng.sample(range(count), rng.randint(0, min(count, 3))))
    observable = sorted(rng.sample(range(count), rng.randint(0, count)))
    cases = [random_evidence(rng, net, observable) for _ in range(3)]
    wanted = [exactly(net, outputs, observable, *case) for case in cases]
    for made in engines(net, outputs, observable):
        for case, want in zip(cases, wanted):
            rows = made.infer(*case)
            assert (rows is None) == (want is None)
            assert rows is None or furthest(rows, want) < 1e-12


def test_an_observed_node_may_have_very_many_states():
    card = 300
    rows = [[(k + 1) / 302, 1.0 - (k + 1) / 302] for k in range(card)]
    flat = [value for row in rows for value in row]
    net = network([card, 2], [(), (0,)], [[1.0 / card] * card, flat])
    made = engine(net, [1], [0], tables=False)
    assert furthest(made.infer([17]), [rows[17]]) < 1e-12
    assert furthest(made.infer([card]), [[301 / 604, 303 / 604]]) < 1e-12


@pytest.mark.parametrize("tables", [True, False])
def test_improbable_is_not_impossible(tables):
    """Products far below the least double: only an exact zero is a contradiction."""
    tiny = 1e-200
    rows = [tiny, 1.0 - tiny, 3.0 * tiny, 1.0 - 3.0 * tiny]
    net = network([2, 2, 2, 2], [(), (0,), (0,), (0,)], [[0.5, 0.5], rows, rows, rows])
    made = engine(net, [0], [1, 2, 3], tables=tables)
    assert furthest(made.infer([0, 0, 0]), [[1 / 28, 27 / 28]]) < 1e-12
    weights = {k: [1e-250, 0.0] for k in range(3)}
    found = made.infer([2, 2, 2], weights)
    assert furthest(found, [[1 / 28, 27 / 28]]) < 1e-12


def test_tiny_likelihoods_in_tables():
    net = network([2, 2, 2], [(), (0,), (0,)], [[0.5, 0.5], [1, 0, 0, 1], [0, 1, 1, 0]])
    made = engine(net, [0], [1, 2])
    assert lookup_only(made)
    rows = made.infer([2, 2], {0: [1.0, 1e-300], 1: [1.0, 1e-300]})
    assert furthest(rows, [[0.5, 0.5]]) < 1e-12


def test_steps_do_not_allocate_for_good():
    rng = random.Random(7)
    net = random_network(rng, 30, zeros=0.0)
    observable = sorted(rng.sample(range(29), 14))
    made = engine(net, [29, 28], observable)
    assert not lookup_only(made)
    cases = [random_evidence(rng, net, observable) for _ in range(20)]
    tracemalloc.start()
    try:
        for _ in range(200):  # the interpreter keeps some freed floats for later
            for case in cases:
                made.infer(*case)
        before = tracemalloc.get_traced_memory()[0]
        for _ in range(200):
            for case in cases:
                made.infer(*case)
        assert tracemalloc.get_traced_memory()[0] - before < 500
    finally:
        tracemalloc.stop()


def test_results_are_the_callers_own():
    net = random_network(random.Random(3), 5, zeros=0.0)
    for made in engines(net, [4], [0, 1]):
        first = made.infer([0, 0])
        kept = [list(row) for row in first]
        first[0][0] = 7.0
        assert made.infer([0, 0]) == kept


def test_small_networks_need_no_numpy():
    script = """
import sys
sys.modules["numpy"] = None
from runtime_lib.tests.bayesian_network.networks import BINS, give, monitor
step = monitor(bins=BINS).execute_step
print(step(give(v=0.0, d=1.0))[0].output_nodes[0].outcomes[0].value)
"""
    assert _run(script).strip() == "0.1"


def test_without_numpy_a_large_network_says_so():
    script = """
import sys, random
sys.modules["numpy"] = None
from runtime_lib.tests.bayesian_network.networks import monitor, node
from eddi_runtime import ModelError
row = [0.9, 0.1, 0.2, 0.8]
nodes = [node("x0", "a b", (), [0.5, 0.5])]
nodes += [node(f"x{k}", "a b", f"x{k - 1}", row) for k in range(1, 20)]
try:
    monitor(nodes, outputs=["x0"], observed=[f"x{k}" for k in range(1, 20)])
except ModelError as problem:
    print(problem)
"""
    assert "numpy" in _run(script)


def _run(script, **environment):
    root = str(Path(__file__).parents[3])
    path = os.pathsep.join([str(SOURCES), root])
    done = subprocess.run(
        [sys.executable, "-c", script],
        env={**os.environ, "PYTHONPATH": path, **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert not done.returncode, done.stderr
    return done.stdout

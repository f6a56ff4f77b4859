"""Compiled networks: the text, and what of a hostile model is in it."""

import random
from dataclasses import replace

import pytest

from eddi_scaffold.common.problems import Place
from eddi_scaffold.kinds.bayesian_network.inference_plan import LARGE, TOO_LARGE, width_of
from runtime_lib.tests.bayesian_network.networks import (
    BINS,
    NODES,
    give,
    grid,
    model,
    model_of,
    network,
    node,
    posterior,
    random_network,
    random_row,
    threshold,
)
from tests.program.formatting import assert_plain_data

HOSTILE = ['"""', "\\", "\n", "__import__('os')", "a b", "class", "self", "é", "\ud800", "x" * 300]


def large(seed=3, count=24):
    rng = random.Random(seed)
    net = random_network(rng, count, zeros=0.1)
    return model_of(net, [count - 1, 5], sorted(rng.sample(range(count), count // 2)))


def several():
    nodes = [*NODES, node("Alone", "a b", (), [0.0, 1.0])]
    limits = [threshold("T", "Danger", ["yes"], 1.0, at_most=0.2)]
    bins = dict(BINS, Speed=dict(BINS["Speed"], sentinel=[[-1, "fast"]], range=[-1, 9]))
    direct = {"Alone": "a", "Alarm": "b"}
    return model(nodes, bins=bins, direct=direct, thresholds=limits, on_inconsistent="prior")


def wide(parents=11):
    """Return a node with a table of thousands of numbers, and what is observed above it."""
    rng = random.Random(parents)
    net = network(
        [2] * (parents + 1),
        [*[()] * parents, range(parents)],
        [*[[0.5, 0.5]] * parents, [p for _ in range(2**parents) for p in random_row(rng, 2, 0.1)]],
    )
    return net, model_of(net, [parents], range(parents))


MODELS = [model(bins=BINS), several(), large(), large(5, 9), model(outputs=[]), wide()[1]]


@pytest.mark.parametrize("made", MODELS)
def test_formatter_and_linter_agree(made):
    assert_plain_data(made.text())


def test_nothing_of_a_hostile_model_becomes_code():
    states = [*HOSTILE, "good"]
    rows = [1 / len(states)] * len(states)
    nodes = [node("in", states, (), rows)]
    table = [p for k in range(len(states)) for p in (k / 10, 1 - k / 10)]
    nodes += [node(HOSTILE[3], ["yes", HOSTILE[1]], ["in"], table)]
    nodes[0] = replace(nodes[0], place=Place("", path=HOSTILE[0]))
    made = model(nodes, [HOSTILE[3]], direct={"in": "in"}, specs={"in": {"attribute": "a b"}})
    assert_plain_data(made.text())
    monitor = made.monitor()
    for k, state in enumerate(states):
        found = posterior(monitor.execute_step(give(**{"a b": state})), HOSTILE[3])
        assert found["yes"] == pytest.approx(k / 10)


def test_a_large_table_is_read_as_it_was_written():
    net, made = wide()
    text = made.text()
    assert "schedule.rows_of(" in text
    step = made.monitor().execute_step
    for row in (0, 1, 777, 2047):
        states = {f"n{k}": f"s{row >> (10 - k) & 1}" for k in range(11)}
        want = net.tables[11][2 * row : 2 * row + 2]
        assert list(posterior(step(give(**states)), "n11").values()) == pytest.approx(list(want))


@pytest.mark.slow
def test_cost_depends_on_the_width_not_on_the_number_of_nodes():
    wide = width_of(grid(8, 8), [63], range(0, 60, 4))
    assert wide.largest <= 2**11
    assert wide == width_of(grid(8, 8), [63], range(0, 60, 4))


@pytest.mark.slow
def test_a_wide_network_is_recognised_without_memory():
    width = width_of(grid(24, 24), [24 * 24 - 1], range(24 * 24 - 1))
    assert width.largest > TOO_LARGE > LARGE
    assert len(width.nodes) > 20


def test_two_monitors_of_one_text_are_independent():
    for made in (several(), large()):
        kind = type(made.monitor())
        one, other = kind(), kind()
        before = other.execute_step(object(), 0)
        values = {node.id: node.states[0] for node in made.model.data.nodes}
        one.execute_step(give(**values, v=1.0, d=1.0, a="b", b="on"), 5)
        assert other.execute_step(object(), 0) == before
        assert one.engine is not other.engine

"""Agreement with pgmpy on the networks that it ships."""

import gzip
import logging
import random
import warnings
from pathlib import Path

import pytest
from hypothesis import settings

pytest.importorskip("pgmpy", reason="pgmpy is no dependency")

from eddi_scaffold.kinds.bayesian_network.network import NumberedNetwork, Shape
from runtime_lib.tests.bayesian_network.networks import engine, furthest

pytestmark = pytest.mark.slow

SETS = 200 if settings.default.max_examples > 1000 else 6
"""Half with hard evidence only, half with virtual evidence as well; more in the long profile."""
SMALL = ("asia", "cancer", "sachs", "child")
LARGE = ("insurance", "water", "alarm", "hailfinder", "win95pts")


@pytest.mark.parametrize("name", SMALL + LARGE)
def test_agreement(name):
    logging.disable(logging.CRITICAL)
    try:
        compare(name)
    finally:
        logging.disable(logging.NOTSET)


def compare(name):
    from pgmpy.factors.discrete import TabularCPD
    from pgmpy.inference import VariableElimination

    model = load(name)
    net = ours(model)
    names, count = net.shape.names, len(net.shape.names)
    rng = random.Random(name)
    picked = rng.sample(range(count), count)
    outputs, observable = sorted(picked[:2]), sorted(picked[2 : 2 + min(count // 2, 12)])
    engines = [engine(net, outputs, observable, tables=tables) for tables in (True, False)]
    peer = VariableElimination(model)
    worst = 0.0
    for number in range(SETS):
        case = sample(rng, net)
        states, weights, hard, virtual = list(engines[0].missing), {}, {}, []
        for position, node in enumerate(observable):
            card = net.shape.cards[node]
            if rng.random() < 0.2:
                continue
            if number % 2 and rng.random() < 0.3:
                vector = [rng.uniform(0.05, 1.0) for _ in range(card)]
                weights[position] = [one / max(vector) for one in vector]
                columns = [[one] for one in weights[position]]
                known = {names[node]: list(net.states[node])}
                virtual.append(TabularCPD(names[node], card, columns, state_names=known))
            else:
                states[position] = case[node]
                hard[names[node]] = net.states[node][case[node]]
        wanted = []
        for node in outputs:
            found = peer.query(
                [names[node]],
                evidence=hard,
                virtual_evidence=virtual or None,
                elimination_order="greedy",
                show_progress=False,
            )
            wanted.append([found.get_value(**{names[node]: one}) for one in net.states[node]])
        for one in engines:
            worst = max(worst, furthest(one.infer(states, weights), wanted))
    assert worst < 1e-12


def load(name):
    """Return a network that lies in the distribution; nothing is downloaded."""
    import pgmpy
    from pgmpy.readwrite import BIFReader

    path = Path(pgmpy.__file__).parent / "utils" / "example_models" / f"{name}.bif.gz"
    if not path.exists():
        pytest.skip(f"pgmpy ships no {name}")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return BIFReader(string=gzip.decompress(path.read_bytes()).decode("utf-8")).get_model()


def ours(model):
    """Return the same network; rows that are off by rounding are divided by their sum there too."""
    names = [str(one) for one in model.nodes()]
    parents, states, tables = [], [], []
    for name in names:
        cpd = model.get_cpds(name)
        cpd.normalize()
        parents.append(tuple(names.index(one) for one in cpd.variables[1:]))
        states.append(tuple(cpd.state_names[name]))
        tables.append(tuple(cpd.get_values().T.ravel().tolist()))
    shape = Shape(tuple(names), tuple(map(len, states)), tuple(parents))
    return NumberedNetwork(shape, tuple(states), tuple(tables), tuple(names))


def sample(rng, net):
    found = {}
    while len(found) < len(net.shape.names):
        for node, parents in enumerate(net.shape.parents):
            if node not in found and all(one in found for one in parents):
                row, card = 0, net.shape.cards[node]
                for one in parents:
                    row = row * net.shape.cards[one] + found[one]
                values = net.tables[node][row * card : (row + 1) * card]
                found[node] = rng.choices(range(card), values)[0]
    return found

"""Small networks as typed models, random ones, and the plainest inference there is."""

from __future__ import annotations

import itertools
import math
from fractions import Fraction
from types import SimpleNamespace

import pytest
from eddi_runtime.bayesian_network.engine import Engine
from eddi_runtime.bayesian_network.memory import Remembering
from eddi_runtime.bayesian_network.readers import Discretiser

from eddi_scaffold.kinds.bayesian_network import inference_plan
from eddi_scaffold.kinds.bayesian_network.discretisation import Declaration as NodeDeclaration
from eddi_scaffold.kinds.bayesian_network.discretisation import reader_of
from eddi_scaffold.kinds.bayesian_network.inference_plan import Width
from eddi_scaffold.kinds.bayesian_network.network import Network, Node, NumberedNetwork, Shape
from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions, Threshold
from runtime_lib.tests.bound_models import bound_input, bound_model


def node(name, states, parents=(), table=()):
    states = states.split() if isinstance(states, str) else states
    parents = parents.split() if isinstance(parents, str) else parents
    return Node(name, name, tuple(states), tuple(parents), tuple(map(float, table)))


SPEED = node("Speed", "stands slow fast", (), [0.2, 0.5, 0.3])
GAP = node("Gap", "near far", (), [0.25, 0.75])
DANGER = node(
    "Danger", "yes no", "Speed Gap", [0.1, 0.9, 0.0, 1.0, 0.6, 0.4, 0.1, 0.9, 0.95, 0.05, 0.2, 0.8]
)
ALARM = node("Alarm", "on off", "Danger", [0.9, 0.1, 0.01, 0.99])
NODES = (SPEED, GAP, DANGER, ALARM)
NEAR = node("Near", "yes no", (), [0.3, 0.7])
HUMAN = node("Human", "yes no", (), [0.2, 0.8])
RISK = node("Risk", "High Low", "Near Human", [0.9, 0.1, 0.4, 0.6, 0.2, 0.8, 0.05, 0.95])
RISKS = (NEAR, HUMAN, RISK)
SPEED_BINS = {"input": "v", "scale": 3.6, "bins": [0.5, 20.0]}
GAP_BINS = {"input": "d", "bins": [2.0], "order": ["near", "far"]}
BINS = {"Speed": SPEED_BINS, "Gap": GAP_BINS}


def model(
    nodes=NODES,
    outputs=("Danger",),
    bins=None,
    direct=None,
    observed=(),
    specs=None,
    thresholds=(),
    evidence_mode="virtual",
    **more,
):
    network = Network("net", tuple(nodes))
    declarations, direct = declared(bins or {}, network), dict(direct or {})
    names = dict.fromkeys([*(one.input for one in declarations), *direct.values()])
    inputs = [bound_input(one, **(specs or {}).get(one, {})) for one in names]
    fed = {*direct, *(one.node for one in declarations)}
    options = NetworkOptions(
        tuple(outputs),
        tuple(name for name in network.names() if name in {*fed, *observed}),
        declarations,
        direct,
        (),
        Width(0, ()),
        virtual=evidence_mode == "virtual",
        thresholds=tuple(thresholds),
        **more,
    )
    return bound_model("bayesian_network", "net", network, options, inputs)


def declared(bins, network):
    return tuple(
        NodeDeclaration(name, one["input"], "float", reader(one, network.node(name).states))
        for name, one in bins.items()
    )


def reader(one, states):
    """Return what the runtime takes of an entry; a map may be written as one."""
    pairs = {"map": [*one["map"].items()]} if isinstance(one.get("map"), dict) else {}
    return reader_of({**one, **pairs}, states)


def threshold(name="Low", node="Risk", states=("High",), hold_s=0.0, release=None, **limit):
    ((key, activate),) = limit.items()
    release = activate if release is None else release
    return Threshold(name, node, tuple(states), key == "at_least", activate, release, hold_s, None)


def monitor(*args, hooks=None, **kwargs):
    made = model(*args, **kwargs).module().Monitor
    return made() if hooks is None else made(hooks)


def model_of(net, outputs, observed=()):
    """Return the model of a network by numbers; what is observed has an input of its name."""
    names = net.shape.names
    direct = {names[k]: names[k] for k in observed}
    return model(nodes_of(net), [names[k] for k in outputs], direct=direct)


def nodes_of(net):
    names = net.shape.names
    return [
        node(name, net.states[k], [names[one] for one in net.shape.parents[k]], net.tables[k])
        for k, name in enumerate(names)
    ]


def engine(net, outputs, observable, *, tables=True):
    """Return inference for some outputs and observable nodes."""
    with pytest.MonkeyPatch.context() as patch:
        if not tables:
            patch.setattr(inference_plan, "fits", lambda *_: False)
        made = model_of(net, outputs, observable).monitor()
    return Engine(made.nodes, made.foreseen)


def discretiser(given, states, spec):
    given = {key: value for key, value in given.items() if value is not None}
    arguments = reader(given, states)
    remembers = arguments.hysteresis or arguments.policy == "hold"
    return (Remembering if remembers else Discretiser)(arguments, spec)


def give(**values):
    return SimpleNamespace(**values)


def posterior(output, title="Danger"):
    """Return state -> probability of one output, None if it is not there."""
    for one in output:
        for found in one.output_nodes:
            if found.title == title:
                return {outcome.name: outcome.value for outcome in found.outcomes}
    return None


def network(cards, parents, tables):
    names = tuple(f"n{k}" for k in range(len(cards)))
    states = tuple(tuple(f"s{j}" for j in range(card)) for card in cards)
    shape = Shape(names, tuple(cards), tuple(tuple(one) for one in parents))
    return NumberedNetwork(shape, states, tuple(tuple(map(float, one)) for one in tables))


def random_network(rng, count, most_parents=3, zeros=0.2, most_states=4, least_states=2):
    """Return a network whose node k has parents below k; rows have zeros and certainties."""
    cards = [rng.randint(least_states, most_states) for _ in range(count)]
    parents = [rng.sample(range(k), rng.randint(0, min(k, most_parents))) for k in range(count)]
    tables = []
    for k in range(count):
        rows = math.prod(cards[one] for one in parents[k])
        tables.append([value for _ in range(rows) for value in random_row(rng, cards[k], zeros)])
    return network(cards, parents, tables)


def random_row(rng, card, zeros):
    row = [0 if rng.random() < zeros else rng.randint(1, 1000) for _ in range(card)]
    if not any(row):
        row[rng.randrange(card)] = 1
    return [one / sum(row) for one in row]


def random_evidence(rng, net, observable, soft=0.25, missing=0.25):
    """Return (states, weights) as ``Engine.infer`` takes them."""
    states, weights = [], {}
    for position, one in enumerate(observable):
        card = net.shape.cards[one]
        states.append(card if rng.random() < missing else rng.randrange(card))
        if rng.random() < soft:
            vector = [rng.choice([0.0, rng.random(), rng.random()]) for _ in range(card)]
            if any(vector):
                weights[position] = [value / max(vector) for value in vector]
                states[position] = card
    return states, weights


def enumerate_all(net, outputs, observable, states, weights, number=float):
    """Return the posteriors by adding up every combination of states; None if all are zero."""
    cards = net.shape.cards
    sums = [[number(0)] * cards[one] for one in outputs]
    for case in itertools.product(*(range(card) for card in cards)):
        p = number(1)
        for position, one in enumerate(observable):
            if position in weights:
                p *= number(weights[position][case[one]])
            elif states[position] not in (cards[one], case[one]):
                p = number(0)
        for one, card in enumerate(cards):
            if not p:
                break
            row = 0
            for parent in net.shape.parents[one]:
                row = row * cards[parent] + case[parent]
            p *= number(net.tables[one][row * card + case[one]])
        for row, one in zip(sums, outputs):
            row[case[one]] += p
        if not outputs and p:
            return []
    if not outputs or not sum(sums[0]):
        return None
    return [[value / sum(row) for value in row] for row in sums]


def exactly(*args):
    rows = enumerate_all(*args, number=Fraction)
    return None if rows is None else [[float(value) for value in row] for row in rows]


def furthest(rows, wanted):
    pairs = [(p, q) for row, want in zip(rows, wanted) for p, q in zip(row, want)]
    return max((abs(p - q) for p, q in pairs), default=0.0)


def grid(rows, columns, card=2):
    """Return the shape of a grid: each node has the one above and the one to the left."""
    parents = []
    for row in range(rows):
        for column in range(columns):
            above = [(row - 1) * columns + column] if row else []
            parents.append((*above, *([row * columns + column - 1] if column else [])))
    names = tuple(f"x{k}" for k in range(rows * columns))
    return Shape(names, (card,) * len(names), tuple(parents))

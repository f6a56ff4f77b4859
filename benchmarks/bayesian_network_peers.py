"""The same networks in pgmpy and pyAgrum, and the networks that are measured.

Everything is passed in memory: readers and writers of other tools change names or orders.
"""

from __future__ import annotations

import gzip
import importlib.util
import logging
import math
import random
import warnings
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from eddi_scaffold.kinds.bayesian_network.network import Network, Node

Evidence = Mapping[int, "int | Sequence[float]"]
"""Node -> its state, or likelihoods."""
Infer = Callable[[Evidence], object]

SHIPPED = ("asia", "child", "insurance", "alarm", "water", "hailfinder", "win95pts")
"""Networks that lie in pgmpy's distribution; nothing is downloaded."""


class Net(NamedTuple):
    """A network; nodes and states are numbers, parents come before the node itself in a table."""

    cards: list[int]
    parents: list[list[int]]
    tables: list[list[float]]


def chain(length: int) -> Net:
    return made([[k - 1] if k else [] for k in range(length)], 3)


def grid(rows: int, columns: int) -> Net:
    parents = [
        [*([k - columns] if k >= columns else []), *([k - 1] if k % columns else [])]
        for k in range(rows * columns)
    ]
    return made(parents, 2)


def made(parents: list[list[int]], card: int) -> Net:
    """Return a network with random tables, the same in every run."""
    rng = random.Random(len(parents))
    tables = []
    for own in parents:
        rows = [[rng.uniform(0.05, 1.0) for _ in range(card)] for _ in range(card ** len(own))]
        tables.append([one / math.fsum(row) for row in rows for one in row])
    return Net([card] * len(parents), parents, tables)


def shipped(name: str) -> Net | None:
    """Return a network of pgmpy, None when it is not there."""
    spec = importlib.util.find_spec("pgmpy")
    if spec is None or spec.origin is None:
        return None
    path = Path(spec.origin).parent / "utils" / "example_models" / f"{name}.bif.gz"
    if not path.exists():
        return None
    quiet()
    from pgmpy.readwrite import BIFReader

    model = BIFReader(string=gzip.decompress(path.read_bytes()).decode()).get_model()
    names = list(model.nodes())
    cards, parents, tables = [], [], []
    for node in names:
        cpd = model.get_cpds(node)
        cpd.normalize()
        cards.append(int(cpd.variable_card))
        parents.append([names.index(one) for one in cpd.variables[1:]])
        tables.append([float(one) for one in cpd.get_values().T.ravel()])
    return Net(cards, parents, tables)


def quiet() -> None:
    warnings.simplefilter("ignore")
    logging.disable(logging.CRITICAL)


def pgmpy_as_generated(net: Net, outputs: Sequence[int]) -> Infer:
    """Return what D7.2's generated code does in each step: a new inference, one query per output.

    Raises:
        ImportError: pgmpy is not installed.
    """
    quiet()
    from pgmpy.factors.discrete import TabularCPD
    from pgmpy.inference import VariableElimination
    from pgmpy.models import DiscreteBayesianNetwork

    names = [f"n{k}" for k in range(len(net.cards))]
    model = DiscreteBayesianNetwork()
    model.add_nodes_from(names)
    for k, own in enumerate(net.parents):
        model.add_edges_from((names[one], names[k]) for one in own)
    for k, own in enumerate(net.parents):
        columns = [net.tables[k][state :: net.cards[k]] for state in range(net.cards[k])]
        known = [names[one] for one in own]
        model.add_cpds(
            TabularCPD(names[k], net.cards[k], columns, known, [net.cards[j] for j in own])
        )

    def infer(evidence: Evidence) -> object:
        hard = {names[k]: value for k, value in evidence.items() if isinstance(value, int)}
        soft = [
            TabularCPD(names[k], net.cards[k], [[one] for one in value])
            for k, value in evidence.items()
            if not isinstance(value, int)
        ]
        inference = VariableElimination(model)
        return [
            inference.query(
                [names[one]],
                evidence=hard,
                virtual_evidence=soft or None,
                elimination_order="greedy",
                show_progress=False,
            ).values.tolist()
            for one in outputs
        ]

    return infer


def pyagrum_lazy(net: Net, outputs: Sequence[int]) -> Infer:
    """Return pyAgrum's LazyPropagation, made once.

    Raises:
        ImportError: pyAgrum is not installed.
    """
    import pyagrum

    names = [f"n{k}" for k in range(len(net.cards))]
    model = pyagrum.BayesNet()
    for name, card in zip(names, net.cards, strict=True):
        model.add(pyagrum.LabelizedVariable(name, name, [f"s{k}" for k in range(card)]))
    for k, own in enumerate(net.parents):
        for one in own:
            model.addArc(names[one], names[k])
    for k, own in enumerate(net.parents):
        table, card = model.cpt(names[k]), net.cards[k]
        for row in range(len(net.tables[k]) // card):
            case: dict[str, int] = {}
            rest = row
            for one in reversed(own):
                rest, case[names[one]] = divmod(rest, net.cards[one])
            values = net.tables[k][row * card : (row + 1) * card]
            table[case or slice(None)] = values
    lazy = pyagrum.LazyPropagation(model)
    lazy.setTargets({names[one] for one in outputs})

    def infer(evidence: Evidence) -> object:
        lazy.setEvidence({names[k]: value for k, value in evidence.items()})
        lazy.makeInference()
        return [lazy.posterior(names[one]).tolist() for one in outputs]

    return infer


PEERS: Mapping[str, Callable[[Net, Sequence[int]], Infer]] = {
    "pgmpy, as generated": pgmpy_as_generated,
    "pyAgrum LazyPropagation": pyagrum_lazy,
}


def sampled(net: Net, rng: random.Random) -> list[int]:
    """Return states that are possible together."""
    found: dict[int, int] = {}
    while len(found) < len(net.cards):
        for node, own in enumerate(net.parents):
            if node not in found and all(one in found for one in own):
                row = 0
                for one in own:
                    row = row * net.cards[one] + found[one]
                card = net.cards[node]
                values = net.tables[node][row * card : (row + 1) * card]
                found[node] = rng.choices(range(card), values)[0]
    return [found[node] for node in range(len(found))]


def network_of(net: Net) -> Network:
    """Return the typed network of the generator."""
    nodes = [
        Node(
            f"n{k}",
            f"n{k}",
            tuple(f"s{state}" for state in range(card)),
            tuple(f"n{parent}" for parent in net.parents[k]),
            tuple(map(float, net.tables[k])),
        )
        for k, card in enumerate(net.cards)
    ]
    return Network("Benchmark", tuple(nodes))

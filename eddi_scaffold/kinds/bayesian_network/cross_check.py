"""The compiled network compared with pgmpy, before a package is written (extra ``bn``)."""

from __future__ import annotations

import itertools
import logging
import math
import random
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from eddi_runtime.bayesian_network import BayesianNetworkMonitor
from eddi_runtime.bayesian_network.outputs import Answer, finding

from eddi_scaffold.common.problems import Place, problem
from eddi_scaffold.kinds import CrossCheck
from eddi_scaffold.kinds.bayesian_network.network import Network
from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions

Case = Mapping[str, str | Sequence[float]]
"""Node -> the name of its state, or one likelihood per state."""
EVERY_CASE = 2000  # Up to so many cases of hard and missing evidence are all tried
CASES, SOFT_CASES = 200, 50
TOLERANCE = 1e-9
_ROUNDING = 1e-12


def cross_check(
    network: Network, settings: NetworkOptions, running: Callable[[], BayesianNetworkMonitor]
) -> CrossCheck:
    """Compare posteriors of the engine that will run with those of pgmpy (B306)."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # it warns of its own modules
            import pgmpy.inference  # noqa: F401, PLC0415 - an extra of 500 MB
    except ImportError:
        place = Place(network.place.file)  # no line of the model is to blame
        return CrossCheck("", (problem("B306.not_run", place),))
    monitor, peer = running(), _PgmpyNetwork(network)
    cases, largest = list(_cases(network, settings.observed)), 0.0
    for case in cases:
        ours = posteriors(monitor, case)
        if ours is None:
            continue  # pgmpy reports it only where the contradiction affects the query
        for output in settings.inferred:
            for p, q in zip(ours[output], peer.posterior(output, case), strict=True):
                largest = max(largest, 1.0 if math.isnan(q) else abs(p - q))
    if largest > TOLERANCE:
        return CrossCheck("", (problem("B306.differs", network.place, largest=largest),))
    # Digits below that differ between machines; what is written must not.
    bound = 10.0 ** math.ceil(math.log10(max(largest, _ROUNDING)))
    tried = f"{len(cases)} sets of evidence"
    return CrossCheck(f"Cross-checked with pgmpy: {tried}, largest difference below {bound:g}.")


def posteriors(monitor: BayesianNetworkMonitor, case: Case) -> dict[str, tuple[float, ...]] | None:
    """Return the posterior of each output, ``None`` if the evidence has probability zero.

    Steps are not touched; no monitor needs it.
    """
    numbers = {spec.id: node for node, spec in enumerate(monitor.nodes)}
    answer = Answer()
    for name, value in case.items():
        names = monitor.nodes[numbers[name]].states
        judged = names.index(value) if isinstance(value, str) else finding(value, names)
        if judged is not None:
            answer.findings[numbers[name]] = judged
    engine = monitor.engine
    states = list(engine.missing)
    weights: dict[int, list[float]] = {}
    answer.put(engine, states, weights)
    rows = engine.infer(states, weights)
    if rows is None:
        return None
    return {
        monitor.nodes[node].id: tuple(row) for node, row in zip(engine.outputs, rows, strict=True)
    }


def _cases(network: Network, observed: Sequence[str]) -> Iterator[Case]:
    """Yield evidence: all hard sets of a small network, else random ones, then soft ones."""
    states_of = {name: network.node(name).states for name in observed}
    rng = random.Random(1)  # noqa: S311 - repeatable on purpose
    if math.prod(len(states) + 1 for states in states_of.values()) <= EVERY_CASE:
        for chosen in itertools.product(*((None, *states) for states in states_of.values())):
            pairs = zip(states_of, chosen, strict=True)
            yield {name: state for name, state in pairs if state is not None}
    else:
        for _ in range(CASES):
            yield {
                name: states[int(rng.random() * len(states))]
                for name, states in states_of.items()
                if rng.random() < 0.7
            }
    for _ in range(SOFT_CASES if states_of else 0):
        yield {
            name: [0.05 + rng.random() for _ in states]
            if rng.random() < 0.5
            else states[int(rng.random() * len(states))]
            for name, states in states_of.items()
            if rng.random() < 0.8
        }


class _PgmpyNetwork:
    """The network in pgmpy, passed in memory: its readers and writers change names."""

    def __init__(self, network: Network) -> None:
        from pgmpy.factors.discrete import TabularCPD  # noqa: PLC0415 - an extra
        from pgmpy.inference import VariableElimination  # noqa: PLC0415 - an extra
        from pgmpy.models import DiscreteBayesianNetwork  # noqa: PLC0415 - an extra

        logging.getLogger("pgmpy").setLevel(logging.ERROR)
        self._states = {node.id: list(node.states) for node in network.nodes}
        self._cpd = TabularCPD
        self._model = DiscreteBayesianNetwork()
        self._model.add_nodes_from(network.names())
        self._model.add_edges_from((p, node.id) for node in network.nodes for p in node.parents)
        for node in network.nodes:
            width, parents = len(node.states), list(node.parents)
            rows = [list(node.table[k::width]) for k in range(width)]
            cards = [len(self._states[parent]) for parent in parents]
            names = {name: self._states[name] for name in (node.id, *parents)}
            cpd = TabularCPD(node.id, width, rows, parents, cards, state_names=names)
            self._model.add_cpds(cpd)
        self._elimination = VariableElimination
        self._inference = VariableElimination(self._model)

    def posterior(self, output: str, case: Case) -> list[float]:
        """Return the posterior of one output; NaN for evidence of probability zero."""
        hard = {name: value for name, value in case.items() if isinstance(value, str)}
        soft: list[Any] = []
        for name, value in case.items():
            if not isinstance(value, str):
                column = [[likelihood / max(value)] for likelihood in value]
                names = {name: self._states[name]}
                soft.append(self._cpd(name, len(value), column, state_names=names))
        if output in hard:
            return [float(state == hard[output]) for state in self._states[output]]
        # Virtual evidence changes the model: each query has its own.
        inference = self._elimination(self._model) if soft else self._inference
        factor = inference.query(
            [output],
            evidence=hard or None,
            virtual_evidence=soft or None,
            elimination_order="greedy",
            show_progress=False,
        )
        states = factor.state_names[output]
        return [float(factor.values[states.index(state)]) for state in self._states[output]]

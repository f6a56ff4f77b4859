"""The compiled network compared with pgmpy, before a package is written (extra ``bn``)."""

from __future__ import annotations

import itertools
import math
import random
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from eddi_runtime.bayesian_network import BayesianNetworkMonitor
from eddi_runtime.bayesian_network.asking import InconsistentEvidenceError, posteriors

from eddi_scaffold.common.problems import Place, problem
from eddi_scaffold.kinds import CrossCheck
from eddi_scaffold.kinds.bayesian_network.network import Network
from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions

EVERY_CASE = 2000
"""Up to so many cases of hard and missing evidence are all tried."""
CASES, SOFT_CASES = 200, 50
TOLERANCE = 1e-9
_ROUNDING = 1e-12
Case = Mapping[str, "str | list[float]"]


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
        found = problem("B306.not_run", place)
        return CrossCheck("", (found,))
    monitor = running()
    cases = list(cases_of(network, settings.observed))
    peer = PgmpyNetwork(network)
    largest = 0.0
    for case in cases:
        largest = max(largest, _difference(monitor, peer, settings.inferred, case))
    if largest > TOLERANCE:
        return CrossCheck("", (problem("B306.differs", network.place, largest=largest),))
    # Digits below that differ between machines; what is written must not.
    bound = 10.0 ** math.ceil(math.log10(max(largest, _ROUNDING)))
    tried = f"{len(cases)} sets of evidence"
    return CrossCheck(f"Cross-checked with pgmpy: {tried}, largest difference below {bound:g}.")


def cases_of(network: Network, observed: Sequence[str], seed: int = 1) -> Iterator[Case]:
    """Yield evidence: all hard sets of a small network, else random ones, then soft ones."""
    states = {name: network.node(name).states for name in observed}
    count = math.prod(len(of) + 1 for of in states.values())
    rng = random.Random(seed)  # noqa: S311 - repeatable on purpose
    if count <= EVERY_CASE:
        for chosen in itertools.product(*((None, *of) for of in states.values())):
            yield {n: state for n, state in zip(states, chosen, strict=True) if state is not None}
    else:
        for _ in range(CASES):
            yield {
                name: of[int(rng.random() * len(of))]
                for name, of in states.items()
                if rng.random() < 0.7
            }
    for _ in range(SOFT_CASES if states else 0):
        yield {
            name: [0.05 + rng.random() for _ in of]
            if rng.random() < 0.5
            else of[int(rng.random() * len(of))]
            for name, of in states.items()
            if rng.random() < 0.8
        }


class PgmpyNetwork:
    """The network in pgmpy, passed in memory: its readers and writers change names."""

    def __init__(self, network: Network) -> None:
        import logging  # noqa: PLC0415 - only here

        from pgmpy.factors.discrete import TabularCPD  # noqa: PLC0415 - an extra
        from pgmpy.inference import VariableElimination  # noqa: PLC0415 - an extra
        from pgmpy.models import DiscreteBayesianNetwork  # noqa: PLC0415 - an extra

        logging.getLogger("pgmpy").setLevel(logging.ERROR)
        self.network = network
        self._cpd = TabularCPD
        model = DiscreteBayesianNetwork()
        model.add_nodes_from(network.names())
        for node in network.nodes:
            for parent in node.parents:
                model.add_edge(parent, node.id)
        for node in network.nodes:
            model.add_cpds(self._table(node.id))
        self._inference = VariableElimination(model)
        self._elimination = VariableElimination
        self._model = model

    def _table(self, name: str) -> Any:
        node = self.network.node(name)
        width = len(node.states)
        rows = [list(node.table[k::width]) for k in range(width)]
        cards = [len(self.network.node(parent).states) for parent in node.parents]
        names = {one: list(self.network.node(one).states) for one in (name, *node.parents)}
        return self._cpd(name, width, rows, list(node.parents), cards, state_names=names)

    def posterior(self, output: str, case: Case) -> list[float]:
        """Return the posterior of one output; NaN for evidence of probability zero."""
        hard = {name: value for name, value in case.items() if isinstance(value, str)}
        soft = [
            self._soft(name, value) for name, value in case.items() if not isinstance(value, str)
        ]
        if output in hard:
            states = self.network.node(output).states
            return [float(state == hard[output]) for state in states]
        inference = self._elimination(self._model) if soft else self._inference
        found = inference.query(
            [output],
            evidence=hard or None,
            virtual_evidence=soft or None,
            elimination_order="greedy",
            show_progress=False,
        )
        index = found.state_names[output]
        return [float(found.values[index.index(s)]) for s in self.network.node(output).states]

    def _soft(self, name: str, likelihoods: Iterable[float]) -> Any:
        values = list(likelihoods)
        top = max(values)
        states = {name: list(self.network.node(name).states)}
        return self._cpd(name, len(values), [[v / top] for v in values], state_names=states)


def _difference(
    monitor: BayesianNetworkMonitor, peer: PgmpyNetwork, outputs: Sequence[str], case: Case
) -> float:
    try:
        ours = posteriors(monitor, case)
    except InconsistentEvidenceError:
        return 0.0  # pgmpy reports it only where the contradiction affects the query
    largest = 0.0
    for output in outputs:
        theirs = peer.posterior(output, case)
        pairs = zip(ours[output], theirs, strict=True)
        largest = max(largest, *(1.0 if math.isnan(b) else abs(a - b) for a, b in pairs))
    return largest

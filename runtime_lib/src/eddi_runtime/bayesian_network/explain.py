"""How much each observed node moved the posteriors of the last step (``explain: true``)."""

from __future__ import annotations

from ..monitor import Tree
from .monitor import BayesianNetworkMonitor


class Explaining(BayesianNetworkMonitor):
    """A monitor that says why, besides what else it is."""

    def status_message(self) -> Tree:
        name, fields = super().status_message()
        relevance = self._relevance()
        names, values = list(relevance), list(relevance.values())
        return name, {**fields, "relevance_nodes": names, "relevance": values}

    def _relevance(self) -> dict[str, float]:
        last = self._last
        relevance: dict[str, float] = {}
        all_known = self._tried(last.states, last.weights)
        for position, node in enumerate(self.engine.observable if all_known is not None else ()):
            states, weights = list(last.states), dict(last.weights)
            states[position] = self._missing[position]
            if not weights.pop(position, None) and states == last.states:
                continue
            without = self._tried(states, weights)
            pairs = zip(all_known or (), without or ())  # never None: less is claimed
            moved = [0.5 * sum(abs(p - q) for p, q in zip(*rows)) for rows in pairs]
            relevance[self.nodes[node].id] = max(moved, default=0.0)
        return relevance

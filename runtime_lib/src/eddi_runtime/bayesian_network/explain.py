"""How much each observed node moved the posteriors of the last step (``explain: true``)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Mapping, NamedTuple

from ..monitor import Tree
from .monitor import BayesianNetworkMonitor
from .outputs import Facts, Known

if TYPE_CHECKING:
    from .outputs import Claim


class Explanation(NamedTuple):
    """Explanation of the posteriors of one step."""

    # observed node -> its state, or its likelihoods (the largest is 1)
    evidence: Mapping[str, Known]
    unobserved: tuple[str, ...]  # nodes of which nothing is known
    # observed node -> largest total variation distance of an output, 0 to 1, between all evidence
    # and without that of this node; empty if the evidence has probability zero
    relevance: Mapping[str, float]
    facts: Facts  # which inputs are known, and what is accepted for others
    claims: tuple[Claim, ...]  # the result of each threshold

    def text(self) -> str:
        lines = []
        for name in sorted(self.evidence, key=lambda node: -self.relevance.get(node, 0.0)):
            value = self.evidence[name]
            shown = value if isinstance(value, str) else ", ".join(f"{p:.3g}" for p in value)
            moved = f", moves an output by {self.relevance[name]:.3g}" if self.relevance else ""
            lines.append(f"{name}: {shown}{moved}")
        lines += [f"{name}: not observed" for name in self.unobserved]
        facts = self.facts
        lines += [f"{name}: {' or '.join(states)}" for name, states in facts.undecided.items()]
        lines += [f"unknown: {', '.join(facts.unknown_inputs)}"] if facts.unknown_inputs else []
        lines += [f"accepted: {key}" for key in facts.accepted]
        return "\n".join([*lines, *(claim.text() for claim in self.claims)])


class Explaining(BayesianNetworkMonitor):
    """A monitor that says why, besides what else it is."""

    def explain(self) -> Explanation:
        """Return what was known in the last step, and how much each observed node mattered."""
        evidence, unobserved = self._evidence()
        facts, claims = self.facts(), tuple(self.claims())
        return Explanation(evidence, tuple(unobserved), self._relevance(), facts, claims)

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

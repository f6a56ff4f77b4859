"""How much each observed node moved the posteriors of the last step."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Dict, List, Mapping, Sequence, Tuple, Union

from .claims import Claim
from .engine import Engine, Posteriors
from .knowledge import Facts

_ALL_KNOWN = Facts(valid=True, unknown_inputs=(), undecided={}, accepted=())


@dataclass(frozen=True)
class Explanation:
    """Explanation of the posteriors of one step.

    Attributes:
        evidence: observed node -> its state, or its likelihoods (the largest is 1).
        unobserved: nodes of which nothing is known.
        relevance: observed node -> total variation distance between the posterior with all
            evidence and without that of this node, 0 to 1; the largest over the outputs. Empty if
            the evidence has probability zero.
        facts: which inputs are known, and what is accepted for others.
        claims: the result of each threshold.
    """

    evidence: Mapping[str, Union[str, Tuple[float, ...]]]
    unobserved: Tuple[str, ...]
    relevance: Mapping[str, float]
    facts: Facts = _ALL_KNOWN
    claims: Tuple[Claim, ...] = ()

    def text(self) -> str:
        """Return the explanation for people, the most relevant node first."""
        lines = []
        for name in sorted(self.evidence, key=lambda one: -self.relevance.get(one, 0.0)):
            value = self.evidence[name]
            shown = value if isinstance(value, str) else ", ".join(f"{one:.3g}" for one in value)
            moved = f", moves an output by {self.relevance[name]:.3g}" if self.relevance else ""
            lines.append(f"{name}: {shown}{moved}")
        lines += [f"{name}: not observed" for name in self.unobserved]
        facts = self.facts
        lines += [f"{name}: {' or '.join(states)}" for name, states in facts.undecided.items()]
        lines += [f"unknown: {', '.join(facts.unknown_inputs)}"] if facts.unknown_inputs else []
        lines += [f"accepted: {one}" for one in facts.accepted]
        lines += [_of_claim(one) for one in self.claims]
        return "\n".join(lines)


def _of_claim(one: Claim) -> str:
    bounds = f"{one.low:.3g}" if one.low == one.high else f"{one.low:.3g} to {one.high:.3g}"
    shown = "" if math.isnan(one.low) else f", {bounds}"
    reason = f" ({one.reason})" if one.reason else ""
    return f"{one.id}: {'active' if one.active else 'not active'}{shown}{reason}"


def explain(
    engine: Engine, states: Sequence[int], weights: Mapping[int, Sequence[float]]
) -> Explanation:
    """Explain the posteriors for some evidence: one inference for each observed node."""
    network = engine.network
    names = [network.shape.names[node] for node in engine.observable]
    evidence: Dict[str, Union[str, Tuple[float, ...]]] = {}
    observed: List[int] = []
    for position, node in enumerate(engine.observable):
        if position in weights:
            evidence[names[position]] = tuple(weights[position])
        elif states[position] != engine.missing[position]:
            evidence[names[position]] = network.states[node][states[position]]
        else:
            continue
        observed.append(position)
    all_known = engine.infer(states, weights)
    relevance: Dict[str, float] = {}
    for position in observed if all_known is not None else ():
        fewer = list(states)
        fewer[position] = engine.missing[position]
        others = {one: weight for one, weight in weights.items() if one != position}
        without = engine.infer(fewer, others)
        if without is not None and all_known is not None:  # never None: less is claimed
            relevance[names[position]] = _distance(all_known, without)
    return Explanation(evidence, tuple(one for one in names if one not in evidence), relevance)


def _distance(one: Posteriors, other: Posteriors) -> float:
    pairs = zip(one, other)
    apart = (0.5 * sum(abs(p - q) for p, q in zip(left, right)) for left, right in pairs)
    return max(apart, default=0.0)

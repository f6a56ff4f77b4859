"""How much each observed node moved the posteriors of the last step."""

from __future__ import annotations

import math
from typing import Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

from .claims import Claim
from .knowledge import Facts
from .program import NodeSpec, Rows

_ALL_KNOWN = Facts(valid=True, unknown_inputs=(), undecided={}, accepted=())


class Explanation(NamedTuple):
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
    nodes: Sequence[NodeSpec],
    missing: Sequence[int],
    infer: Callable[..., Optional[Rows]],
    states: Sequence[int],
    weights: Mapping[int, Sequence[float]],
) -> Explanation:
    """Explain the posteriors for some evidence: one inference for each observed node.

    Args:
        nodes: the observable ones.
        missing: "not observed" for each of them.
        infer: returns the posteriors for states and likelihoods; None: they are impossible.
        states: as ``infer`` takes them.
        weights: as ``infer`` takes them.
    """
    evidence: Dict[str, Union[str, Tuple[float, ...]]] = {}
    observed: List[int] = []
    for position, node in enumerate(nodes):
        if position in weights:
            evidence[node.id] = tuple(weights[position])
        elif states[position] != missing[position]:
            evidence[node.id] = node.states[states[position]]
        else:
            continue
        observed.append(position)
    all_known = infer(list(states), weights)
    relevance: Dict[str, float] = {}
    for position in observed if all_known is not None else ():
        fewer = list(states)
        fewer[position] = missing[position]
        without = infer(fewer, {one: w for one, w in weights.items() if one != position})
        if without is not None and all_known is not None:  # never None: less is claimed
            relevance[nodes[position].id] = _distance(all_known, without)
    unobserved = tuple(one.id for one in nodes if one.id not in evidence)
    return Explanation(evidence, unobserved, relevance)


def _distance(one: Rows, other: Rows) -> float:
    pairs = zip(one, other)
    apart = (0.5 * sum(abs(p - q) for p, q in zip(left, right)) for left, right in pairs)
    return max(apart, default=0.0)

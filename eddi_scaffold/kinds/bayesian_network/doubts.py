"""Evidence that is weaker than it seems."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from eddi_runtime.bayesian_network.bounds import COMBINATIONS

from eddi_scaffold.kinds import Options
from eddi_scaffold.kinds.bayesian_network.discretisation import Declaration
from eddi_scaffold.kinds.bayesian_network.model import Network, in_digits
from eddi_scaffold.kinds.bayesian_network.thresholds import KEY, Threshold
from eddi_scaffold.problems import Problem, warning


def doubts(
    network: Network,
    thresholds: Sequence[Threshold],
    declarations: Sequence[Declaration],
    observed: Sequence[str],
    options: Options,
) -> Iterable[Problem]:
    """Warn of evidence that is of little use (B424, B425)."""
    if not thresholds:
        return
    for one in thresholds:
        if one.node in observed:
            message = f"evidence {one.id!r}: the node {one.node!r} may be observed itself"
            hint = "while it is, the threshold uses the observation; otherwise any state may be"
            yield warning("B424", message, one.place, hint)
    accepted = {one.node for one in declarations if one.data.get("missing") == "prior"}
    yield from _too_many(network, [n for n in observed if n not in accepted], options)


def _too_many(network: Network, inputs: Iterable[str], options: Options) -> Iterable[Problem]:
    cards = {name: len(network.node(name).states) for name in inputs}
    count = math.prod(cards.values())
    if count > COMBINATIONS:
        nodes = [f"{name} {card}" for name, card in cards.items()]
        shown = " x ".join(nodes[:6]) + (" x ..." if len(nodes) > 6 else "")
        message = (
            f"while all inputs are unknown, there are {in_digits(count)} combinations of states "
            f"({shown}); no evidence is active above {COMBINATIONS}"
        )
        hint = "observe fewer nodes, or accept a prior by name: `missing: prior`"
        yield warning("B425", message, options.place(KEY), hint)

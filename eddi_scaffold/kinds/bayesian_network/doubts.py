"""Evidence that says less than it seems to, or rests on more than what is known."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from eddi_runtime.bayesian_network import COMBINATIONS

from eddi_scaffold.kinds import Options
from eddi_scaffold.kinds.bayesian_network.discretisation import Declaration
from eddi_scaffold.kinds.bayesian_network.influence import reached
from eddi_scaffold.kinds.bayesian_network.model import Network, in_digits
from eddi_scaffold.kinds.bayesian_network.thresholds import KEY, Threshold
from eddi_scaffold.problems import Problem, warning

_ACCEPTED = {
    ("missing", "prior"): "the prior of its node while {input} is unknown",
    ("missing", "default"): "the default of {input} while that is unknown",
    ("missing", "hold"): "the last state, for max_age more, when {input} fell silent",
    ("out_of_range", "clamp"): "the nearest value while {input} is outside its range",
    ("allow_inf", True): "{input} while that is infinite",
}


def doubts(
    network: Network,
    thresholds: Sequence[Threshold],
    declarations: Sequence[Declaration],
    observed: Sequence[str],
    options: Options,
) -> Iterable[Problem]:
    """Warn of evidence that is of little use, and of what it accepts (B424, B425, B427)."""
    if not thresholds:
        return
    for one in thresholds:
        if one.node in observed:
            message = f"evidence {one.id!r}: the node {one.node!r} may be observed itself"
            hint = "while it is, the threshold says what was observed; while not, any state may be"
            yield warning("B424", message, one.place, hint)
    accepted = {one.node for one in declarations if one.data.get("missing") == "prior"}
    yield from _too_many(network, [n for n in observed if n not in accepted], options)
    for declaration in declarations:
        yield from _acceptances(network, thresholds, declaration, observed, options)


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


def _acceptances(
    network: Network,
    thresholds: Sequence[Threshold],
    declaration: Declaration,
    observed: Sequence[str],
    options: Options,
) -> Iterable[Problem]:
    """Say of each key that accepts something which evidence rests on it."""
    node, data = declaration.node, declaration.data
    nodes = reached(network, observed, node, [one.node for one in thresholds])
    names = ", ".join(one.id for one in thresholds if one.node in nodes)
    for (key, value), text in _ACCEPTED.items() if names else ():
        if data.get(key) == value:
            what = text.format(input=declaration.input)
            shown = "true" if value is True else value
            message = f"{key}: {shown} of {node}: evidence {names} rests on {what}"
            yield warning("B427", message, options.place("discretisation", node, key))

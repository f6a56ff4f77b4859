"""Which observed nodes can reach which others; evidence weaker than it seems."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from eddi_runtime.bayesian_network.claims import COMBINATIONS

from eddi_scaffold.common.problems import Problem, problem
from eddi_scaffold.kinds import Options
from eddi_scaffold.kinds.bayesian_network.discretisation import Declaration
from eddi_scaffold.kinds.bayesian_network.network import Network, in_digits
from eddi_scaffold.kinds.bayesian_network.thresholds import KEY, Threshold


def without_influence(
    network: Network, outputs: Sequence[str], observed: Sequence[str], options: Options
) -> Iterable[Problem]:
    """Report observed nodes that no output depends on (B305)."""
    if not options.inputs:
        return
    for name in observed:
        if name not in outputs and not reached(network, observed, name, outputs):
            yield problem("B305.no_influence", options.place("discretisation", name), name=name)


def reached(
    network: Network, observed: Sequence[str], name: str, outputs: Sequence[str]
) -> list[str]:
    """Return the outputs that evidence on a node can reach, whatever else is observed.

    Among the ancestors of what is observed or asked for, every common child is, or leads to, an
    output or an observed node; so each way can be open, in one step or another.
    """
    near = _neighbours(network, network.ancestors([*outputs, *observed]))
    seen, waiting = {name}, [name]
    while waiting:
        for one in near[waiting.pop()] - seen:
            seen.add(one)
            waiting.append(one)
    return [output for output in outputs if output in seen]


def _neighbours(network: Network, known: set[str]) -> dict[str, set[str]]:
    """Return the neighbours of each node among the known ones."""
    found: dict[str, set[str]] = {name: set() for name in known}
    for node in network.nodes:
        for parent in node.parents if node.id in known else ():
            found[node.id].add(parent)
            found[parent].add(node.id)
    return found


def doubts(
    network: Network,
    thresholds: Sequence[Threshold],
    declarations: Sequence[Declaration],
    observed: Sequence[str],
    options: Options,
) -> Iterable[Problem]:
    """Warn of evidence that is of little use (B305, B425)."""
    if not thresholds:
        return
    for threshold in thresholds:
        if threshold.node in observed:
            yield problem(
                "B305.perhaps_observed",
                threshold.place,
                threshold=threshold.id,
                node=threshold.node,
            )
    accepted = {
        declaration.node
        for declaration in declarations
        if declaration.data.get("missing") == "prior"
    }
    yield from _too_many(network, [n for n in observed if n not in accepted], options)


def _too_many(network: Network, inputs: Iterable[str], options: Options) -> Iterable[Problem]:
    cards = {name: len(network.node(name).states) for name in inputs}
    count = math.prod(cards.values())
    if count > COMBINATIONS:
        nodes = [f"{name} {card}" for name, card in cards.items()]
        shown = " x ".join(nodes[:6]) + (" x ..." if len(nodes) > 6 else "")
        yield problem(
            "B425", options.place(KEY), count=in_digits(count), shown=shown, largest=COMBINATIONS
        )

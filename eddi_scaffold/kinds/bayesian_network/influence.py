"""Which observed nodes can reach which others, whatever else is observed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from eddi_scaffold.kinds import Options
from eddi_scaffold.kinds.bayesian_network.model import Network
from eddi_scaffold.problems import Problem, info


def without_influence(
    network: Network, outputs: Sequence[str], observed: Sequence[str], options: Options
) -> Iterable[Problem]:
    """Report observed nodes that no output depends on (B305)."""
    if not options.inputs:
        return
    for name in observed:
        if name not in outputs and not reached(network, observed, name, outputs):
            message = f"the observed node {name!r} cannot influence any output"
            yield info("B305", message, options.place("discretisation", name))


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
    return [one for one in outputs if one in seen]


def _neighbours(network: Network, known: set[str]) -> dict[str, set[str]]:
    """Return the neighbours of each node among the known ones."""
    found: dict[str, set[str]] = {name: set() for name in known}
    for node in network.nodes:
        for parent in node.parents if node.id in known else ():
            found[node.id].add(parent)
            found[parent].add(node.id)
    return found

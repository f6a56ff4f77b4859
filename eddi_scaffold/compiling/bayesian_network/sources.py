"""Which input feeds which node, and how it is read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from eddi_scaffold.compiling.bayesian_network.declaration import read_declaration
from eddi_scaffold.compiling.bayesian_network.model import BayesianNetworkModel
from eddi_scaffold.compiling.document import InputData


class Source(NamedTuple):
    """A declared way from an input to a node; without a declaration it is direct."""

    node: int
    spec: InputData
    declared: Mapping[str, Any] | None


def sources_of(model: BayesianNetworkModel, specs: Sequence[InputData]) -> tuple[Source, ...]:
    """Return the declared ways to the observed nodes, by node.

    A discretisation goes before a direct way. If the model declares which nodes are observed, the
    others are left out.

    Raises:
        ModelError: a discretisation is wrong.
    """
    network, by_id = model.network, {spec.id: spec for spec in specs}
    found = {node: Source(node, by_id[name], None) for node, name in model.direct.items()}
    for node, given in model.discretisation.items():
        declared = read_declaration(given, network.states[node], network.shape.names[node])
        found[node] = Source(node, by_id[given["input"]], declared)
    wanted = found if model.observed is None else model.observed
    return tuple(found[node] for node in sorted(found) if node in wanted)

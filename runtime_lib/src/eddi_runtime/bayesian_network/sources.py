"""Which input feeds which node, and how it is read."""

from __future__ import annotations

from typing import Dict, NamedTuple, Sequence, Tuple

from ..inputs import InputSpec
from .declaration import read_declaration
from .direct import DirectReader
from .model import BayesianNetworkModel
from .readers import Discretiser, Reader


class Source(NamedTuple):
    """A declared way from an input to a node."""

    node: int
    spec: InputSpec
    reader: Reader


def make_sources(model: BayesianNetworkModel, specs: Sequence[InputSpec]) -> Tuple[Source, ...]:
    """Return the declared ways to the observed nodes, by node.

    A discretisation goes before a direct way. If the model declares which nodes are observed, the
    others are left out.

    Raises:
        ModelError: a discretisation is wrong.
    """
    network, by_id = model.network, {spec.id: spec for spec in specs}
    found: Dict[int, Source] = {}
    for node, name in model.direct.items():
        direct = DirectReader(network.states[node], virtual=model.virtual)
        found[node] = Source(node, by_id[name], direct)
    for node, given in model.discretisation.items():
        spec = by_id[given["input"]]
        declaration = read_declaration(given, network.states[node], network.shape.names[node])
        found[node] = Source(node, spec, Discretiser(declaration, spec))
    wanted = found if model.observed is None else model.observed
    return tuple(found[node] for node in sorted(found) if node in wanted)

"""Which input feeds which node, and how it is read."""

from __future__ import annotations

from typing import Dict, NamedTuple, Sequence, Tuple

from ..inputs import InputSpec
from .declaration import read_declaration
from .model import BayesianNetworkModel
from .readers import DirectReader, Discretiser, Reader, Reading


class Source(NamedTuple):
    """A declared way from an input to a node."""

    node: int
    spec: InputSpec
    reader: Reader


def make_sources(model: BayesianNetworkModel, specs: Sequence[InputSpec]) -> Tuple[Source, ...]:
    """Return the declared ways to the observed nodes, by node.

    A discretisation goes before a direct way. If the model says which nodes are observed, the
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


def read_attribute(
    reader: Reader, eddi_input: object, attribute: str, now: int
) -> Tuple[object, Reading]:
    """Return the value of an attribute, and what it says; never raises an Exception."""
    try:
        value = getattr(eddi_input, attribute, None)
        return value, reader.read(value, now)
    except Exception:  # noqa: BLE001 - a hostile object: whatever it raises, it is no evidence
        return None, reader.absent(now)

"""The ``model`` part of ``config/model.json`` of a Bayesian network, typed and checked."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from eddi_scaffold.compiling.bayesian_network.graph import Shape
from eddi_scaffold.compiling.bayesian_network.thresholds import StateThreshold, read_thresholds
from eddi_scaffold.compiling.document import ModelError, ModelFile, take

_LIST, _TEXT, _OBJECT = list, str, dict
_TOLERANCE = 1e-6
_MODES = ("virtual", "d7.2")
_ON_INCONSISTENT = ("silent", "prior", "hold")


@dataclass(frozen=True)
class Network:
    """A network with its numbers.

    Attributes:
        shape: names, numbers of states, parents.
        states: names of the states of each node.
        tables: P(node | parents) of each node: first parent slowest, own state fastest.
        attributes: identifier of each node: its method is ``node_<attribute>``.
    """

    shape: Shape
    states: tuple[tuple[str, ...], ...]
    tables: tuple[tuple[float, ...], ...]
    attributes: tuple[str, ...]


@dataclass(frozen=True)
class BayesianNetworkModel:
    """A network and how it is used.

    Attributes:
        network: the network.
        outputs: nodes whose posterior is always given, ascending.
        observed: nodes that may be observed, ascending; None: not known beforehand.
        discretisation: node -> declaration, as in the file.
        direct: node -> id of the input that holds its state or likelihoods.
        virtual: several non-zero outcomes are likelihoods; False: D7.2's rule.
        on_inconsistent: the result on evidence of probability zero: ``silent``, ``prior`` or
            ``hold``.
        explain: the status message has the relevance of each observed node.
        thresholds: the evidence for ConSerts.
        paths: of the nodes: fragment path of the element in the file, empty for none.
    """

    network: Network
    outputs: tuple[int, ...]
    observed: tuple[int, ...] | None
    discretisation: Mapping[int, Mapping[str, Any]]
    direct: Mapping[int, str]
    virtual: bool
    on_inconsistent: str
    explain: bool
    thresholds: tuple[StateThreshold, ...]
    paths: tuple[str, ...]


def read_model_part(model_file: ModelFile) -> BayesianNetworkModel:
    """Read the model part and the settings.

    Raises:
        ModelError: something is missing, of a wrong type, or contradicts itself.
    """
    model, where = model_file.model, "the model"
    network = read_network(take(model, "nodes", _LIST, where))
    names = {name: node for node, name in enumerate(network.shape.names)}
    inputs = {spec.id for spec in model_file.inputs}
    observed = model.get("observed")
    discretisation = take(model, "discretisation", _OBJECT, where)
    direct = take(model, "direct", _OBJECT, where)
    for name, item in discretisation.items():
        _known_input(take(item, "input", _TEXT, f"the discretisation of {name!r}"), inputs)
    for name in direct:
        _known_input(take(direct, name, _TEXT, "direct"), inputs)
    settings = model_file.settings
    return BayesianNetworkModel(
        network=network,
        outputs=_nodes(take(model, "outputs", _LIST, where), names),
        observed=None if observed is None else _nodes(observed, names),
        discretisation={_node(name, names): item for name, item in discretisation.items()},
        direct={_node(name, names): item for name, item in direct.items()},
        virtual=_choice(settings, "evidence_mode", _MODES) == "virtual",
        on_inconsistent=_choice(settings, "on_inconsistent", _ON_INCONSISTENT),
        explain=settings.get("explain") is True,
        thresholds=read_thresholds(model.get("thresholds", []), list(names), network.states),
        paths=tuple(map(_path, model["nodes"])),
    )


def _path(item: Mapping[str, Any]) -> str:
    found = item.get("path")
    return found if isinstance(found, str) else ""


def read_network(items: Any) -> Network:
    """Read the nodes.

    Raises:
        ModelError: something is missing, of a wrong type, or no network.
    """
    nodes = [_named(item, f"node {number}") for number, item in enumerate(items)]
    names = [name for name, _ in nodes]
    number = {name: k for k, name in enumerate(names)}
    if len(number) < len(names):
        raise ModelError("", "two nodes have the same id")
    states: list[tuple[str, ...]] = []
    parents: list[tuple[int, ...]] = []
    for name, item in nodes:
        where = f"node {name!r}"
        states.append(_texts(take(item, "states", _LIST, where), f"the states of {where}"))
        known = _texts(take(item, "parents", _LIST, where), f"the parents of {where}")
        parents.append(tuple(_node(one, number) for one in known))
        if not states[-1]:
            raise ModelError("", f"{where} has no states")
    shape = Shape(tuple(names), tuple(len(state) for state in states), tuple(parents))
    _acyclic(shape)
    tables = [_table(item, shape, k) for k, (_, item) in enumerate(nodes)]
    attributes = [take(item, "attribute", _TEXT, f"node {name!r}") for name, item in nodes]
    if len(set(attributes)) < len(attributes):
        raise ModelError("", "two nodes have the same attribute")
    return Network(shape, tuple(states), tuple(tables), tuple(attributes))


def _named(item: Any, where: str) -> tuple[str, Any]:
    return take(item, "id", _TEXT, where), item


def _texts(items: Any, where: str) -> tuple[str, ...]:
    if not all(isinstance(item, str) for item in items):
        raise ModelError("", f"{where} are not texts")
    if len(set(items)) < len(items):
        raise ModelError("", f"{where} name one twice")
    return tuple(items)


def _node(name: Any, names: Mapping[str, int]) -> int:
    if not isinstance(name, str) or name not in names:
        raise ModelError("", f"there is no node {name!r}")
    return names[name]


def _nodes(items: Any, names: Mapping[str, int]) -> tuple[int, ...]:
    if not isinstance(items, list):
        raise ModelError("", "a list of nodes is not a list")
    return tuple(sorted({_node(name, names) for name in items}))


def _known_input(name: str, inputs: set[str]) -> None:
    if name not in inputs:
        raise ModelError("", f"there is no input {name!r}")


def _choice(settings: Mapping[str, Any], key: str, known: tuple[str, ...]) -> str:
    value = settings.get(key, known[0])
    if value not in known:
        raise ModelError("", f"{key!r} is {value!r}, not one of {', '.join(known)}")
    return str(value)


def _acyclic(shape: Shape) -> None:
    waiting: dict[int, int] = {node: len(ps) for node, ps in enumerate(shape.parents)}
    children: list[list[int]] = [[] for _ in shape.parents]
    for node, known in enumerate(shape.parents):
        for parent in known:
            children[parent].append(node)
    ready = [node for node, count in waiting.items() if not count]
    done = 0
    while ready:
        done += 1
        for child in children[ready.pop()]:
            waiting[child] -= 1
            if not waiting[child]:
                ready.append(child)
    if done < len(waiting):
        raise ModelError("", "the network has a cycle")


def _table(item: Any, shape: Shape, node: int) -> tuple[float, ...]:
    where, card = f"the table of node {shape.names[node]!r}", shape.cards[node]
    values = take(item, "table", _LIST, where)
    size = card * math.prod(shape.cards[one] for one in shape.parents[node])
    if len(values) != size:
        raise ModelError("", f"{where} has {len(values)} numbers, not {size}")
    # `type`, not `isinstance`: True is no probability. The comparison is False for NaN.
    if not all(type(value) in (int, float) and 0.0 <= value <= 1.0 for value in values):
        raise ModelError("", f"{where} has something else than numbers from 0 to 1")
    for start in range(0, size, card):
        if abs(math.fsum(values[start : start + card]) - 1.0) > _TOLERANCE:
            raise ModelError("", f"a row of {where} does not sum to 1")
    return tuple(float(value) for value in values)

"""What a configuration has to say of a network: how its roots are observed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from eddi_scaffold.kinds import TODO, InputType, JsonValue, ModelInput, Options, Skeleton
from eddi_scaffold.kinds.bayesian_network.proposing import proposed_bins

if TYPE_CHECKING:
    from eddi_scaffold.kinds.bayesian_network.model import Node
    from eddi_scaffold.kinds.bayesian_network.options import NetworkModel

_TRUTHS = ({"true", "false"}, {"yes", "no"})
_TRUE = ("true", "yes")
_SECTION = "discretisation"


def skeleton(model: NetworkModel, options: Options) -> Skeleton:
    """Return a declaration for each root that nothing feeds yet, and the inputs of all."""
    network, given = model.data, options.values.get(_SECTION)
    there = given if isinstance(given, Mapping) else {}
    fed = {one.id for one in options.inputs}
    named = {str(one) for key in ("outputs", "observed") for one in _list(options.values.get(key))}
    roots = [node for node in network.nodes if not node.parents and len(node.states) > 1]
    new = {
        node.id: _declaration(node)
        for node in roots
        if node.id not in {*there, *fed, *named} and given in (None, there)
    }
    notes: dict[tuple[str, ...], str] = {
        (_SECTION, node.id, "bins"): _edges(node)
        for node in roots
        if "bins" in new.get(node.id, {})
    }
    every = [(id_, one) for id_, one in {**there, **new}.items() if isinstance(one, Mapping)]
    inputs = [
        ModelInput(str(one["input"]), _type(one), description=_plain(id_))
        for id_, one in every
        if isinstance(one.get("input"), str) and one["input"] != TODO
    ]
    direct = [
        ModelInput(node.id, "state", description=_plain(node.id), states=tuple(node.states))
        for node in network.nodes
        if node.id in fed and node.id not in {one.id for one in inputs}
    ]
    return Skeleton([*inputs, *direct], {_SECTION: new} if new else {}, notes)


def _declaration(node: Node) -> dict[str, JsonValue]:
    if {state.casefold() for state in node.states} in _TRUTHS:
        is_true = {state.casefold() in _TRUE: state for state in node.states}
        return {"input": node.id, "map": {"true": is_true[True], "false": is_true[False]}}
    return {"input": node.id, "bins": TODO}


def _edges(node: Node) -> str:
    """Return what the bins of a node have to say, with what the names of the states suggest."""
    count = len(node.states) - 1
    text = f"{count} edge{'' if count == 1 else 's'} between {', '.join(node.states)}"
    proposed = proposed_bins(node.states)
    return f"{text}; by their names {proposed}" if proposed else text


def _type(declaration: Mapping[str, JsonValue]) -> InputType:
    given = declaration.get("map")
    if not isinstance(given, Mapping) or "bins" in declaration:
        return "float"
    return "bool" if {str(key).casefold() for key in given} <= {"true", "false"} else "str"


def _plain(name: str) -> str:
    return name.replace("_", " ")


def _list(value: JsonValue) -> list[JsonValue]:
    return list(value) if isinstance(value, list) else []

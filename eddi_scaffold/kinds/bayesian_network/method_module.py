"""``bayesian_network_config.py`` of a package (D7.2 Figs 15, 19, 20), and its draft."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import pairwise

from eddi_scaffold.common.escaping import python_comment, python_literal
from eddi_scaffold.kinds import (
    TODO,
    EditableMethod,
    EditableModule,
    InputType,
    JsonValue,
    ModelDraft,
    ModelInput,
    Options,
)
from eddi_scaffold.kinds.bayesian_network.network import Network, Node, identifiers, node_attributes
from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions

_NUMBER = r"(\d+(?:[._]\d+)?)"
_BETWEEN = re.compile(rf"(?:\D*_)?{_NUMBER}_?(?:to|-|_)_?{_NUMBER}(?:_\D*)?")
_ABOVE = re.compile(rf"(?:more_than|above|over|gt|greater_than|ge|>=?)_?{_NUMBER}(?:_\D*)?")
_BELOW = re.compile(rf"(?:less_than|below|under|lt|le|<=?)_?{_NUMBER}(?:_\D*)?")


def proposed_bins(states: Sequence[str]) -> list[float] | None:
    """Return the edges between states such as ``range_0_to_1_m`` and ``more_than_2_m``.

    ``None`` when the names do not give one ascending series over all states, with at most one
    state in front that names no number.
    """
    spans = [_span(state) for state in states]
    if spans and spans[0] is None and len(states) > 2:
        spans = [(None, spans[1][0] if spans[1] else None), *spans[1:]]
    if not spans or any(span is None for span in spans):
        return None
    known = [span for span in spans if span is not None]
    edges = []
    for (_, high), (low, _) in pairwise(known):
        edge = high if high is not None else low
        if edge is None or (low is not None and low != edge):
            return None
        edges.append(edge)
    rising = all(a < b for a, b in pairwise(edges))
    return edges if edges and rising else None


def _span(state: str) -> tuple[float | None, float | None] | None:
    """Return the numbers between which a state lies, by its name."""
    name = state.casefold()
    between = _BETWEEN.fullmatch(name)
    if between:
        return _value(between[1]), _value(between[2])
    above = _ABOVE.fullmatch(name)
    if above:
        return _value(above[1]), None
    below = _BELOW.fullmatch(name)
    return (None, _value(below[1])) if below else None


def _value(text: str) -> float:
    return float(text.replace("_", "."))


FILE = "bayesian_network_config.py"
_PLAIN = (
    "",
    "    def __init__(self) -> None:",
    "        self.dra_data = None",
    "",
    "    def update_dra_data(self, dra_data) -> None:",
    '        """Take over what `execute_step` was given; the methods below read it."""',
    '        self.dra_data = getattr(dra_data, "data", dra_data)',
)


def config_module(network: Network, settings: NetworkOptions) -> EditableModule:
    """Return the module with a region for each node."""
    attributes = node_attributes(network)
    return EditableModule(
        file=FILE,
        docstring="How inputs become evidence on nodes, and which nodes are outputs.",
        class_name="BayesianNetworkConfig",
        class_docstring="What the configuration does not declare is written here, node by node.",
        methods=tuple(_method(node, attributes[node.id], settings) for node in network.nodes),
        imports=("from typing import Dict, Tuple",),
        plain_methods=_PLAIN,
    )


def _method(node: Node, attribute: str, settings: NetworkOptions) -> EditableMethod:
    outcomes = [f"outcome_{name}" for name in identifiers(node.states)]
    pairs = [
        f"    {python_literal(state)}: {name},"
        for state, name in zip(node.states, outcomes, strict=True)
    ]
    former = settings.renamed.get(node.id)
    was = tuple(f"node_{name}" for name in identifiers([former] if former else []))
    return EditableMethod(
        name=f"node_{attribute}",
        about=node.id,
        body=("pass",),
        returns="Tuple[bool, Dict[str, float]]",
        comments=tuple(_comments(node, settings)),
        before=("is_bn_output = False", *(f"{name} = 0.0" for name in outcomes)),
        was=was,
        uses=(*outcomes, "dra_data"),
        after=("return is_bn_output, {", *pairs, "}"),
        is_needed=node.id in settings.by_hand,
    )


def _comments(node: Node, settings: NetworkOptions) -> list[str]:
    lines = [f"States of {python_comment(node.id)}: {python_comment(', '.join(node.states))}."]
    if node.id in settings.outputs:
        lines.append("Declared as an output.")
    declared = next(
        (declaration for declaration in settings.declarations if declaration.node == node.id), None
    )
    if declared is not None:
        lines.append(
            f"Declared: discretised from {python_comment(declared.input)}, unless set here."
        )
    elif node.id in settings.direct:
        lines.append(
            f"Declared: taken from {python_comment(settings.direct[node.id])}, unless set here."
        )
    if declared is None:
        edges = proposed_bins(node.states)
        if edges is not None:
            shown = ", ".join(f"{edge:g}" for edge in edges)
            lines.append(
                f"Its states look like bins: [{shown}] (discretisation: in the configuration)"
            )
    return lines


_TRUTHS = ({"true", "false"}, {"yes", "no"})
_TRUE = ("true", "yes")
_SECTION = "discretisation"


def draft(network: Network, options: Options) -> ModelDraft:
    """Return a declaration for each node that nothing feeds yet, and the inputs of all.

    Of the nodes that are expected to be known; where the file expects none, of the roots.
    """
    given = options.values.get(_SECTION)
    there = given if isinstance(given, Mapping) else {}
    fed = {input_.id for input_ in options.inputs}
    named = {str(one) for key in ("outputs", "observed") for one in _list(options.values.get(key))}
    known = [node for node, _ in network.known]
    proposed = known or [node.id for node in network.nodes if not node.parents]
    roots = [node for node in network.nodes if node.id in proposed and len(node.states) > 1]
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
        if node.id in fed and node.id not in {input_.id for input_ in inputs}
    ]
    return ModelDraft([*inputs, *direct], {_SECTION: new} if new else {}, notes)


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

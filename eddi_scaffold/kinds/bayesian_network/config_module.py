"""``bayesian_network_config.py`` of a package: a method per node (SESAME D7.2 Figs 15, 19, 20)."""

from __future__ import annotations

from eddi_scaffold.escaping import python_comment, python_literal
from eddi_scaffold.kinds import EditableMethod, EditableModule
from eddi_scaffold.kinds.bayesian_network.model import Node
from eddi_scaffold.kinds.bayesian_network.names import identifiers, node_attributes
from eddi_scaffold.kinds.bayesian_network.options import NetworkModel, NetworkOptions, settings_of
from eddi_scaffold.kinds.bayesian_network.proposing import proposed_bins

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


def config_module(model: NetworkModel) -> EditableModule:
    """Return the module with a region for each node."""
    network = model.data
    settings = settings_of(model)
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
    declared = next((one for one in settings.declarations if one.node == node.id), None)
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

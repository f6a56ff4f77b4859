"""``bayesian_network_config.py`` of a package (D7.2 Figs 15, 19, 20), and its draft."""

from __future__ import annotations

from collections.abc import Mapping

from eddi_scaffold import kinds
from eddi_scaffold.common.escaping import python_comment, python_literal
from eddi_scaffold.common.identifiers import TODO
from eddi_scaffold.common.problems import plural
from eddi_scaffold.kinds.bayesian_network.network import Network, Node, identifiers, node_attributes
from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions

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


def config_module(network: Network, options: NetworkOptions) -> kinds.EditableModule:
    """Return the module with a region for each node."""
    attributes = node_attributes(network)
    return kinds.EditableModule(
        file=FILE,
        docstring="How inputs become evidence on nodes, and which nodes are outputs.",
        class_name="BayesianNetworkConfig",
        class_docstring="What the configuration does not declare is written here, node by node.",
        methods=tuple(_method(node, attributes[node.id], options) for node in network.nodes),
        imports=("from typing import Dict, Tuple",),
        plain_methods=_PLAIN,
    )


def _method(node: Node, attribute: str, options: NetworkOptions) -> kinds.EditableMethod:
    outcomes = [f"outcome_{name}" for name in identifiers(node.states)]
    pairs = zip(map(python_literal, node.states), outcomes, strict=True)
    comments = [f"States of {python_comment(node.id)}: {python_comment(', '.join(node.states))}."]
    if node.id in options.outputs:
        comments.append("Declared as an output.")
    if (input_id := options.input_of(node.id)) is not None:
        is_discretised = node.id in [entry.node for entry in options.declarations]
        how = "discretised" if is_discretised else "taken"
        comments.append(f"Declared: {how} from {python_comment(input_id)}, unless set here.")
    former = options.renamed.get(node.id)
    return kinds.EditableMethod(
        name=f"node_{attribute}",
        about=node.id,
        body=("pass",),
        returns="Tuple[bool, Dict[str, float]]",
        comments=tuple(comments),
        before=("is_bn_output = False", *(f"{name} = 0.0" for name in outcomes)),
        was=tuple(f"node_{name}" for name in identifiers([former] if former else [])),
        uses=(*outcomes, "dra_data"),
        after=("return is_bn_output, {", *(f"    {state}: {name}," for state, name in pairs), "}"),
        is_needed=node.id in options.by_hand,
    )


def draft(network: Network, options: kinds.Options) -> kinds.ModelDraft:
    """Return a declaration for each node that nothing feeds yet, and the inputs of all.

    Of the nodes that are expected to be known; where the file expects none, of the roots.
    """
    section, fed = options.values.get("discretisation"), {entry.id for entry in options.inputs}
    declared: dict[str, kinds.JsonValue] = dict(section) if isinstance(section, Mapping) else {}
    lists = [options.values.get(key) for key in ("outputs", "observed")]
    named = {str(name) for list_ in lists if isinstance(list_, list) for name in list_}
    roots = [node.id for node in network.nodes if not node.parents]
    expected = [node for node, _ in network.known] or roots
    new: dict[str, kinds.JsonValue] = {}
    notes: dict[tuple[str, ...], str] = {}
    for node in network.nodes:
        is_proposed = node.id in expected and len(node.states) > 1
        if (
            not is_proposed
            or node.id in {*declared, *fed, *named}
            or section not in (None, declared)
        ):
            continue
        yes_no = {state.casefold(): state for state in node.states}
        if yes_no.keys() in ({"true", "false"}, {"yes", "no"}):
            true, false = ("true", "false") if "true" in yes_no else ("yes", "no")
            map_ = {"true": yes_no[true], "false": yes_no[false]}
            new[node.id] = {"input": node.id, "map": map_}
            continue
        new[node.id] = {"input": node.id, "bins": TODO}
        edges = plural(len(node.states) - 1, "edge")
        notes["discretisation", node.id, "bins"] = f"{edges} between {', '.join(node.states)}"
    inputs = []
    for name, entry in {**declared, **new}.items():
        input_id = entry.get("input") if isinstance(entry, Mapping) else None
        if isinstance(entry, Mapping) and isinstance(input_id, str) and input_id != TODO:
            states = entry.get("map")
            type_: kinds.InputType = "float"
            if isinstance(states, Mapping) and "bins" not in entry:
                keys = {str(key).casefold() for key in states}
                type_ = "bool" if keys <= {"true", "false"} else "str"
            inputs.append(kinds.ModelInput(input_id, type_, description=name.replace("_", " ")))
    inputs += [
        kinds.ModelInput(
            node.id, "state", description=node.id.replace("_", " "), states=node.states
        )
        for node in network.nodes
        if node.id in fed.difference(input_.id for input_ in inputs)
    ]
    return kinds.ModelDraft(inputs, {"discretisation": new} if new else {}, notes)

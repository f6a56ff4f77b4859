"""A network as XDSL that GeNIe opens, and as XMLBIF 0.3: the same bytes on every machine."""

from __future__ import annotations

from collections.abc import Iterator

from eddi_scaffold.common.escaping import xml_text
from eddi_scaffold.common.graphs import in_order
from eddi_scaffold.common.problems import EddiError, problem
from eddi_scaffold.kinds.bayesian_network.network import TARGET, TITLE, Network, Node, xdsl_ids


def to_xdsl(network: Network) -> str:
    """Return the text of an XDSL file: parents first, with the ids that the format can hold."""
    return "".join(f"{line}\n" for line in _xdsl_lines(network))


def to_xmlbif(network: Network) -> str:
    """Return the text of an XMLBIF file that reads back as the same network.

    Raises:
        EddiError: a name has blanks that the format does not keep (G004).
    """
    names = [(network.name, network.place)]
    for node in network.nodes:
        names += [(name, node.place) for name in dict.fromkeys([node.id, node.title, *node.states])]
    problems = [
        problem("G004.unsaid", place, subject=f"the blanks of {name!r}", format="XMLBIF")
        for name, place in names
        if " ".join(name.split()) != name
    ]
    if problems:
        raise EddiError(*problems)
    return "".join(f"{line}\n" for line in _xmlbif_lines(network))


def _numbers(node: Node) -> str:
    """Return the numbers of a table so that reading them back gives the same bits."""
    return " ".join(str(int(p)) if p == int(p) else repr(p) for p in node.table)


def _xdsl_lines(network: Network) -> Iterator[str]:
    ids = xdsl_ids(network.names())
    order = [*map(network.node, in_order({node.id: node.parents for node in network.nodes}))]
    (name,) = xdsl_ids([network.name]).values()
    yield '<?xml version="1.0" encoding="UTF-8"?>'
    yield f'<smile version="1.0" id="{xml_text(name)}" numsamples="10000" discsamples="10000">'
    yield "\t<nodes>"
    for node in order:
        target = ' target="true"' if node.target else ""
        yield f'\t\t<cpt id="{ids[node.id]}"{target}>'
        ids_of_states = xdsl_ids(node.states)
        for state in node.states:
            yield f'\t\t\t<state id="{ids_of_states[state]}" />'
        if node.parents:
            yield f"\t\t\t<parents>{' '.join(ids[parent] for parent in node.parents)}</parents>"
        yield f"\t\t\t<probabilities>{_numbers(node)}</probabilities>"
        yield "\t\t</cpt>"
    yield "\t</nodes>"
    yield "\t<extensions>"
    yield f'\t\t<genie version="1.0" app="eddi-scaffold" name="{xml_text(network.name)}">'
    depth: dict[str, int] = {}
    columns: dict[int, int] = {}
    for node in order:  # a row of the picture for each step away from the roots
        row = depth[node.id] = 1 + max((depth[parent] for parent in node.parents), default=-1)
        column = columns[row] = columns.get(row, -1) + 1
        x, y = 40 + 180 * column, 40 + 120 * row
        yield f'\t\t\t<node id="{ids[node.id]}">'
        yield f"\t\t\t\t<name>{xml_text(node.title)}</name>"
        yield '\t\t\t\t<interior color="e5f6f7" />'
        yield '\t\t\t\t<outline color="000080" />'
        yield '\t\t\t\t<font color="000000" name="Arial" size="8" />'
        yield f"\t\t\t\t<position>{x} {y} {x + 120} {y + 60}</position>"
        yield "\t\t\t</node>"
    yield from ("\t\t</genie>", "\t</extensions>", "</smile>")


def _xmlbif_lines(network: Network) -> Iterator[str]:
    yield '<?xml version="1.0" encoding="UTF-8"?>'
    yield '<BIF VERSION="0.3">'
    yield "<NETWORK>"
    yield f"<NAME>{xml_text(network.name)}</NAME>"
    for node in network.nodes:
        yield '<VARIABLE TYPE="nature">'
        yield f"\t<NAME>{xml_text(node.id)}</NAME>"
        for state in node.states:
            yield f"\t<OUTCOME>{xml_text(state)}</OUTCOME>"
        if node.title != node.id:
            yield f"\t<PROPERTY>{TITLE}{xml_text(node.title)}</PROPERTY>"
        if node.target:
            yield f"\t<PROPERTY>{TARGET}</PROPERTY>"
        yield "</VARIABLE>"
    for node in network.nodes:
        yield "<DEFINITION>"
        yield f"\t<FOR>{xml_text(node.id)}</FOR>"
        for parent in node.parents:
            yield f"\t<GIVEN>{xml_text(parent)}</GIVEN>"
        yield f"\t<TABLE>{_numbers(node)}</TABLE>"
        yield "</DEFINITION>"
    yield from ("</NETWORK>", "</BIF>")

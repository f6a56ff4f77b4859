"""A network as XDSL that GeNIe opens, and as XMLBIF 0.3."""

from __future__ import annotations

from collections.abc import Iterator

from eddi_scaffold.common.escaping import xml_text
from eddi_scaffold.kinds.bayesian_network.network import Network, Node, xdsl_ids


def to_xdsl(network: Network) -> str:
    """Return the text; the same bytes on every machine."""
    return "".join(f"{line}\n" for line in _xdsl_lines(network))


def changed_ids(network: Network) -> list[tuple[str, str]]:
    """Return the names of nodes and states that XDSL cannot hold, with what they become."""
    pairs = list(xdsl_ids(network.names()).items())
    for node in network.nodes:
        pairs += xdsl_ids(node.states).items()
    return list(dict.fromkeys((old, new) for old, new in pairs if old != new))


def number(value: float) -> str:
    """Return a number so that reading it back gives the same bits."""
    return str(int(value)) if value == int(value) else repr(value)


def _xdsl_lines(network: Network) -> Iterator[str]:
    ids = xdsl_ids(network.names())
    order = network.in_order()
    name = xml_text(next(iter(xdsl_ids([network.name]).values())))
    yield '<?xml version="1.0" encoding="UTF-8"?>'
    yield f'<smile version="1.0" id="{name}" numsamples="10000" discsamples="10000">'
    yield "\t<nodes>"
    for node in order:
        yield from _node(node, ids)
    yield "\t</nodes>"
    yield "\t<extensions>"
    yield f'\t\t<genie version="1.0" app="eddi-scaffold" name="{xml_text(network.name)}">'
    for node, (left, top) in zip(order, _places(order), strict=True):
        yield f'\t\t\t<node id="{ids[node.id]}">'
        yield f"\t\t\t\t<name>{xml_text(node.title)}</name>"
        yield '\t\t\t\t<interior color="e5f6f7" />'
        yield '\t\t\t\t<outline color="000080" />'
        yield '\t\t\t\t<font color="000000" name="Arial" size="8" />'
        yield f"\t\t\t\t<position>{left} {top} {left + 120} {top + 60}</position>"
        yield "\t\t\t</node>"
    yield "\t\t</genie>"
    yield "\t</extensions>"
    yield "</smile>"


def _node(node: Node, ids: dict[str, str]) -> Iterator[str]:
    target = ' target="true"' if node.target else ""
    yield f'\t\t<cpt id="{ids[node.id]}"{target}>'
    states = xdsl_ids(node.states)
    for state in node.states:
        yield f'\t\t\t<state id="{states[state]}" />'
    if node.parents:
        yield f"\t\t\t<parents>{' '.join(ids[parent] for parent in node.parents)}</parents>"
    yield f"\t\t\t<probabilities>{' '.join(number(p) for p in node.table)}</probabilities>"
    yield "\t\t</cpt>"


def _places(order: list[Node]) -> list[tuple[int, int]]:
    """Return a place for each node: a row for each step away from the roots."""
    depth: dict[str, int] = {}
    count: dict[int, int] = {}
    found = []
    for node in order:
        row = 1 + max((depth[parent] for parent in node.parents), default=-1)
        depth[node.id] = row
        column = count.get(row, 0)
        count[row] = column + 1
        found.append((40 + 180 * column, 40 + 120 * row))
    return found


def to_xmlbif(network: Network) -> str:
    """Return the text; the same bytes on every machine."""
    return "".join(f"{line}\n" for line in _xmlbif_lines(network))


def _xmlbif_lines(network: Network) -> Iterator[str]:
    order = network.in_order()
    yield '<?xml version="1.0" encoding="UTF-8"?>'
    yield '<BIF VERSION="0.3">'
    yield "<NETWORK>"
    yield f"<NAME>{xml_text(network.name)}</NAME>"
    for node in order:
        yield '<VARIABLE TYPE="nature">'
        yield f"\t<NAME>{xml_text(node.id)}</NAME>"
        for state in node.states:
            yield f"\t<OUTCOME>{xml_text(state)}</OUTCOME>"
        yield "</VARIABLE>"
    for node in order:
        yield "<DEFINITION>"
        yield f"\t<FOR>{xml_text(node.id)}</FOR>"
        for parent in node.parents:
            yield f"\t<GIVEN>{xml_text(parent)}</GIVEN>"
        yield f"\t<TABLE>{' '.join(number(p) for p in node.table)}</TABLE>"
        yield "</DEFINITION>"
    yield "</NETWORK>"
    yield "</BIF>"

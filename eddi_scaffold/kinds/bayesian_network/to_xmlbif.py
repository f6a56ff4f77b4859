"""A network as XMLBIF 0.3: names escaped, never changed."""

from __future__ import annotations

from collections.abc import Iterator

from eddi_scaffold.escaping import xml_text
from eddi_scaffold.kinds.bayesian_network.model import Network
from eddi_scaffold.kinds.bayesian_network.to_xdsl import number


def to_xmlbif(network: Network) -> str:
    """Return the text; the same bytes on every machine."""
    return "".join(f"{line}\n" for line in _lines(network))


def _lines(network: Network) -> Iterator[str]:
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

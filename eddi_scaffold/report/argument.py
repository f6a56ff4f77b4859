"""The argument that a guarantee is withdrawn in time, as GSN and as SACM."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Literal, NamedTuple

from eddi_scaffold.common.escaping import one_line, xml_text
from eddi_scaffold.yaml_text.writer import dump_plain


class Node(NamedTuple):
    """A node of the Goal Structuring Notation."""

    id: str
    type: Literal["goal", "strategy", "solution", "context"]
    text: str
    supported_by: Sequence[str] = ()
    in_context_of: Sequence[str] = ()
    undeveloped: bool = False  # a goal that nothing supports
    url: str = ""


def gsn(nodes: Sequence[Node]) -> str:
    """Return the argument as YAML, in the form that gsn2x draws."""
    document: dict[str, dict[str, object]] = {}
    for node in nodes:
        more = {
            "supportedBy": [*node.supported_by],
            "inContextOf": [*node.in_context_of],
            "undeveloped": node.undeveloped,
            "url": node.url,
        }
        kept = {name: value for name, value in more.items() if value}
        document[node.id] = {"text": one_line(node.text), **kept}
    return dump_plain(document)


_ARGUMENT = "//@assuranceCasePackages.0/@argumentPackages.0/@argumentationElement"
_SACM = """\
<?xml version="1.0" encoding="UTF-8"?>
<integration_:DDIPackage xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xmlns:integration_="http://www.deis-project.eu/ode/mergedODE/integration"
    xmlns:argumentation_="http://www.deis-project.eu/ode/mergedODE/sacm/argumentation"
    name="{name}">
  <assuranceCasePackages gid="eddi-case">
    <argumentPackages gid="eddi-argument">
{elements}
    </argumentPackages>
  </assuranceCasePackages>
</integration_:DDIPackage>
"""
_TYPES = {"goal": "Claim", "strategy": "ArgumentReasoning", "solution": "ArtifactReference"}


def sacm(project: str, nodes: Sequence[Node]) -> str:
    """Return the argument as a part of an EDDI: names of SACM 2.3, name space of the ODE."""
    number = {node.id: k for k, node in enumerate(nodes)}

    def element(type_: str, gid: str, attributes: str, text: str = "") -> str:
        head = (
            f'      <argumentationElement xsi:type="argumentation_:{type_}" gid="{gid}"{attributes}'
        )
        name = f'<name lang="en" content="{xml_text(text)}"/>'
        return f"{head}>{name}</argumentationElement>" if text else f"{head}/>"

    def elements() -> Iterator[str]:
        for node in nodes:
            open_ = ' assertionDeclaration="needsSupport"' if node.undeveloped else ""
            yield element(_TYPES.get(node.type, "ArtifactReference"), node.id, open_, node.text)
        for node in nodes:
            for id_ in (*node.supported_by, *node.in_context_of):
                kind = "AssertedContext" if id_ in node.in_context_of else "AssertedInference"
                kind = "AssertedEvidence" if nodes[number[id_]].type == "solution" else kind
                ends = f' source="{_ARGUMENT}.{number[id_]}" target="{_ARGUMENT}.{number[node.id]}"'
                yield element(kind, f"{node.id}_{id_}", ends)

    return _SACM.format(name=xml_text(project), elements="\n".join(elements()))

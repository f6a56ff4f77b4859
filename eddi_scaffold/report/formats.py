"""A report as other tools import it.

Hazards, guarantees and the like as items: needs.json of sphinx-needs 9, ReqIF 1.2. The argument
that a guarantee is withdrawn in time: GSN, SACM. Tests: JUnit XML.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from typing import Literal, NamedTuple
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from eddi_scaffold import __version__
from eddi_scaffold.common.escaping import one_line, python_literal
from eddi_scaffold.yaml_text.writer import dump_plain

Key = tuple[str, str, str]
"""Kind, monitor (empty for what belongs to none), id in the model."""

KINDS = (
    *("hazard", "requirement", "measure", "guarantee", "gate", "evidence", "topic", "region"),
    "testcase",
)


@dataclass(frozen=True)
class Item:
    """One element of the models, or what was shown about it."""

    key: Key
    text: str  # what a person wrote about it
    state: str  # a state of a hazard, or a verdict
    # relation -> what it is related to (``mitigates``, ``rests on``)
    links: Mapping[str, Sequence[Key]] = field(default_factory=dict)
    place: str = ""  # file and line, or the path in the EDDI
    sha256: str = ""  # of the file in which it stands


def export_ids(keys: Iterable[Key]) -> dict[Key, str]:
    """Return the id of each item in other tools: of its key alone, so it never changes.

    It matches ``[A-Z0-9_]{5,}``. Where two keys would have the same, each has six digits of its
    own behind.
    """
    ids: dict[Key, str] = {}
    for key in keys:
        parts = (re.sub(r"[^A-Z0-9]+", "_", part.upper()).strip("_") for part in key if part)
        ids[key] = "_".join(part or "X" for part in parts)
    counts = Counter(ids.values())
    for key, id_ in ids.items():
        if counts[id_] > 1:
            digest = hashlib.sha256("\0".join(key).encode()).hexdigest()
            ids[key] = f"{id_}_{digest[:6].upper()}"
    return ids


_FIELDS = ("place", "sha256")
_MARKUP = re.compile(r"[^\w\s]|_")  # with a backslash before it, Sphinx shows it as it is
# What Sphinx must be told before it imports the file.
_CONF = """\
project = {project}
extensions = ["sphinx_needs"]
needs_types = [
    {{"directive": kind, "title": kind, "prefix": "", "color": "#BFD8D2", "style": "node"}}
    for kind in {kinds}
]
needs_fields = {{
    name: {{"schema": {{"type": "string"}}, "nullable": True}} for name in {fields}
}}
"""


def needs_json(project: str, items: Sequence[Item], created: datetime) -> str:
    """Return the items for sphinx-needs."""
    ids = export_ids(item.key for item in items)
    needs = {
        ids[item.key]: {
            "id": ids[item.key],
            "type": item.key[0],
            "title": item.key[2],
            "content": _MARKUP.sub(r"\\\g<0>", one_line(item.text)),
            "status": item.state,
            "tags": ["eddi"],
            "links": [ids[key] for keys in item.links.values() for key in keys],
            **{name: getattr(item, name) for name in _FIELDS if getattr(item, name)},
        }
        for item in items
    }
    at = created.isoformat()
    creator = {"program": "eddi-scaffold", "version": __version__}
    version = {"created": at, "creator": creator, "needs": needs, "needs_amount": len(needs)}
    document = {
        "created": at,
        "current_version": "1.0",
        "project": project,
        "versions": {"1.0": version},
    }
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


def needs_conf(project: str) -> str:
    """Return the ``conf.py`` with which Sphinx imports the items without a warning."""
    values = {"project": project, "kinds": KINDS, "fields": _FIELDS}
    return _CONF.format(**{name: python_literal(value) for name, value in values.items()})


_SPACE = "http://www.omg.org/spec/ReqIF/20110401/reqif.xsd"  # also that of ReqIF 1.2
_ATTRIBUTES = {"ReqIF.Name": "name", "ReqIF.Text": "text", "State": "state", "Place": "place"}


def reqif(project: str, items: Sequence[Item], created: datetime) -> str:
    """Return the items as one specification, with a relation for each link."""
    ids = export_ids(item.key for item in items)
    at = created.strftime("%Y-%m-%dT%H:%M:%SZ")

    def add(parent: Element, tag: str, id_: str, name: str = "", **more: str) -> Element:
        more |= {"LONG-NAME": name} if name else {}
        return SubElement(parent, tag, {"IDENTIFIER": id_, "LAST-CHANGE": at, **more})

    def refer(parent: Element, tag: str, target: str, id_: str) -> None:
        SubElement(SubElement(parent, tag), f"{target}-REF").text = id_

    root = Element("REQ-IF", {"xmlns": _SPACE})
    header = SubElement(SubElement(root, "THE-HEADER"), "REQ-IF-HEADER", {"IDENTIFIER": "HEADER"})
    for tag, text in (
        ("CREATION-TIME", at),
        ("REQ-IF-TOOL-ID", "eddi-scaffold"),
        ("REQ-IF-VERSION", "1.0"),
        ("SOURCE-TOOL-ID", "eddi-scaffold"),
        ("TITLE", project),
    ):
        SubElement(header, tag).text = one_line(text)
    content = SubElement(SubElement(root, "CORE-CONTENT"), "REQ-IF-CONTENT")
    types = SubElement(content, "DATATYPES")
    add(types, "DATATYPE-DEFINITION-STRING", "DT_TEXT", "Text", **{"MAX-LENGTH": "32000"})
    types = SubElement(content, "SPEC-TYPES")
    for kind in KINDS:
        type_ = add(types, "SPEC-OBJECT-TYPE", f"TY_{kind.upper()}", kind)
        attributes = SubElement(type_, "SPEC-ATTRIBUTES")
        for title, name in _ATTRIBUTES.items():
            id_ = f"AD_{kind}_{name}".upper()
            attribute = add(attributes, "ATTRIBUTE-DEFINITION-STRING", id_, title)
            refer(attribute, "TYPE", "DATATYPE-DEFINITION-STRING", "DT_TEXT")
    for relation in sorted({relation for item in items for relation in item.links}):
        add(types, "SPEC-RELATION-TYPE", _relation(relation), relation)
    add(types, "SPECIFICATION-TYPE", "TY_SPECIFICATION", "specification")
    objects = SubElement(content, "SPEC-OBJECTS")
    relations = SubElement(content, "SPEC-RELATIONS")
    specification = add(SubElement(content, "SPECIFICATIONS"), "SPECIFICATION", "SP_1", project)
    refer(specification, "TYPE", "SPECIFICATION-TYPE", "TY_SPECIFICATION")
    children = SubElement(specification, "CHILDREN")
    for item in items:
        id_, kind = ids[item.key], item.key[0]
        object_ = add(objects, "SPEC-OBJECT", id_, item.key[2])
        refer(object_, "TYPE", "SPEC-OBJECT-TYPE", f"TY_{kind.upper()}")
        values = SubElement(object_, "VALUES")
        texts = (item.key[2], item.text, item.state, item.place)
        for name, text in zip(_ATTRIBUTES.values(), texts, strict=True):
            value = SubElement(values, "ATTRIBUTE-VALUE-STRING", {"THE-VALUE": one_line(text)})
            definition = f"AD_{kind}_{name}".upper()
            refer(value, "DEFINITION", "ATTRIBUTE-DEFINITION-STRING", definition)
        child = add(children, "SPEC-HIERARCHY", f"SH_{id_}")
        refer(child, "OBJECT", "SPEC-OBJECT", id_)
        for name, keys in item.links.items():
            for key in keys:
                number = f"{_relation(name)}_{id_}_{ids[key]}"
                link = add(relations, "SPEC-RELATION", number)
                refer(link, "TYPE", "SPEC-RELATION-TYPE", _relation(name))
                refer(link, "SOURCE", "SPEC-OBJECT", id_)
                refer(link, "TARGET", "SPEC-OBJECT", ids[key])
    return _xml(root)


def _relation(name: str) -> str:
    return f"RT_{name.upper().replace(' ', '_')}"


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
_ODE = "http://www.deis-project.eu/ode/mergedODE"
_SPACES = {
    "xmlns:xmi": "http://www.omg.org/XMI",
    "xmlns:xsi": "http://www.w3.org/2001/XMLSchema-instance",
    "xmlns:integration_": f"{_ODE}/integration",
    "xmlns:argumentation_": f"{_ODE}/sacm/argumentation",
}
_TYPES = {"goal": "Claim", "strategy": "ArgumentReasoning"}


def sacm(project: str, nodes: Sequence[Node]) -> str:
    """Return the argument as a part of an EDDI: names of SACM 2.3, name space of the ODE."""
    number = {node.id: k for k, node in enumerate(nodes)}
    about = {"xmi:version": "2.0", **_SPACES, "name": one_line(project)}
    root = Element("integration_:DDIPackage", about)
    package = SubElement(root, "assuranceCasePackages", {"gid": "eddi-case"})
    package = SubElement(package, "argumentPackages", {"gid": "eddi-argument"})

    def add(type_: str, gid: str, **more: str) -> Element:
        about = {"xsi:type": f"argumentation_:{type_}", "gid": gid, **more}
        return SubElement(package, "argumentationElement", about)

    for node in nodes:
        open_ = {"assertionDeclaration": "needsSupport"} if node.undeveloped else {}
        element = add(_TYPES.get(node.type, "ArtifactReference"), node.id, **open_)
        SubElement(element, "name", {"lang": "en", "content": one_line(node.text)})
    for node in nodes:
        for id_ in (*node.supported_by, *node.in_context_of):
            kind = "AssertedContext" if id_ in node.in_context_of else "AssertedInference"
            kind = "AssertedEvidence" if nodes[number[id_]].type == "solution" else kind
            source, target = (f"{_ARGUMENT}.{number[of]}" for of in (id_, node.id))
            add(kind, f"{node.id}_{id_}", source=source, target=target)
    return _xml(root)


class Case(NamedTuple):
    """A test, or what no test covers."""

    of: str  # monitor and guarantee
    name: str
    failure: str = ""
    not_covered: str = ""  # why there is no test


def junit(suites: Mapping[str, tuple[Mapping[str, str], Sequence[Case]]]) -> str:
    """Return a suite for each monitor, of its properties (digests) and cases."""
    root = Element("testsuites")
    for name, (properties, cases) in suites.items():
        numbers = {
            "tests": str(len(cases)),
            "failures": str(sum(bool(case.failure) for case in cases)),
            "errors": "0",
            "skipped": str(sum(bool(case.not_covered) for case in cases)),
        }
        suite = SubElement(root, "testsuite", {"name": name, **numbers})
        about = SubElement(suite, "properties")
        for key, value in properties.items():
            SubElement(about, "property", {"name": key, "value": value})
        for case in cases:
            element = SubElement(
                suite, "testcase", {"classname": one_line(case.of), "name": one_line(case.name)}
            )
            for tag, message in (("failure", case.failure), ("skipped", case.not_covered)):
                if message:
                    SubElement(element, tag, {"message": one_line(message)})
    return _xml(root)


def _xml(root: Element) -> str:
    indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{tostring(root, encoding="unicode")}\n'

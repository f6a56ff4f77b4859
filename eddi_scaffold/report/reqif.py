"""Items as ReqIF 1.2, which tools for requirements import."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from eddi_scaffold.common.escaping import one_line
from eddi_scaffold.report.items import KINDS, Item, export_ids

_SPACE = "http://www.omg.org/spec/ReqIF/20110401/reqif.xsd"  # also that of ReqIF 1.2
_ATTRIBUTES = {"ReqIF.Name": "name", "ReqIF.Text": "text", "State": "state", "Place": "place"}


def reqif(project: str, items: Sequence[Item], created: datetime) -> str:
    """Return the items as one specification, with a relation for each link."""
    ids = export_ids(item.key for item in items)
    at = created.strftime("%Y-%m-%dT%H:%M:%SZ")

    def add(parent: Element, tag: str, id_: str, name: str = "", **more: str) -> Element:
        about = {"IDENTIFIER": id_, "LAST-CHANGE": at, "LONG-NAME": name} if id_ else {}
        about = {key: value for key, value in about.items() if value}
        return SubElement(
            parent, tag, {**about, **{k.replace("_", "-"): v for k, v in more.items()}}
        )

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
    indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{tostring(root, encoding="unicode")}\n'


def _relation(name: str) -> str:
    return f"RT_{name.upper().replace(' ', '_')}"

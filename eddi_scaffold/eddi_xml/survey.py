"""What is in an EDDI, for ``show`` and for reports, and what of it no monitor is made of.

A survey visits every element: models that nothing reads would otherwise be lost silently.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import PurePath
from typing import Any

from eddi_scaffold.common.problems import Problem, problem
from eddi_scaffold.eddi_xml import vocabulary as names
from eddi_scaffold.eddi_xml.document import CLASSES, KNOWN_CLASSES, MONITORED, EddiDocument
from eddi_scaffold.eddi_xml.extensions import EVENTS, SAFEML, extension_maps
from eddi_scaffold.eddi_xml.parsing import MAX_REFERENCES, Element, feature_of
from eddi_scaffold.eddi_xml.references import parse_fragment
from eddi_scaffold.eddi_xml.vocabulary import METAMODEL, fold, local_name

_READ, _LEFT_OUT = frozenset(CLASSES["read"]), frozenset(CLASSES["left_out"])
_MAPS = "keyvaluemaps"
_OF_MACHINES = frozenset(CLASSES["of_machines"])
# names in the namespaces of all generations of the metamodel
_ODE = re.compile(r"[/.-](deis|sesame|mergedode|ode|sacm)(?![a-z])", re.IGNORECASE)


def survey(document: EddiDocument) -> dict[str, Any]:
    """Visit every element of a document, and return what ``show --json`` prints.

    ``models`` are in document order, those of our own maps last; ``packages`` the roots and the
    packages in them; ``elements`` and ``references`` are numbers, also of the unresolved ones.
    """
    references = document.references

    def described(key: str, value: str, name: str, element: Element) -> dict[str, Any]:
        place = document.place(element)
        return {key: value, "name": name, "path": place.path or "/", "line": place.line}

    models: list[dict[str, Any]] = []
    elements = total = unresolved = 0
    for element in document.document.iter():
        elements += 1
        kind = document.kind_of(element)
        if kind is not None:
            name = document.name_of(element) or PurePath(document.name).stem
            counts = _counts(document, kind, element)
            models.append({**described("kind", kind, name, element), "counts": counts})
        # a reference shows by its form, in any attribute
        texts = (str(value) for value in element.values() if "/@" in value)
        for token in (token for text in texts for token in text.split() if "/@" in token):
            fragment = parse_fragment(token.removeprefix("#"))
            if fragment is not None:
                total += 1
                unresolved += references.resolve(fragment) is None
    for extension_map in extension_maps(document, EVENTS, SAFEML):
        kind, counts = "safeml", {"settings": len(extension_map.values)}
        if extension_map.key == EVENTS:
            kind, tags = "event", {"events": "EVENT", "variables": "VAR"}
            counts = {name: len(extension_map.of(tag)) for name, tag in tags.items()}
        entry = described("kind", kind, extension_map.model or "", extension_map.element)
        models.append({**entry, "counts": counts})
    packages = [
        described("class", document.class_or_feature(package), document.name_of(package), package)
        for package in document.packages()
    ]
    numbers = {"total": total, "unresolved": unresolved}
    return {"models": models, "packages": packages, "elements": elements, "references": numbers}


def _counts(document: EddiDocument, kind: str, model: Element) -> dict[str, int]:
    parts: dict[str, list[Element]] = {}
    for pair in METAMODEL["counts"][kind].split():
        key, _, path = pair.partition(":")
        parts[key] = [model]
        for feature in (getattr(names, name) for name in path.split(".")):
            parts[key] = [c for each in parts[key] for c in document.children(each, feature)]
    counts = {key: len(elements) for key, elements in parts.items()}
    if kind == "fault_tree":
        causes, failures = parts["causes"], counts.pop("failures")
        types = [fold(document.attribute(cause, names.CAUSE_TYPE) or "") for cause in causes]
        gates = sum(document.class_of(cause).name == "gate" for cause in causes)
        counts |= {"basic_events": types.count("basicevent"), "gates": gates, "failures": failures}
    if kind == "consert":  # the services that it refers to
        for key, elements, link in (
            ("required_services", "demands", names.REQUIRED_SERVICE),
            ("provided_services", "guarantees", names.PROVIDED_SERVICE),
        ):
            texts = (document.attribute(element, link) or "" for element in parts[elements])
            counts[key] = len({token for text in texts for token in text.split()})
    return counts


def unread(document: EddiDocument) -> dict[str, list[Element]]:
    """Return each class of packages and models that nothing reads, with its elements."""
    classes: dict[str, list[Element]] = {}
    has_machine = any(
        document.kind_of(each) == "state_machine" for each in document.document.iter()
    )
    for element in _unread_elements(document):
        if not (has_machine and document.class_of(element).name in _OF_MACHINES):
            classes.setdefault(document.class_or_feature(element), []).append(element)
    return classes


def _unread_elements(document: EddiDocument) -> Iterator[Element]:
    packages = list(document.packages())
    known = set(packages)
    inside: set[Element] = set()
    for package in packages:
        class_name = fold(local_name(document.class_or_feature(package)))
        if document.is_monitored(package):
            continue  # a model by itself is read completely
        if package.getparent() in inside:
            inside.add(package)  # reported with the enclosing package
        elif class_name in _READ or document.holds_models(package):
            is_read = class_name in _READ - {"ddipackage"}
            children = [c for c in package.iterchildren() if c not in known]
            for child in (c for c in children if fold(feature_of(c)) != _MAPS):
                if is_read or document.holds_models(child):
                    yield from _left_out_below(document, child)
                else:
                    yield child
        elif fold(document.class_or_feature(package)).endswith(("package", "packages")):
            inside.add(package)
            yield package


def _left_out_below(document: EddiDocument, element: Element) -> Iterator[Element]:
    waiting = [element]
    while waiting:
        element = waiting.pop()
        if _is_left_out(document, element):
            yield element
        else:
            waiting += reversed(element)


def _is_left_out(document: EddiDocument, element: Element) -> bool:
    name = fold(local_name(document.class_or_feature(element)))
    is_package = name.endswith(("package", "packages")) and not document.holds_models(element)
    is_left_out = is_package or name.endswith("action") or name.removesuffix("s") in _LEFT_OUT
    return is_left_out and not document.is_monitored(element)


def foreign(document: EddiDocument) -> Problem | None:
    """Return F003 for XML that is not an EDDI by any of its roots, ``None`` for one that may be."""
    for root in document.roots:
        uri = str(root.tag).rpartition("}")[0]
        if document.class_of(root).name in KNOWN_CLASSES or _ODE.search(uri) is not None:
            return None
    root = document.roots[0] if document.roots else document.document
    name, place = feature_of(root), document.place(root)
    format_ = METAMODEL["other_formats"].get(local_name(name))
    if format_ is not None:
        return problem("F003.foreign", place, name=name, format=format_)
    return problem("F003.root", place, name=name)


def check_features(document: EddiDocument) -> Iterator[Problem]:
    """Yield X011 for two spellings of one thing, and X007 for references."""
    waiting = list(reversed(document.roots))
    while waiting:
        element = waiting.pop()
        if document.kind_of(element) not in MONITORED | {"failure_model"}:
            waiting += reversed(element)
            continue
        for part in element.iter():
            first: dict[str, str] = {}
            stated: list[tuple[Element, str, str]] = []  # owner, feature and text of a reference
            for name, value in ((str(name), str(value)) for name, value in part.attrib.items()):
                other = first.setdefault(names.ONE_THING.get(fold(name), name), name)
                if other != name:
                    place = document.place(part)
                    yield problem("X011.two_spellings", place, first=other, second=name)
                if fold(name) in names.REFERENCES:
                    tokens = value.split()[:MAX_REFERENCES]
                    stated += [(part, name, token) for token in tokens]
                parent = part.getparent()
                if name == "href" and parent is not None:  # of the feature that the element is in
                    stated.append((parent, feature_of(part), value))
            for owner, feature, text in stated:
                end = document.target(owner, feature, text)
                if isinstance(end, Problem):
                    # what a monitor needs not be there: a requirement in a file of its own, say
                    is_needed = end.case != "X007.resource" or fold(feature) not in names.LINKS
                    yield end if is_needed else replace(end, level="warning")

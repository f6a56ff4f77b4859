"""What is in an EDDI, whether or not we have a monitor for it: for ``show`` and for reports.

Unlike reading, a survey visits every element of the file.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from eddi_scaffold.eddi_xml import vocabulary as names
from eddi_scaffold.eddi_xml.extensions import EVENTS, SAFEML, extension_maps
from eddi_scaffold.eddi_xml.parsing import XSI_TYPE, Element, feature_of, select
from eddi_scaffold.eddi_xml.references import References, parse_fragment
from eddi_scaffold.eddi_xml.vocabulary import Spelling, fold

if TYPE_CHECKING:
    from eddi_scaffold.eddi_xml.document import EddiDocument

MONITORED = frozenset({"bayesian_network", "consert", "fault_tree", "markov_chain"})
"""Kinds of models that monitors are made of."""


def survey(document: EddiDocument) -> dict[str, Any]:
    """Visit every element of a document, and return what ``show --json`` prints.

    ``models`` are in document order, those of our own maps last; ``packages`` the roots and the
    packages in them; ``elements`` and ``references`` are numbers, also of the unresolved ones.
    """
    references = References(document.roots)  # its own: it must not disturb a reader's remarks
    models: list[dict[str, Any]] = []
    elements = total = unresolved = 0
    for element in document.document.iter():
        elements += 1
        kind = kind_of_model(document, element)
        if kind is not None:
            name = name_of(document, element) or PurePath(document.name).stem
            counts = {
                key: count(document, element)
                if callable(count)
                else _count(document, element, count)
                for key, count in _COUNTS[kind].items()
            }
            models.append({"kind": kind, "name": name, **_at(document, element), "counts": counts})
        # a reference shows by its form, in any attribute
        texts = (str(value) for value in element.values() if "/@" in value)
        for token in (token for text in texts for token in text.split() if "/@" in token):
            fragment = parse_fragment(token.removeprefix("#"))
            if fragment is not None:
                total += 1
                unresolved += references.resolve(fragment) is None
    for extension_map in extension_maps(document, EVENTS, SAFEML):
        counts = {"settings": len(extension_map.values)}
        if extension_map.key == EVENTS:
            tags = {"events": "EVENT", "variables": "VAR"}
            counts = {name: len(extension_map.of(tag)) for name, tag in tags.items()}
        kind = extension_map.key.removeprefix("eddi.").removesuffix("s")
        at = _at(document, extension_map.element)
        name = extension_map.model or ""
        models.append({"kind": kind, "name": name, **at, "counts": counts})
    packages = [
        {
            "class": document.class_or_feature(package),
            "name": name_of(document, package),
            **_at(document, package),
        }
        for package in document.packages()
    ]
    return {
        "models": models,
        "packages": packages,
        "elements": elements,
        "references": {"total": total, "unresolved": unresolved},
    }


def _at(document: EddiDocument, element: Element) -> dict[str, Any]:
    place = document.place(element)
    return {"path": place.path or "/", "line": place.line}


def name_of(document: EddiDocument, element: Element) -> str:
    """Return the name; in SACM it is an object with a content, often of the part only."""
    name = document.attribute(element, names.NAME)
    if name is not None:
        return name
    query = '*[local-name()="name"]/@content'
    contents = select(element, query) or select(element, f"*/{query}")
    return str(contents[0]) if contents else ""


_BY_CLASS = {
    "bayesiannetwork": "bayesian_network",
    "faulttree": "fault_tree",
    "markovchain": "markov_chain",
    "statemachine": "state_machine",
    "fmea": "fmea",
    "fmeda": "fmea",
    "failuremodel": "failure_model",
    "assurancecasepackage": "assurance_case",
}
_BY_FEATURE = {
    # The class of these features where xsi:type is absent.
    "failuremodels": "failure_model",
    "bayesiannetworks": "bayesian_network",
    "bayesiannetwork": "bayesian_network",
    "assurancecasepackages": "assurance_case",
    "assurancecasepackage": "assurance_case",
    "conserts": "consert",
    "consert": "consert",
}


def kind_of_model(document: EddiDocument, element: Element) -> str | None:
    """Return the kind of the model that an element is, ``None`` when it is none."""
    class_name = element.get(XSI_TYPE)
    feature = fold(feature_of(element))
    kind = _BY_CLASS.get(fold(class_name.rpartition(":")[2])) if class_name is not None else None
    kind = kind or _BY_FEATURE.get(feature)
    if kind is None and feature in _BY_CLASS and document.is_root(element):
        kind = _BY_CLASS[feature]
    if kind == "state_machine" and is_chain(document, element):
        return "markov_chain"
    if kind == "consert" and not document.is_root(element):
        return kind if _holds_conserts(document, element.getparent()) else None
    if kind == "assurance_case":
        outer = (fold(feature_of(ancestor)) for ancestor in element.iterancestors())
        return None if any("assurancecasepackage" in feature for feature in outer) else kind
    return kind


def _holds_conserts(document: EddiDocument, parent: Element | None) -> bool:
    if parent is None:
        return False
    is_package = document.class_of(parent).name == names.PACKAGE_CLASS
    return is_package or names.CONFIGURATIONS.accepts(feature_of(parent))


def is_chain(document: EddiDocument, machine: Element) -> bool:
    """Tell whether every transition has a rate, and none a trigger."""
    transitions = document.children(machine, names.TRANSITIONS)
    return bool(transitions) and all(
        has_rate(document, transition) and not has_trigger(document, transition)
        for transition in transitions
    )


def has_rate(document: EddiDocument, transition: Element) -> bool:
    """Tell whether a transition has a rate; EMF may write the zero that was not given."""
    if (document.attribute(transition, names.RATE) or "").strip("0. "):
        return True
    laws = document.children(transition, names.RATE_DISTRIBUTION)
    return any(not is_none(document, law) for law in laws)


def has_trigger(document: EddiDocument, transition: Element) -> bool:
    """Tell whether a transition waits for an event."""
    triggers = (document.attribute(transition, names.TRIGGERS) or "").strip()
    return bool(triggers or document.children(transition, names.TRIGGERS))


def is_none(document: EddiDocument, distribution: Element) -> bool:
    """Tell whether a distribution says that there is none."""
    type_ = (document.attribute(distribution, names.DISTRIBUTION_TYPE) or "").strip().casefold()
    return type_ in ("", "none") and not document.children(distribution, names.PARAMETERS)


def _count(document: EddiDocument, element: Element, path: tuple[Spelling, ...]) -> int:
    """Return how many elements there are at the end of a path of features."""
    elements = [element]
    for spelling in path:
        elements = [c for element in elements for c in document.children(element, spelling)]
    return len(elements)


def _services(feature: Spelling, link: Spelling, listed: Spelling) -> Count:
    """Count the services that a ConSert refers to, or that its configuration holds."""

    def count(document: EddiDocument, element: Element) -> int:
        tokens = {
            token
            for member in document.children(element, feature)
            for token in (document.attribute(member, link) or "").split()
        }
        parent = element.getparent()
        if parent is None or not names.CONFIGURATIONS.accepts(feature_of(parent)):
            return len(tokens)
        return len(document.children(parent, listed)) or len(tokens)

    return count


def _basic_events(document: EddiDocument, tree: Element) -> int:
    causes = document.children(tree, names.CAUSES)
    types = [document.attribute(cause, names.CAUSE_TYPE) or "" for cause in causes]
    return sum(fold(type_) == "basicevent" for type_ in types)


def _gates(document: EddiDocument, tree: Element) -> int:
    causes = document.children(tree, names.CAUSES)
    return sum(document.class_of(cause).name == "gate" for cause in causes)


def _below(feature: str, class_name: str = "") -> Count:
    """Count the elements in a feature at any depth, of one class or of all."""

    def count(document: EddiDocument, element: Element) -> int:
        below = select(element, f'descendant::*[local-name()="{feature}"]')
        return sum(class_name in ("", document.class_of(each).name) for each in below)

    return count


Count = Callable[["EddiDocument", Element], int]
_FAILURES = (names.FAILURES,)
_CHAIN: Mapping[str, tuple[Spelling, ...]] = {
    "states": (names.STATES,),
    "transitions": (names.TRANSITIONS,),
    "failures": _FAILURES,
}
_COUNTS: Mapping[str, Mapping[str, Count | tuple[Spelling, ...]]] = {
    "consert": {
        "guarantees": (names.GUARANTEES,),
        "demands": (names.DEMANDS,),
        "evidence": (names.EVIDENCE,),
        "gates": (names.GATES,),
        "tree_propagations": (names.PROPAGATIONS,),
        "required_services": _services(
            names.DEMANDS, names.REQUIRED_SERVICE, names.REQUIRED_SERVICES
        ),
        "provided_services": _services(
            names.GUARANTEES, names.PROVIDED_SERVICE, names.PROVIDED_SERVICES
        ),
    },
    "bayesian_network": {
        "nodes": (names.NODES,),
        "states": (names.NODES, names.NODE_STATES),
        "connections": (names.CONNECTIONS,),
        "rows": (names.NODES, names.ROWS),
    },
    "fault_tree": {
        "causes": (names.CAUSES,),
        "basic_events": _basic_events,
        "gates": _gates,
        "failures": _FAILURES,
    },
    "markov_chain": _CHAIN,
    "state_machine": _CHAIN,
    "fmea": {"entries": (Spelling("entries"),), "failures": _FAILURES},
    "failure_model": {"failures": _FAILURES},
    "assurance_case": {
        "argumentation_elements": _below("argumentationElement"),
        "claims": _below("argumentationElement", "claim"),
        "artifact_references": _below("argumentationElement", "artifactreference"),
        "artifact_elements": _below("artifactElement"),
    },
}

"""What is in an EDDI, whether or not we have a monitor for it: for ``show`` and for reports.

Unlike reading, a survey visits every element of the file.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import PurePath
from typing import TYPE_CHECKING

from eddi_scaffold.eddi_xml import vocabulary as word
from eddi_scaffold.eddi_xml.extensions import EVENTS, SAFEML, ExtensionMap, extension_maps
from eddi_scaffold.eddi_xml.parsing import XSI_TYPE, feature_of, select
from eddi_scaffold.eddi_xml.references import References, parse_fragment
from eddi_scaffold.eddi_xml.vocabulary import Spelling, fold

if TYPE_CHECKING:
    from eddi_scaffold.eddi_xml.document import EddiDocument
    from eddi_scaffold.eddi_xml.parsing import Element

Counts = Mapping[str, int]


@dataclass(frozen=True)
class FoundModel:
    """One model of any kind.

    Attributes:
        kind: name of the monitor kind that it is for (``consert``, ``fault_tree``, ...).
        name: its name, or the stem of the file.
        path: canonical fragment path.
        line: line of its element.
        counts: how many of what it holds.
    """

    kind: str
    name: str
    path: str
    line: int | None
    counts: Counts


@dataclass(frozen=True)
class FoundPackage:
    """A package, with the class that the file states."""

    class_name: str
    name: str
    path: str
    line: int | None


@dataclass(frozen=True)
class Survey:
    """Everything in one file.

    Attributes:
        models: in document order, those of our own maps last.
        packages: the roots and the packages in them, in document order.
        elements: number of elements, with the document element.
        references: number of references, counted by their form in any attribute.
        unresolved: how many of them point at nothing.
    """

    models: tuple[FoundModel, ...]
    packages: tuple[FoundPackage, ...]
    elements: int
    references: int
    unresolved: int

    def as_json(self) -> dict[str, object]:
        """Return the stable JSON form of ``show --json``."""
        return {
            "models": [dict(vars(model)) for model in self.models],
            "packages": [
                {"class": p.class_name, "name": p.name, "path": p.path, "line": p.line}
                for p in self.packages
            ],
            "elements": self.elements,
            "references": {"total": self.references, "unresolved": self.unresolved},
        }


MONITORED = frozenset({"bayesian_network", "consert", "fault_tree", "markov_chain"})
"""Kinds of models that monitors are made of."""


def survey(document: EddiDocument) -> Survey:
    """Visit every element of a document."""
    references = References(document.roots)  # its own: it must not disturb a reader's remarks
    models: list[FoundModel] = []
    elements = total = unresolved = 0
    for element in document.document.iter():
        elements += 1
        kind = kind_of_model(document, element)
        if kind is not None:
            models.append(_model(document, element, kind))
        for value in element.values():
            if "/@" not in value:
                continue
            for token in str(value).split():
                fragment = parse_fragment(token.removeprefix("#")) if "/@" in token else None
                if fragment is not None:
                    total += 1
                    unresolved += references.resolve(fragment) is None
    models += [_of_map(extension_map) for extension_map in extension_maps(document, EVENTS, SAFEML)]
    packages = tuple(_package(document, element) for element in document.packages())
    return Survey(tuple(models), packages, elements, total, unresolved)


def _model(document: EddiDocument, element: Element, kind: str) -> FoundModel:
    place = document.place(element)
    name = name_of(document, element) or PurePath(document.name).stem
    return FoundModel(kind, name, place.path or "/", place.line, _COUNTS[kind](document, element))


def _of_map(one: ExtensionMap) -> FoundModel:
    """Return the model that a map of ours describes."""
    counts = {"events": len(one.of("EVENT")), "variables": len(one.of("VAR"))}
    counts = counts if one.key == EVENTS else {"settings": len(one.values)}
    name = one.key.removeprefix("eddi.").removesuffix("s")
    return FoundModel(name, one.model or "", one.place.path or "/", one.place.line, counts)


def _package(document: EddiDocument, element: Element) -> FoundPackage:
    place = document.place(element)
    stated = document.class_of(element).printed or feature_of(element)
    return FoundPackage(stated, name_of(document, element), place.path or "/", place.line)


def name_of(document: EddiDocument, element: Element) -> str:
    """Return the name; in SACM it is an object with a content, often of the part only."""
    stated = document.attribute(element, Spelling("name"))
    if stated is not None:
        return stated
    here = '*[local-name()="name"]/@content'
    contents = select(element, here) or select(element, f"*/{here}")
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
    stated = element.get(XSI_TYPE)
    feature = fold(feature_of(element))
    kind = _BY_CLASS.get(fold(stated.rpartition(":")[2])) if stated is not None else None
    kind = kind or _BY_FEATURE.get(feature)
    if kind is None and feature in _BY_CLASS and document.is_root(element):
        kind = _BY_CLASS[feature]
    if kind == "state_machine" and is_chain(document, element):
        return "markov_chain"
    if kind == "consert" and not document.is_root(element):
        kind = kind if _holds_conserts(document, element.getparent()) else None
    if kind == "assurance_case" and _is_nested(element):
        return None
    return kind


def is_chain(document: EddiDocument, machine: Element) -> bool:
    """Tell whether every transition has a rate, and none a trigger."""
    transitions = document.children(machine, word.TRANSITIONS)
    return bool(transitions) and all(
        has_rate(document, transition) and not has_trigger(document, transition)
        for transition in transitions
    )


def has_rate(document: EddiDocument, transition: Element) -> bool:
    """Tell whether a transition has a rate; EMF may write the zero that was not given."""
    if (document.attribute(transition, word.RATE) or "").strip("0. "):
        return True
    laws = document.children(transition, word.RATE_DISTRIBUTION)
    return any(not is_none(document, law) for law in laws)


def has_trigger(document: EddiDocument, transition: Element) -> bool:
    """Tell whether a transition waits for an event."""
    given = (document.attribute(transition, word.TRIGGERS) or "").strip()
    return bool(given or document.children(transition, word.TRIGGERS))


def is_none(document: EddiDocument, distribution: Element) -> bool:
    """Tell whether a distribution says that there is none."""
    stated = (document.attribute(distribution, word.DISTRIBUTION_TYPE) or "").strip().casefold()
    return stated in ("", "none") and not document.children(distribution, word.PARAMETERS)


def _holds_conserts(document: EddiDocument, parent: Element | None) -> bool:
    if parent is None:
        return False
    is_package = document.class_of(parent).name == "consertpackage"
    return is_package or fold(feature_of(parent)) in ("configurations", "configuration")


def _is_nested(element: Element) -> bool:
    return any("assurancecasepackage" in fold(feature_of(a)) for a in element.iterancestors())


def _count(document: EddiDocument, element: Element, *names: str) -> int:
    return len(document.children(element, Spelling(names[0], names[1:])))


def _consert(document: EddiDocument, element: Element) -> Counts:
    return {
        "guarantees": _count(document, element, "guarantees"),
        "demands": _count(document, element, "demands"),
        "evidence": _count(document, element, "runtimeEvidence", "runtimeEvidences"),
        "gates": _count(document, element, "consertGates", "gates"),
        "tree_propagations": _count(
            document, element, "guaranteePropagation", "guaranteePropagations"
        ),
        "required_services": _services(document, element, "demands", "requiredService"),
        "provided_services": _services(document, element, "guarantees", "providedService"),
    }


def _services(document: EddiDocument, element: Element, feature: str, link: str) -> int:
    """Count the services that a ConSert refers to, or that its configuration holds."""
    tokens = {
        token
        for member in document.children(element, Spelling(feature))
        for token in (document.attribute(member, Spelling(link)) or "").split()
    }
    parent = element.getparent()
    if parent is None or fold(feature_of(parent)) not in ("configurations", "configuration"):
        return len(tokens)
    return _count(document, parent, f"{link}s") or len(tokens)


def _bayesian_network(document: EddiDocument, element: Element) -> Counts:
    nodes = document.children(element, Spelling("nodes"))
    return {
        "nodes": len(nodes),
        "states": sum(_count(document, node, "nodeStates") for node in nodes),
        "connections": _count(document, element, "causalConnections"),
        "rows": sum(
            _count(document, node, "conditionalProbabilityDistributions") for node in nodes
        ),
    }


def _fault_tree(document: EddiDocument, element: Element) -> Counts:
    causes = document.children(element, Spelling("causes"))
    kinds = [document.attribute(cause, Spelling("causeType")) or "" for cause in causes]
    return {
        "causes": len(causes),
        "basic_events": sum(fold(kind) == "basicevent" for kind in kinds),
        "gates": sum(document.class_of(cause).name == "gate" for cause in causes),
        "failures": _count(document, element, "failures"),
    }


def _markov_chain(document: EddiDocument, element: Element) -> Counts:
    return {
        "states": _count(document, element, "states"),
        "transitions": len(document.children(element, word.TRANSITIONS)),
        "failures": _count(document, element, "failures"),
    }


def _fmea(document: EddiDocument, element: Element) -> Counts:
    return {
        "entries": _count(document, element, "entries"),
        "failures": _count(document, element, "failures"),
    }


def _failure_model(document: EddiDocument, element: Element) -> Counts:
    return {"failures": _count(document, element, "failures")}


def _assurance_case(document: EddiDocument, element: Element) -> Counts:
    arguments = select(element, 'descendant::*[local-name()="argumentationElement"]')
    classes = [document.class_of(argument).name for argument in arguments]
    artifacts = select(element, 'descendant::*[local-name()="artifactElement"]')
    return {
        "argumentation_elements": len(arguments),
        "claims": classes.count("claim"),
        "artifact_references": classes.count("artifactreference"),
        "artifact_elements": len(artifacts),
    }


_COUNTS: Mapping[str, Callable[[EddiDocument, Element], Counts]] = {
    "consert": _consert,
    "bayesian_network": _bayesian_network,
    "fault_tree": _fault_tree,
    "markov_chain": _markov_chain,
    "state_machine": _markov_chain,
    "fmea": _fmea,
    "failure_model": _failure_model,
    "assurance_case": _assurance_case,
}

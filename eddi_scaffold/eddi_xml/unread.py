"""What no monitor is made of: packages of an EDDI that nothing reads, and XML that is not an EDDI.

Models in them would otherwise be lost silently. So would misspelt classes, references that no
monitor uses, and one of two spellings of one thing.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import replace
from difflib import SequenceMatcher
from typing import TYPE_CHECKING, NamedTuple

from eddi_scaffold.common.problems import Place, Problem, plural, problem
from eddi_scaffold.eddi_xml import vocabulary as names
from eddi_scaffold.eddi_xml.parsing import XSI_TYPE, Element, feature_of, select
from eddi_scaffold.eddi_xml.survey import MONITORED, kind_of_model
from eddi_scaffold.eddi_xml.vocabulary import fold, local_name

if TYPE_CHECKING:
    from eddi_scaffold.eddi_xml.document import EddiDocument

MODELS = ("BayesianNetwork", "ConSert", "FaultTree", "MarkovChain", "StateMachine")
"""Classes that monitors are made of."""
PACKAGES = ("ConSertPackage", "DDIPackage", "FailureLogicPackage")
"""Packages that hold them."""
OTHERS = (
    *("AttackTree", "Failure", "FailureModel", "FMEA", "FMEDA", "SecurityViolation"),
    *("CommonCauseFailure", "Action", "FunctionAction", "MessageAction", "WarningAction"),
    *("RosAction", "StateMachineAction"),
    *("AssuranceCasePackage", "ArgumentPackage", "ArtifactPackage", "TerminologyPackage"),
    *("ArchitecturePackage", "DesignPackage", "DependabilityPackage", "RequirementPackage"),
    *("DomainPackage", "HARAPackage", "TARAPackage", "StandardPackage", "ODEProductPackage"),
    *("EventPackage", "TraceabilityPackage", "SafetyRelatedSystem"),
    *("System", "PhysicalComponent", "LogicalComponent", "SoftwareComponent", "Function"),
)
"""Classes of the metamodel that are left out on purpose."""
CLASSES = frozenset(fold(name) for name in (*MODELS, *PACKAGES, *OTHERS))
"""All that are known, folded."""

_COMPLETELY_KNOWN = frozenset({"failurelogic", "bayesiannetwork"})
"""Packages of which every class should be known."""
_SIMILAR = 0.8
_READ = frozenset({"consertpackage", "ddipackage", "designpackage", "failurelogicpackage"})
"""Packages that readers look into, whether or not there is a model in them."""
_LEFT_OUT = frozenset({"action", "attacktree", "fmea", "fmeda", "statemachine"})
"""Models of which no monitors are generated."""
_DESIGN = frozenset(
    {"systems", "serviceconfigurations", "requiredservices", "providedservices"}
    | {"servicetype", "configurations"}
)
"""Features of a design that readers look into."""
_MAPS = "keyvaluemaps"
_ODE = re.compile(r"[/.-](deis|sesame|mergedode|ode|sacm)(?![a-z])", re.IGNORECASE)
"""Names in the namespaces of all generations of the metamodel."""
_OTHER_FORMATS = {
    "launch": "a launch file",
    "package": "the package.xml of a ROS package",
    "pnml": "a Petri net",
    "robot": "a URDF",
    "sdf": "an SDF world or model",
    "svg": "a picture",
}


class Unread(NamedTuple):
    """Packages and models of one class that nothing reads.

    Attributes:
        class_name: their class as the file states it, or the feature that they are in.
        number: how many.
        elements: number of elements, with all inside.
        inside: class -> how many packages and models of it lie in them.
        place: of the first one.
    """

    class_name: str
    number: int
    elements: int
    inside: Mapping[str, int]
    place: Place

    def as_json(self) -> dict[str, object]:
        """Return the stable JSON form of ``show --json``."""
        return {
            "class": self.class_name,
            "count": self.number,
            "elements": self.elements,
            "inside": dict(self.inside),
            "path": self.place.path,
            "line": self.place.line,
        }

    def problem(self) -> Problem:
        """Return the warning (X021)."""
        name = local_name(self.class_name)
        listed = plural(self.elements, "element")
        if self.inside:
            listed += f" with {', '.join(f'{n} {what}' for what, n in self.inside.items())}"
        listed = listed if name == self.class_name else f"{self.class_name}, {listed}"
        verb, them = ("is", "it") if self.number == 1 else ("are", "them")
        read = f"{verb} not read: no monitor is made of {them}"
        if fold(name) == "statemachine":
            read = f"{verb} listed by `show`: no monitor is made of {them} yet"
        fields = {"name": name, "listed": listed, "read": read}
        return problem("X021.ignored", self.place, number=self.number, **fields)


def unread(document: EddiDocument) -> list[Unread]:
    """Return each class of packages and models that nothing reads, in document order."""
    classes: dict[str, list[Element]] = {}
    for element in _unread_elements(document):
        classes.setdefault(document.class_or_feature(element), []).append(element)
    result = []
    for class_name, elements in classes.items():
        below = [each for element in elements for each in element.iterdescendants()]
        inside = Counter(
            local_name(document.class_or_feature(each))
            for each in below
            if _is_left_out(document, each)
        )
        number, place = len(elements), document.place(elements[0])
        result.append(Unread(class_name, number, number + len(below), inside, place))
    return result


def _unread_elements(document: EddiDocument) -> Iterator[Element]:
    """Yield packages without a model for a monitor, and other models next to such ones."""
    packages = list(document.packages())
    known = set(packages)
    inside: set[Element] = set()
    for package in packages:
        if kind_of_model(document, package) in MONITORED:
            continue  # a model by itself is read completely
        if package.getparent() in inside:
            inside.add(package)  # reported with the enclosing package
        elif document.class_of(package).name in _READ or _holds_models(document, package):
            for child in package.iterchildren():
                if child not in known and fold(feature_of(child)) != _MAPS:
                    yield from _unread_of_child(document, package, child)
        elif fold(document.class_or_feature(package)).endswith(("package", "packages")):
            inside.add(package)
            yield package


def _unread_of_child(document: EddiDocument, package: Element, child: Element) -> Iterator[Element]:
    """Yield what is not read of a child of a package that is, at least in part."""
    if document.class_of(package).name not in _READ - {"ddipackage"} and not _holds_models(
        document, child
    ):
        yield child
        return
    waiting = [child]
    while waiting:
        element = waiting.pop()
        if _is_left_out(document, element):
            yield element
        else:
            waiting += reversed(element)


def _is_left_out(document: EddiDocument, element: Element) -> bool:
    """Tell whether an element is a model or a package that no monitor is made of."""
    name = fold(local_name(document.class_or_feature(element)))
    is_package = name.endswith(("package", "packages")) and not _holds_models(document, element)
    is_left_out = is_package or name.endswith("action") or name.removesuffix("s") in _LEFT_OUT
    return is_left_out and kind_of_model(document, element) not in MONITORED


def _holds_models(document: EddiDocument, element: Element) -> bool:
    return any(kind_of_model(document, each) in MONITORED for each in element.iter())


def event_monitors(document: EddiDocument) -> Iterator[Problem]:
    """Yield an info (X021) on what event monitors read: here the configuration says it."""
    query = 'descendant::*[local-name()="monitors"][@variableName]'
    monitors = [monitor for root in document.roots for monitor in select(root, query)]
    if monitors:
        variables = [str(monitor.get("variableName")) for monitor in monitors]
        listed = ", ".join(variables[:8]) + (", ..." if len(variables) > 8 else "")
        fields = {"number": plural(len(monitors), "EventMonitor"), "listed": listed}
        yield problem("X021.variables", document.place(monitors[0]), **fields)


def unused_design(document: EddiDocument) -> Iterator[Problem]:
    """Yield an info (X021) on what the design holds besides systems and services."""
    unused: list[Element] = []
    packages = document.packages()
    waiting = [p for p in packages if document.class_of(p).name == "designpackage"]
    for element in waiting:
        for child in element.iterchildren():
            feature = fold(feature_of(child))
            if feature in _DESIGN:
                waiting.append(child)
            elif feature != _MAPS and not _holds_models(document, child):
                unused.append(child)
    if unused:
        counts = Counter(map(feature_of, unused))
        text = ", ".join(f"{count} {feature}" for feature, count in counts.items())
        first = min(map(document.place, unused), key=lambda place: place.line or 0)
        yield problem("X021.unused", first, elements=text)


def foreign(document: EddiDocument) -> Problem | None:
    """Return F003 for XML that is not an EDDI by any of its roots, ``None`` for one that may be."""
    for root in document.roots:
        uri = str(root.tag).rpartition("}")[0]
        if document.class_of(root).name in CLASSES or _ODE.search(uri) is not None:
            return None
    root = document.roots[0] if document.roots else document.document
    name, place = feature_of(root), document.place(root)
    if local_name(name) in _OTHER_FORMATS:
        return problem("F003.foreign", place, name=name, format=_OTHER_FORMATS[local_name(name)])
    return problem("F003.root", place, name=name)


def unknown_classes(document: EddiDocument) -> Iterator[Problem]:
    """Yield a warning (X006) for each element of a package whose class looks like a misspelt one.

    In the packages that hold chains, trees and networks every unknown class is named.
    """
    for package in document.packages():
        if kind_of_model(document, package) in MONITORED:
            continue  # the root is a model, whose reader knows its parts
        for element in package.iterchildren():
            class_name = document.class_of(element)
            if element.get(XSI_TYPE) is None or class_name.name in CLASSES:
                continue
            meant = _most_similar(class_name.name)
            is_package = class_name.name.endswith("package")
            if meant is None and (class_name.package not in _COMPLETELY_KNOWN or is_package):
                continue
            name = element.get("name")
            subject = feature_of(element) + (f' "{name}"' if name else "")
            is_read = _holds_models(document, element)
            yield problem(
                "X006.unknown_class" if is_read else "X006.unread_class",
                document.place(element),
                hint=f"did you mean {meant!r}?" if meant else f"known are: {', '.join(MODELS)}",
                subject=subject,
                class_name=class_name.printed,
            )


def _most_similar(folded: str) -> str | None:
    ratios = {
        SequenceMatcher(None, folded, fold(name)).ratio(): name for name in (*PACKAGES, *MODELS)
    }
    return ratios[max(ratios)] if max(ratios) >= _SIMILAR else None


def check_features(document: EddiDocument) -> Iterator[Problem]:
    """Yield X011 for two spellings of one thing, and X007 for references."""
    waiting = list(reversed(document.roots))
    while waiting:
        element = waiting.pop()
        if kind_of_model(document, element) not in MONITORED | {"failure_model", "state_machine"}:
            waiting += reversed(element)
            continue
        for part in element.iter():
            first: dict[str, str] = {}
            for name in map(str, part.attrib):
                other = first.setdefault(names.ONE_THING.get(fold(name), name), name)
                if other != name:
                    place = document.place(part)
                    yield problem("X011.two_spellings", place, first=other, second=name)
            yield from _check_references(document, part)


def _check_references(document: EddiDocument, part: Element) -> Iterator[Problem]:
    parent, limit = part.getparent(), document.limits.reference_tokens
    tokens: list[tuple[Element, str, str]] = []
    for key, value in part.attrib.items():
        name = str(key)
        if fold(name) in names.REFERENCES:
            tokens += [(part, name, token) for token in str(value).split()[:limit]]
        if name == "href" and parent is not None:
            tokens.append((parent, feature_of(part), str(value)))
    for element, name, token in tokens:
        end = document.target(element, name, token)
        if isinstance(end, Problem):
            # what a monitor needs not be there: a requirement in a file of its own, for example
            is_needed = end.case != "X007.resource" or fold(name) not in names.LINKS
            yield end if is_needed else replace(end, level="warning")

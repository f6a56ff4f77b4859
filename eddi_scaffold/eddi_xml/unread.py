"""What no monitor is made of: packages of an EDDI that nothing reads, and XML that is not an EDDI.

Models in them would otherwise be lost without a word. So would misspelt classes, references that
no monitor uses, and one of two spellings of one thing.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from difflib import SequenceMatcher
from typing import TYPE_CHECKING

from eddi_scaffold.common.problems import Place, Problem, plural, problem
from eddi_scaffold.eddi_xml import vocabulary as word
from eddi_scaffold.eddi_xml.parsing import XSI_TYPE, feature_of, select
from eddi_scaffold.eddi_xml.survey import MONITORED, kind_of_model
from eddi_scaffold.eddi_xml.vocabulary import fold, local_name

if TYPE_CHECKING:
    from eddi_scaffold.eddi_xml.document import EddiDocument
    from eddi_scaffold.eddi_xml.parsing import Element

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
_RUN = frozenset({"failurelogic", "bayesiannetwork"})
"""Packages of which every class should be known."""
_NEAR = 0.8
_READ = frozenset({"consertpackage", "ddipackage", "designpackage", "failurelogicpackage"})
"""Packages that readers look into, whether or not there is a model in them."""
_LEFT_OUT = frozenset({"action", "attacktree", "fmea", "fmeda", "statemachine"})
"""Models of which no monitors are generated."""
_DESIGN = frozenset(
    fold(name)
    for name in (
        *("systems", "serviceConfigurations", "requiredServices", "providedServices"),
        *("serviceType", "configurations"),
    )
)
"""Features of a design that readers look into."""
_ODE = re.compile(r"[/.-](deis|sesame|mergedode|ode|sacm)(?![a-z])", re.IGNORECASE)
"""Names in the namespaces of all generations of the metamodel."""
_LOOKS_LIKE = {
    "launch": "a launch file",
    "package": "the package.xml of a ROS package",
    "pnml": "a Petri net",
    "robot": "a URDF",
    "sdf": "an SDF world or model",
    "svg": "a picture",
}


@dataclass(frozen=True)
class Unread:
    """Packages and models of one class that nothing reads.

    Attributes:
        class_name: their class as the file states it, or the feature that they are in.
        count: how many.
        elements: number of elements, with all inside.
        inside: class -> how many packages and models of it lie in them.
        place: of the first one.
    """

    class_name: str
    count: int
    elements: int
    inside: Mapping[str, int]
    place: Place

    def as_json(self) -> dict[str, object]:
        """Return the stable JSON form of ``show --json``."""
        return {
            "class": self.class_name,
            "count": self.count,
            "elements": self.elements,
            "inside": dict(self.inside),
            "path": self.place.path,
            "line": self.place.line,
        }

    def problem(self) -> Problem:
        """Return the warning (X021)."""
        name = local_name(self.class_name)
        elements = plural(self.elements, "element")
        if self.inside:
            elements += f" with {', '.join(f'{n} {what}' for what, n in self.inside.items())}"
        what = elements if name == self.class_name else f"{self.class_name}, {elements}"
        verb, them = ("is", "it") if self.count == 1 else ("are", "them")
        read = f"{verb} not read: no monitor is made of {them}"
        if fold(name) == "statemachine":
            read = f"{verb} listed by `show`: no monitor is made of {them} yet"
        return problem(
            "X021.ignored", self.place, number=self.count, name=name, listed=what, read=read
        )


def unread(document: EddiDocument) -> list[Unread]:
    """Return each class of packages and models that nothing reads, in document order."""
    classes: dict[str, list[Element]] = {}
    for element in _unread_elements(document):
        classes.setdefault(_class_of(document, element), []).append(element)
    return [_described(document, stated, same) for stated, same in classes.items()]


def event_monitors(document: EddiDocument) -> Iterator[Problem]:
    """Yield an info (X021) on what event monitors read: here the configuration says it."""
    query = 'descendant::*[local-name()="monitors"][@variableName]'
    found = [one for root in document.roots for one in select(root, query)]
    if found:
        names = [str(one.get("variableName")) for one in found]
        shown = ", ".join(names[:8]) + (", ..." if len(names) > 8 else "")
        yield problem(
            "X021.variables",
            document.place(found[0]),
            number=plural(len(found), "EventMonitor"),
            listed=shown,
        )


def unused_design(document: EddiDocument) -> Iterator[Problem]:
    """Yield an info (X021) on what the design holds besides systems and services."""
    found: list[Element] = []
    waiting = [
        package
        for package in document.packages()
        if document.class_of(package).name == "designpackage"
    ]
    for element in waiting:
        for child in element.iterchildren():
            feature = fold(feature_of(child))
            if feature in _DESIGN:
                waiting.append(child)
            elif feature != "keyvaluemaps" and not _holds_models(document, child):
                found.append(child)
    if found:
        counts = Counter(map(feature_of, found))
        shown = ", ".join(f"{count} {feature}" for feature, count in counts.items())
        yield problem(
            "X021.unused",
            min(map(document.place, found), key=lambda one: one.line or 0),
            elements=shown,
        )


def foreign(document: EddiDocument) -> Problem | None:
    """Return F003 for XML that is not an EDDI by any of its roots, ``None`` for one that may be."""
    if any(_may_be_ours(document, root) for root in document.roots):
        return None
    root = document.roots[0] if document.roots else document.document
    name = feature_of(root)
    looks = _LOOKS_LIKE.get(local_name(name))
    case = "F003.foreign" if looks else "F003.root"
    return problem(case, document.place(root), name=name, **({"format": looks} if looks else {}))


def _may_be_ours(document: EddiDocument, root: Element) -> bool:
    uri = str(root.tag).rpartition("}")[0]
    return document.class_of(root).name in CLASSES or _ODE.search(uri) is not None


def _unread_elements(document: EddiDocument) -> Iterator[Element]:
    """Yield packages without a model for a monitor, and other models next to such ones."""
    packages = list(document.packages())
    known = set(packages)
    inside: set[Element] = set()
    for package in packages:
        if kind_of_model(document, package) in MONITORED:
            continue  # a model by itself is read whole
        if package.getparent() in inside:
            inside.add(package)  # reported with the enclosing package
        elif document.class_of(package).name in _READ or _holds_models(document, package):
            for child in package.iterchildren():
                if child not in known:
                    yield from _left_out(document, package, child)
        elif fold(_class_of(document, package)).endswith(("package", "packages")):
            inside.add(package)
            yield package


def _left_out(document: EddiDocument, package: Element, child: Element) -> Iterator[Element]:
    """Yield what is not read of a child of a package that is, at least in part."""
    if fold(feature_of(child)) == "keyvaluemaps":
        return
    own = document.class_of(package).name
    is_whole = own not in _READ or own == "ddipackage"
    if is_whole and not _holds_models(document, child):
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
    name = fold(local_name(_class_of(document, element)))
    is_package = name.endswith(("package", "packages")) and not _holds_models(document, element)
    is_left_out = is_package or name.endswith("action") or name.removesuffix("s") in _LEFT_OUT
    return is_left_out and kind_of_model(document, element) not in MONITORED


def _holds_models(document: EddiDocument, element: Element) -> bool:
    return any(kind_of_model(document, one) in MONITORED for one in element.iter())


def _class_of(document: EddiDocument, element: Element) -> str:
    """Return the class that an element states, else the feature that it is in."""
    return document.class_of(element).printed or feature_of(element)


def _described(document: EddiDocument, stated: str, same: Sequence[Element]) -> Unread:
    below = [iterdescendant for element in same for iterdescendant in element.iterdescendants()]
    inside = Counter(
        local_name(_class_of(document, one)) for one in below if _is_left_out(document, one)
    )
    return Unread(stated, len(same), len(same) + len(below), inside, document.place(same[0]))


def unknown_classes(document: EddiDocument) -> Iterator[Problem]:
    """Yield a warning (X006) for each element of a package whose class looks like a misspelt one.

    In the packages that hold chains, trees and networks every unknown class is named.
    """
    for package in document.packages():
        if kind_of_model(document, package) in MONITORED:
            continue  # the root is a model, whose reader knows its parts
        for element in package.iterchildren():
            if element.get(XSI_TYPE) is None:
                continue
            kind = document.class_of(element)
            if kind.name in CLASSES:
                continue
            meant = _nearest(local_name(kind.printed))
            if meant is None and (kind.package not in _RUN or kind.name.endswith("package")):
                continue
            name = element.get("name")
            what = feature_of(element) + (f' "{name}"' if name else "")
            unread = not any(kind_of_model(document, one) in MONITORED for one in element.iter())
            yield problem(
                "X006.unread_class" if unread else "X006.unknown_class",
                document.place(element),
                hint=f"did you mean {meant!r}?" if meant else f"known are: {', '.join(MODELS)}",
                subject=what,
                class_name=kind.printed,
            )


def _nearest(name: str) -> str | None:
    folded = fold(name)
    likeness = {
        known: SequenceMatcher(None, folded, fold(known)).ratio() for known in (*MODELS, *PACKAGES)
    }
    best = max(likeness, key=likeness.__getitem__)
    return best if likeness[best] >= _NEAR else None


def check_features(document: EddiDocument) -> Iterator[Problem]:
    """Yield X011 for two spellings of one thing, and X007 for references."""
    waiting = list(reversed(document.roots))
    while waiting:
        element = waiting.pop()
        if kind_of_model(document, element) not in MONITORED | {"failure_model", "state_machine"}:
            waiting += reversed(element)
            continue
        for part in element.iter():
            yield from _said_twice(document, part)
            yield from _references(document, part)


def _said_twice(document: EddiDocument, part: Element) -> Iterator[Problem]:
    first: dict[str, str] = {}
    for name in map(str, part.attrib):
        other = first.setdefault(word.ONE_THING.get(fold(name), name), name)
        if other != name:
            yield problem("X011.two_spellings", document.place(part), first=other, second=name)


def _references(document: EddiDocument, part: Element) -> Iterator[Problem]:
    parent, limit = part.getparent(), document.limits.reference_tokens
    tokens = [
        (part, name, token)
        for name, text in zip(map(str, part.attrib), part.attrib.values(), strict=True)
        if fold(name) in word.REFERENCES
        for token in str(text).split()[:limit]
    ]
    if parent is not None and "href" in part.attrib:
        tokens.append((parent, feature_of(part), str(part.attrib["href"])))
    for element, name, token in tokens:
        found = document.target(element, name, token)
        if isinstance(found, Problem):
            # what a monitor needs not be there: a requirement in a file of its own, for example
            if found.case == "X007.resource" and fold(name) in word.LINKS:
                found = replace(found, level="warning")
            yield found

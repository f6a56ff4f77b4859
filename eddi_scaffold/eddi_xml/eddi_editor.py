"""The files of EDDI-Editor, turned into the form of EMF that the readers of all kinds know.

Its serialiser knows no references: an object that is referred to is written again in full at each
place. Here it becomes one element, and its copies become references. A failure is known by its Id
and its name, a state by its name in its machine; a basic event is its failure.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from eddi_scaffold.common.files import IMPORT
from eddi_scaffold.common.problems import Place, Problem, did_you_mean, problem
from eddi_scaffold.eddi_xml.parsing import (
    XSI,
    XSI_TYPE,
    Element,
    feature_of,
    line_of,
    new_element,
    select,
)
from eddi_scaffold.eddi_xml.references import References
from eddi_scaffold.eddi_xml.vocabulary import METAMODEL, local_name

_TAGS = {role: frozenset(text.split()) for role, text in METAMODEL["eddi_editor"].items()}
_KNOWN = frozenset().union(*_TAGS.values())
_DEIS, _SESAME = "http://www.deis-project.eu/ode/", "http://www.sesame-project.eu/ode/"
_NAMESPACES = {
    "xsi": XSI,
    "architecture_": f"{_DEIS}architecture",
    "dependability_": f"{_DEIS}dependability",
    "event_": f"{_SESAME}event",
    "failureLogic_": f"{_DEIS}failureLogic",
    "integration_": f"{_DEIS}integration",
}
_PACKAGES = {  # class -> part of a model, feature of the package
    "architecture_:DesignPackage": ("SystemElements", "systems"),
    "event_:EventPackage": ("", "events"),
    "failureLogic_:FailureLogicPackage": ("FailureModels", "failureModels"),
    "dependability_:HARAPackage": ("Hazards", "hazards"),
}
_REFERRING = ("onEntry", "onExit", "actions", "triggers", "evidence")
"""Features whose actions and events stand in packages; others contain them."""
_WORSE = {"Failure Rate": max, "MTTF": min, "Unavailability": max}
_ACTIONS = '*[local-name()="Actions"]/*'
_CONTENT = 'descendant-or-self::*[not(ancestor-or-self::*[local-name()="keyValueMaps"])]'


class Converted(NamedTuple):
    """A file of EDDI-Editor in the form of EMF; no root after an error."""

    root: Element | None
    origins: Mapping[Element, Place]  # element -> where it stands in the file
    problems: Sequence[Problem]


def in_form_of_emf(model: Element, file: str, places: Mapping[Element, Place]) -> Converted | None:
    """Convert what EDDI-Editor saved, ``None`` for others; ``places`` are those of JSON."""
    parts = {feature_of(child) for child in model} if feature_of(model) == "Model" else set()
    if "Perspectives" in parts:  # the root has the same name
        other = "an input of HiP-HOPS, not an EDDI"
        fault = problem("F003.other", Place(file, line_of(model)), hint=IMPORT, other=other)
        return Converted(None, {}, [fault])
    if parts.isdisjoint(part for part, _ in _PACKAGES.values() if part):
        return None
    converter = _Converter(model, file, places)
    return Converted(converter.root, converter.origins, converter.all_problems())


def _class_of(element: Element) -> str:
    stated, parent = element.get(XSI_TYPE), element.getparent()
    if stated is None and feature_of(element) == "FailureModels":  # a list, or an entry in it
        is_entry = parent is not None and feature_of(parent) == "FailureModels"
        return "FailureModel" if is_entry else ""
    return local_name(stated or feature_of(element))


def _content(element: Element) -> list[tuple[str, list[tuple[str, str]]]]:
    """Return what an object says, without its own tag, Ids and maps, to compare copies."""
    parts = [
        (feature_of(e), sorted((str(k), str(v)) for k, v in e.attrib.items() if k != "Id"))
        for e in select(element, _CONTENT)
    ]
    return [("", parts[0][1]), *parts[1:]]


def _parameters(failure: Element) -> dict[str, Element]:
    query = '*[local-name()="FailureProbDistribution"]/*[local-name()="Parameters"]/*'
    return {each.get("name") or "": each for each in select(failure, query)}


def _child(element: Element, tag: str) -> Element | None:
    return next((child for child in element if feature_of(child) == tag), None)


class _Converter:
    def __init__(self, model: Element, file: str, places: Mapping[Element, Place]) -> None:
        self.file, self.places = file, places
        self.problems: list[Problem] = []
        self.unknown: dict[str, list[Element]] = {}  # elements that the tool does not write there
        self.origins: dict[Element, Place] = {}
        self.new: dict[Element, Element] = {}  # object of the file -> what it became
        # owner and feature -> objects of the file
        self.links: dict[tuple[Element, str], list[Element]] = {}
        self.failures: dict[object, Element] = {}  # identity -> first copy, which declares it
        self.homes: dict[Element, list[Element]] = {}  # failure model -> failures declared there
        self.states: dict[tuple[Element | None, str], list[Element]] = {}
        self.events: dict[tuple[Element, object], Element] = {}  # of trees, by identity
        # object, what it became, the failure model that it is in
        self.waiting: list[tuple[Element, Element, Element | None]] = []
        self._survey(model)
        tag = f"{{{_NAMESPACES['integration_']}}}DDIPackage"
        self.root = new_element(tag, namespaces=_NAMESPACES)
        self.origins[self.root] = self.place(model)
        parts = {name: _child(model, tag) for name, (tag, _) in _PACKAGES.items()}
        self.packages = {
            name: self._add(self.root, "odeProductPackages", model if part is None else part, name)
            for name, part in parts.items()
        }
        for name, part in parts.items():
            for item in part if part is not None else ():
                self._object(item, self.packages[name], _PACKAGES[name][1], None)
                self._convert()
        for package in self.packages.values():
            if not len(package):
                self.root.remove(package)
        references = References((self.root,))
        for (owner, feature), objects in self.links.items():
            ends = [self.new[each] for each in objects if each in self.new]
            if ends:
                owner.set(feature, " ".join(map(references.path, ends)))

    def place(self, element: Element) -> Place:
        """Return where an object stands in the file."""
        return self.places.get(element) or Place(self.file, line_of(element))

    def report(
        self, case: str, element: Element, /, hint: str | None = None, **fields: object
    ) -> None:
        self.problems.append(problem(case, self.place(element), hint=hint, **fields))

    def _survey(self, model: Element) -> None:
        """Find the declarations of states and failures, and elements that nobody knows."""
        names: dict[str, Element] = {}
        homes: dict[Element, Element] = {}
        for element in model.iter():
            tag, name, parent = feature_of(element), element.get("name") or "", element.getparent()
            if tag not in _KNOWN:
                self.unknown.setdefault(tag, []).append(element)
            elif tag == "State" and parent is not None and feature_of(parent) == "States":
                for machine in (parent.getparent(), None):
                    self.states.setdefault((machine, name), []).append(element)
            elif tag in _TAGS["failures"]:
                declared = self.failures.setdefault(self._identity(element), element)
                if declared is element and names.setdefault(name, element) is not element and name:
                    line = self.place(names[name]).line
                    self.report("X014.two_failures", element, name=name, line=line)
                self._compare(declared, element)
                if declared not in homes:
                    models = (a for a in element.iterancestors() if _class_of(a) in _TAGS["models"])
                    home = next(models, None)
                    if home is not None:
                        homes[declared] = home
                        self.homes.setdefault(home, []).append(declared)

    def all_problems(self) -> list[Problem]:
        for tag, elements in self.unknown.items():
            hint, number = did_you_mean(tag, _KNOWN - {tag}), len(elements)
            self.report("X006.no_element", elements[0], hint=hint, tag=tag, number=number)
        return self.problems

    def _identity(self, element: Element) -> object:
        """Return what a failure is known by: Ids count the objects of one run of the tool."""
        id_, name = element.get("Id") or "0", element.get("name")
        return (id_.strip("0") and id_, name) if name else element

    def _compare(self, declared: Element, copy: Element) -> None:
        """Warn of a copy that says something else; of two rates the worse is kept."""
        if copy is declared or len(copy.attrib) < 2 or _content(copy) == _content(declared):
            return
        kept = _parameters(declared)
        for name, parameter in _parameters(copy).items():
            if name in kept and name in _WORSE:
                try:
                    pair = [(float(e.get("value") or ""), e) for e in (kept[name], parameter)]
                except ValueError:  # reported where it is read
                    continue
                worst = _WORSE[name](pair, key=lambda each: each[0])[1]
                kept[name].set("value", worst.get("value") or "")
        name, line = copy.get("name") or "", self.place(declared).line
        self.report("X014.copy", copy, tag=feature_of(declared), name=name, line=line)

    def _add(self, parent: Element, feature: str, source: Element, class_name: str = "") -> Element:
        """Add an element that stands for an object of the file."""
        element = new_element(feature, parent)
        if class_name:
            element.set(XSI_TYPE, class_name)
        self.origins[element] = self.place(source)
        return element

    def _refer(self, owner: Element, feature: str, to: Element | None) -> None:
        if to is not None:
            self.links.setdefault((owner, feature), []).append(to)

    def _convert(self) -> None:
        """Take over what is waiting; no recursion, because models may be as deep as files."""
        while self.waiting:
            source, target, model = self.waiting.pop()
            before = len(self.waiting)
            for name, value in source.attrib.items():
                is_default = name == "isNegated" and value == "false"
                if not (str(name).startswith("{") or name == "Id" or is_default):
                    target.set(name, value)
            for child in source:
                self._feature(child, target, model)
            self.waiting[before:] = reversed(self.waiting[before:])

    def _feature(self, child: Element, target: Element, model: Element | None) -> None:
        tag = feature_of(child)
        feature = tag[:1].lower() + tag[1:]
        if tag == "keyValueMaps":
            self._maps(child, target)
        elif tag in _TAGS["objects"]:
            self._object(child, target, feature, model)
        elif tag in _TAGS["texts"]:
            target.set(feature, (child.text or "").strip())
        elif tag in _TAGS["lists"] and not (tag == "Causes" and child.getparent() is model):
            for item in child:
                if feature_of(item) in _TAGS["items"]:
                    self._object(item, target, feature, model)
                elif feature_of(item) in _KNOWN:
                    self.unknown.setdefault(feature_of(item), []).append(item)

    def _object(self, source: Element, owner: Element, feature: str, model: Element | None) -> None:
        """Take over an object, or a reference to what it is a copy of."""
        class_name = _class_of(source)
        if feature_of(source) in _TAGS["failures"]:
            if model is None or owner is not self.new.get(model):  # a list of declarations
                self._refer(owner, feature, self.failures[self._identity(source)])
            return
        if feature in ("fromState", "toState", "state"):
            self._refer(owner, feature, self._state(source, feature, model))
            return
        if class_name in ("Gate", "Cause") and model is not None:
            self._cause(source, class_name, owner, model)
            return
        logic = self.packages["failureLogic_:FailureLogicPackage"]
        home, type_ = (owner, feature), ""
        if class_name in _TAGS["models"]:
            home, type_, model = (logic, "failureModels"), f"failureLogic_:{class_name}", source
        elif class_name in _TAGS["actions"]:
            type_ = f"failureLogic_:{class_name}"
            home = (logic, "actions") if feature in _REFERRING else home
        elif class_name in _TAGS["events"]:
            type_, package = f"event_:{class_name}", self.packages["event_:EventPackage"]
            home = (package, "events") if feature in _REFERRING else home
        self.new[source] = target = self._add(*home, source, type_)
        if home[0] is not owner:
            self._refer(owner, feature, source)
        for failure in self.homes.get(source, ()):
            is_common = _class_of(failure) == "CommonCauseFailure"
            type_ = "failureLogic_:CommonCauseFailure" if is_common else ""
            self.new[failure] = self._add(target, "failures", failure, type_)
            self.waiting.append((failure, self.new[failure], model))
        self.waiting.append((source, target, model))

    def _cause(self, source: Element, class_name: str, owner: Element, tree: Element) -> None:
        """Take over a gate, or a basic event where it stands for the first time."""
        identity: object = source
        if class_name == "Cause":
            failure = _child(source, "Failure")
            identity = source.get("name") or source
            identity = identity if failure is None else self._identity(failure)
        first = self.events.setdefault((tree, identity), source)
        self._refer(owner, "topEvent" if owner is self.new[tree] else "causes", first)
        if first is source:
            type_ = "failureLogic_:Gate" if class_name == "Gate" else ""
            self.new[source] = self._add(self.new[tree], "causes", source, type_)
            self.waiting.append((source, self.new[source], tree))
            return
        known = [_content(action) for action in select(first, _ACTIONS)]
        for action in select(source, _ACTIONS):
            if _content(action) not in known:
                self._object(action, self.new[first], "actions", tree)

    def _state(self, copy: Element, feature: str, model: Element | None) -> Element | None:
        """Return the state that is meant: the one of this name, as in the tool."""
        is_machine = model is not None and _class_of(model) == "StateMachine"
        machine, name = model if is_machine else None, copy.get("name") or ""
        states = self.states.get((machine, name), [])
        if len(states) == 1:
            self._compare(states[0], copy)
            return states[0]
        known = [key for of, key in self.states if of is machine]
        hint = did_you_mean(name, known) if not states else "give each state a name of its own"
        number = len(states) or "no"
        self.report("X007.state", copy, hint=hint, feature=feature, name=name, number=number)
        return None

    def _maps(self, maps: Element, target: Element) -> None:
        for item in maps:
            key = _text(item, "key")
            extension = self._add(target, "keyValueMaps", item)
            extension.set("key", key)
            if key == "eddi.events":  # has several `EVENT`
                self.report("X031.dictionary", item, key=key)
            for entry in select(item, '*[local-name()="value"]/*/*[local-name()="item"]'):
                value = self._add(extension, "values", entry)
                value.set("tag", _text(entry, "key"))
                value.set("value", _text(entry, "value"))


def _text(item: Element, tag: str) -> str:
    texts: Iterator[str] = map(str, select(item, f'*[local-name()="{tag}"]/*/text()'))
    return "".join(texts).strip()

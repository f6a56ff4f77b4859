"""The files of EDDI-Editor, turned into the form of EMF that the readers of all kinds know.

It writes an object again in full wherever one refers to it: one becomes an element, its copies
references. A failure is known by Id and name, a state by its name; a basic event is its failure.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from eddi_scaffold.common.files import IMPORT
from eddi_scaffold.common.problems import Place, Problem, problem
from eddi_scaffold.eddi_xml.parsing import (
    XSI_TYPE,
    Element,
    feature_of,
    line_of,
    new_element,
    select,
    text_of,
)
from eddi_scaffold.eddi_xml.references import References
from eddi_scaffold.eddi_xml.vocabulary import METAMODEL, local_name

_TAGS = {role: frozenset(text.split()) for role, text in METAMODEL["eddi_editor"].items()}
_KNOWN = frozenset().union(*_TAGS.values())
_ROOT = "{http://www.deis-project.eu/ode/integration}DDIPackage"
_COMMON = "failureLogic_:CommonCauseFailure"
_LOGIC = "failureLogic_:FailureLogicPackage"
_PACKAGES = {  # class -> part of a model, feature of the package
    "architecture_:DesignPackage": ("SystemElements", "systems"),
    "event_:EventPackage": ("", "events"),
    _LOGIC: ("FailureModels", "failureModels"),
    "dependability_:HARAPackage": ("Hazards", "hazards"),
}
_HOMES = {  # role -> package and feature of what is referred to in EMF, and not contained
    "models": (_LOGIC, "failureModels"),
    "actions": (_LOGIC, "actions"),
    "events": ("event_:EventPackage", "events"),
}
_REFERRING = ("failureModels", "subModels", "onEntry", "onExit", "actions", "triggers", "evidence")
_WORSE = {"Failure Rate": max, "MTTF": min, "Unavailability": max}
_ACTIONS = '*[local-name()="Actions"]/*'
_CONTENT = 'descendant-or-self::*[not(ancestor-or-self::*[local-name()="keyValueMaps"])]'
_PARAMETERS = '*[local-name()="FailureProbDistribution"]/*[local-name()="Parameters"]/*'


def in_form_of_emf(
    model: Element, file: str, places: Mapping[Element, Place]
) -> tuple[Element | None, Mapping[Element, Place], list[Problem]] | None:
    """Return the root (none after an error), places and problems; ``None`` for other formats."""
    parts = {feature_of(child) for child in model} if feature_of(model) == "Model" else set()
    if "Perspectives" in parts:  # the root has the same name
        place = Place(file, line_of(model))
        return None, {}, [problem("F003.other", place, hint=IMPORT, other="an input of HiP-HOPS")]
    if parts.isdisjoint(part for part, _ in _PACKAGES.values() if part):
        return None
    converter = _Converter(model, file, places)
    return converter.root, converter.origins, converter.problems


def _is_list(element: Element) -> bool:
    """Return whether an element holds objects; in some lists they have the name of the list."""
    tag, parent = feature_of(element), element.getparent()
    return tag in _TAGS["lists"] and (parent is None or feature_of(parent) != tag)


def _class_of(element: Element) -> str:
    return "" if _is_list(element) else local_name(element.get(XSI_TYPE) or feature_of(element))


def _content(element: Element) -> tuple[object, ...]:
    """Return what an object says, without its own tag, Ids and maps, to compare copies."""
    parts = [
        (feature_of(e), *sorted((str(k), str(v)) for k, v in e.attrib.items() if k != "Id"))
        for e in select(element, _CONTENT)
    ]
    return parts[0][1:], *parts[1:]


def _child(element: Element, tag: str) -> Element | None:
    return next((child for child in element if feature_of(child) == tag), None)


class _Converter:
    def __init__(self, model: Element, file: str, places: Mapping[Element, Place]) -> None:
        self.file = file
        self.problems: list[Problem] = []
        self.origins = dict(places)  # also of what the file has, where it is no XML
        self.new: dict[Element, Element] = {}  # object of the file -> what it became
        # owner and feature -> objects of the file
        self.links: dict[tuple[Element, str], list[Element]] = defaultdict(list)
        self.failures: dict[object, Element] = {}  # identity -> first copy, which declares it
        self.homes: dict[Element, list[Element]] = {}  # failure model -> failures declared there
        self.states: dict[tuple[Element | None, str], list[Element]] = {}
        # the first of those that are one: events of a tree, actions of an event
        self.first: dict[tuple[Element, object], Element] = {}
        self.contents: dict[Element, object] = {}  # of declarations
        # object, what it became, the failure model that it is in
        self.waiting: deque[tuple[Element, Element, Element | None]] = deque()
        self._survey(model)
        self.root = new_element(_ROOT, None, {})
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
        for package in [each for each in self.root if not len(each)]:
            self.root.remove(package)
        references = References((self.root,))
        for (owner, feature), objects in self.links.items():
            ends = (self.new[each] for each in objects if each in self.new)
            owner.set(feature, " ".join(map(references.path, ends)))

    def place(self, element: Element) -> Place:
        """Return where an object stands in the file."""
        return self.origins.get(element) or Place(self.file, line_of(element))

    def report(self, case: str, element: Element, /, **fields: Any) -> None:
        self.problems.append(problem(case, self.place(element), **fields))

    def _survey(self, model: Element) -> None:
        """Find the declarations of states and failures, and elements that have no place."""
        names: dict[str, Element] = {}
        homed: set[Element] = set()
        strange: dict[tuple[str, str], list[Element]] = {}
        for element in model.iter():
            tag, name, parent = feature_of(element), element.get("name") or "", element.getparent()
            is_item = parent is not None and _is_list(parent)
            if tag not in _KNOWN or (is_item and tag not in _TAGS["items"]):
                is_lost = is_item or (parent is not None and feature_of(parent) == "FaultTree")
                case = "X011.no_element" if is_lost else "X006.no_element"
                strange.setdefault((case, tag), []).append(element)
            elif tag == "State" and parent is not None and feature_of(parent) == "States":
                for machine in (parent.getparent(), None):
                    self.states.setdefault((machine, name), []).append(element)
            elif tag in _TAGS["failures"]:
                declared = self.failures.setdefault(self._identity(element), element)
                if declared is element and names.setdefault(name, element) is not element and name:
                    line = self.place(names[name]).line
                    self.report("X014.two_failures", element, name=name, line=line)
                self._compare(declared, element)
                models = (a for a in element.iterancestors() if _class_of(a) in _TAGS["models"])
                if declared not in homed and (home := next(models, None)) is not None:
                    homed.add(declared)
                    self.homes.setdefault(home, []).append(declared)
        for (case, tag), elements in strange.items():
            self.report(case, elements[0], tag=tag, number=len(elements))

    def _identity(self, element: Element) -> object:
        """Return what a failure, or a cause without one, is known by: Ids may be used again."""
        id_, name = element.get("Id") or "0", element.get("name")
        id_ = "" if feature_of(element) == "Cause" else id_.strip("0") and id_
        return (id_, name) if name else element

    def _compare(self, declared: Element, copy: Element) -> None:
        """Warn of a copy that says something else; of two rates the worse is kept."""
        if copy is declared or len(copy.attrib) < 2:  # a copy of JSON has only a name
            return
        if declared not in self.contents:
            self.contents[declared] = _content(declared)
        if self.contents[declared] == _content(copy):
            return
        kept = {each.get("name"): each for each in select(declared, _PARAMETERS)}
        for parameter in select(copy, _PARAMETERS):
            name = parameter.get("name")
            if name in kept and name in _WORSE:
                texts = [each.get("value") or "" for each in (kept[name], parameter)]
                with suppress(ValueError):  # reported where it is read
                    kept[name].set("value", _WORSE[name](texts, key=float))
        name, line = copy.get("name") or "", self.place(declared).line
        self.report("X014.copy", copy, tag=feature_of(declared), name=name, line=line)

    def _add(self, parent: Element, feature: str, source: Element, class_name: str = "") -> Element:
        """Add an element that stands for an object of the file."""
        element = new_element(feature, parent, {XSI_TYPE: class_name} if class_name else {})
        self.origins[element] = self.place(source)
        return element

    def _convert(self) -> None:
        """Take over what is waiting; no recursion, because models may be as deep as files."""
        while self.waiting:
            source, target, model = self.waiting.popleft()
            for name, value in source.attrib.items():
                is_left_out = name == "Id" or (name, value) == ("isNegated", "false")
                if not (str(name).startswith("{") or is_left_out):
                    target.set(name, value)
            for child in source:
                self._feature(child, target, model)

    def _feature(self, child: Element, target: Element, model: Element | None) -> None:
        tag = feature_of(child)
        feature = tag[:1].lower() + tag[1:]
        if tag == "keyValueMaps":
            self._maps(child, target)
        elif tag in _TAGS["objects"]:
            self._object(child, target, feature, model)
        elif tag in _TAGS["texts"]:
            target.set(feature, (child.text or "").strip())
        elif tag in _TAGS["lists"] and (tag, target.tag) != ("Causes", "failureModels"):
            for item in child:
                if feature_of(item) in _TAGS["items"]:
                    self._object(item, target, feature, model)

    def _object(self, source: Element, owner: Element, feature: str, model: Element | None) -> None:
        """Take over an object, or a reference to what it is a copy of."""
        class_name = _class_of(source)
        if feature_of(source) in _TAGS["failures"]:
            if model is None or owner is not self.new.get(model):  # a list of declarations
                self.links[owner, feature].append(self.failures[self._identity(source)])
            return
        if feature in ("fromState", "toState", "state"):
            self._state(source, owner, feature, model)
            return
        if class_name in ("Gate", "Cause") and model is not None:
            self._cause(source, class_name, owner, model)
            return
        role = next((role for role in _HOMES if class_name in _TAGS[role]), "")
        package, home = _HOMES.get(role, ("", ""))
        type_ = f"{package.partition(':')[0]}:{class_name}" if role else ""
        parent = self.packages[package] if role and feature in _REFERRING else owner
        if parent is not owner:
            self.links[owner, feature].append(source)
            feature = home
        model = source if role == "models" else model
        self.new[source] = target = self._add(parent, feature, source, type_)
        for failure in self.homes.get(source, ()):
            type_ = _COMMON if _class_of(failure) == "CommonCauseFailure" else ""
            self.new[failure] = self._add(target, "failures", failure, type_)
            self.waiting.append((failure, self.new[failure], model))
        self.waiting.append((source, target, model))

    def _cause(self, source: Element, class_name: str, owner: Element, tree: Element) -> None:
        """Take over a gate, or a basic event where it stands for the first time."""
        first, failure = source, _child(source, "Failure")
        if class_name == "Cause":
            identity = self._identity(source if failure is None else failure)
            first = self.first.setdefault((tree, identity), source)
        self.links[owner, "topEvent" if owner is self.new[tree] else "causes"].append(first)
        if first is source:
            type_ = "failureLogic_:Gate" if class_name == "Gate" else ""
            self.new[source] = self._add(self.new[tree], "causes", source, type_)
            self.waiting.append((source, self.new[source], tree))
        for action in select(source, _ACTIONS):
            if self.first.setdefault((first, _content(action)), action) is action:
                self._object(action, self.new[first], "actions", tree)

    def _state(self, copy: Element, owner: Element, feature: str, model: Element | None) -> None:
        """Refer to the state that is meant: the one of this name, as in the tool."""
        is_machine = model is not None and _class_of(model) == "StateMachine"
        machine, name = model if is_machine else None, copy.get("name") or ""
        states = self.states.get((machine, name), [])
        self.links[owner, feature] += states[:1]
        if len(states) == 1:
            self._compare(states[0], copy)
            return
        self.report("X007.state", copy, feature=feature, name=name, number=len(states) or "no")

    def _maps(self, maps: Element, target: Element) -> None:
        for item in maps:
            key = text_of(item[0]).strip() if len(item) else ""
            if key == "eddi.events":  # has several `EVENT`
                self.report("X031.dictionary", item, key=key)
                continue
            extension = self._add(target, "keyValueMaps", item)
            extension.set("key", key)
            for entry in select(item, '*[local-name()="value"]/*/*[local-name()="item"]'):
                value = self._add(extension, "values", entry)
                for name, part in zip(("tag", "value"), entry, strict=False):
                    value.set(name, text_of(part).strip())

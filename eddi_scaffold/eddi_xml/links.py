"""What is linked with elements of monitored models: hazards, requirements, events, claims.

A link leads from an element of a monitored model to what it refers to, what refers to it or to
that, and so on, and what all of these refer to. Elements of the design do not count: a system would
link everything with everything.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import product
from typing import Any, NamedTuple

from eddi_scaffold.common.problems import Place
from eddi_scaffold.eddi_xml import vocabulary as names
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.eddi_xml.extensions import Observed
from eddi_scaffold.eddi_xml.parsing import Element, feature_of
from eddi_scaffold.eddi_xml.vocabulary import fold, local_name

_DESIGN = frozenset({"architecturepackage", "consertpackage", "ddipackage", "designpackage"})
"""Packages whose elements are no ends of links."""
_TEXTS = frozenset({"content", "description", "gid", "id", "key", "name", "tag", "value"})
"""Attributes that refer to nothing."""
_MAPS = "keyvaluemaps"
_TRACE = {"odeelement", "sacmelement"}
_MOST = 100  # links of one element; an EDDI in which everything refers to everything has more
_STEPS = 1_000_000
"""Along references, for all elements together: a broken file may have no end of them."""


class Link(NamedTuple):
    """An element that nothing monitors by itself, and that is linked with one that is monitored."""

    class_name: str  # its class as the file states it, or the feature that it is in
    name: str  # its name, or else its `gid`
    path: str  # canonical fragment path
    line: int | None  # of its element

    def as_json(self) -> dict[str, str | int | None]:
        """Return the form in which a package remembers it."""
        return {"class": self.class_name, "name": self.name, "path": self.path, "line": self.line}


class Linked(NamedTuple):
    """An element of a monitored model with its links."""

    element: str  # what it is: the feature that it is in, or the tag of a value (`event`)
    id: str  # its name
    line: int | None  # of it
    links: tuple[Link, ...]  # the nearest first
    is_cut: bool = False  # there are more

    def as_json(self) -> dict[str, Any]:
        """Return the form in which a package remembers it."""
        return {
            "element": self.element,
            "id": self.id,
            "line": self.line,
            "links": [link.as_json() for link in self.links],
            **({"cut": True} if self.is_cut else {}),
        }


Links = Mapping[str, Linked]  # path of an element of a monitored model -> what is linked with it
_Edges = dict[str, dict[str, Element]]


def links_of(document: EddiDocument, observed: Observed | None = None) -> Links:
    """Return the links of all monitored elements that have some."""
    return dict(_LinkGraph(document, observed or Observed(document)).linked())


def events_of(links: Links, id_: str) -> tuple[str, ...]:
    """Return the events that an element is linked with, each with its condition, for people."""
    own = [link for linked in links.values() if linked.id == id_ for link in linked.links]
    return tuple(link.name for link in own if fold(link.class_name).endswith(("event", "events")))


def links_in(document: EddiDocument, place: Place, links: Links) -> Links:
    """Return the links of what is in the element that a model (or its cause) was read from."""
    element = document.references.at(place.path) if links and place.path else None
    while element is not None and not document.is_monitored(element):
        parent = element.getparent()
        if parent is None or fold(feature_of(element)) == _MAPS:
            break
        element = parent
    if element is None:
        return {}
    own = document.references.path(element)
    return {path: linked for path, linked in links.items() if f"{path}/".startswith(f"{own}/")}


class _LinkGraph:
    def __init__(self, document: EddiDocument, observed: Observed) -> None:
        self._document = document
        self._references = document.references
        self._path = self._references.path
        self._models: list[Element] = []
        # Path -> path and element of each that refers to it; to which it refers.
        self._referring: _Edges = defaultdict(dict)
        self._referred: _Edges = defaultdict(dict)
        # Path -> paths whose links are its own: of a cause its failure, of evidence its event.
        self._stands_for = {path: list(events) for path, events in observed.events.items()}
        self._packages: dict[Element, str | None] = {}
        self._budget = _STEPS
        for root in document.roots:
            self._visit(root)
        for owner, by, _ in observed.by:
            if self._is_end(owner):
                self._referring[by][self._path(owner)] = owner
            else:
                self._stands_for.setdefault(self._path(owner), []).append(by)
        for model in self._models if self._referring or self._referred else ():
            for cause in document.children(model, names.CAUSES):
                failures, _, _ = document.targets(cause, names.FAILURE)
                if not failures and cause.get("name"):
                    own = document.children(model, names.FAILURES)
                    failures = [f for f in own if f.get("name") == cause.get("name")]
                for failure in failures[:1]:
                    self._stands_for.setdefault(self._path(cause), []).append(self._path(failure))

    def linked(self) -> Iterator[tuple[str, Linked]]:
        """Yield path and links of each monitored element that has some."""
        for path in dict.fromkeys([*self._referring, *self._referred, *self._stands_for]):
            start = self._references.at(path)
            if start is None or self._package(start) is not None:
                continue
            ends = self._ends(path)
            if ends:
                feature = fold(feature_of(start)).removesuffix("s").removeprefix("runtime")
                name = self._document.name_of(start)
                if feature == "value":  # of a map of events: the name stands first
                    feature = (start.get("tag") or feature).lower()
                    name = (start.get("value") or "").lstrip().partition(" ")[0].partition("(")[0]
                line, links = self._document.place(start).line, tuple(map(self._link, ends))
                is_cut = len(ends) >= _MOST or self._budget < 0
                yield path, Linked(feature, name, line, links, is_cut)

    def _link(self, element: Element) -> Link:
        place, condition = self._document.place(element), element.get("condition")
        class_name = local_name(self._document.class_or_feature(element))
        name = self._document.name_of(element) or element.get("gid") or ""
        if condition and fold(class_name).endswith("event"):  # for people: nothing evaluates it
            name += f" ({condition})"
        return Link(class_name, name, place.path or "/", place.line)

    def _visit(self, root: Element) -> None:
        waiting = [root]
        while waiting:
            element = waiting.pop()
            if self._document.is_monitored(element):
                self._models.append(element)
                for part in element.iterchildren():
                    for inner in part.iter():
                        targets = dict(self._targets(inner))
                        ends = [end for ends in targets.values() for end in ends]
                        if ends:  # what is known of a node, or wanted, is the node's
                            self._connect(targets.get("node", [part]), ends)
                continue
            waiting += reversed(element)
            targets = dict(self._targets(element))
            if targets.keys() == _TRACE:
                # A trace is a link between two elements without a name of its own.
                ours, others = (targets[name] for name in sorted(targets))
                self._connect(ours, others)
                self._connect(others, ours)
                continue
            if not targets or not self._is_end(element):
                continue
            if "source" in targets and "target" in targets:
                # a relation: what it leads to rests on where it begins
                owners = map(self._owner, targets.pop("target"))
                for source, owner in product(targets.pop("source"), owners):
                    self._referring[self._path(source)][self._path(owner)] = owner
            ends = [end for ends in targets.values() for end in ends]
            self._connect([self._owner(element)], ends)

    def _connect(self, starts: Iterable[Element], ends: Sequence[Element]) -> None:
        """Note that elements refer to others, as far as either is an end of links."""
        for start, end in product(starts, ends):
            if self._is_end(end):
                self._referred[self._path(start)][self._path(end)] = end
            if self._is_end(start):
                self._referring[self._path(end)][self._path(start)] = start

    def _targets(self, element: Element) -> Iterator[tuple[str, list[Element]]]:
        for key, value in element.attrib.items():
            name, tokens = str(key), [token.removeprefix("#") for token in str(value).split()]
            if name.startswith("{") or fold(name) in _TEXTS:
                continue
            ends: list[Element] = []
            for token in tokens:
                if "/@" not in token:
                    ends += self._references.by_id(token)
                elif (end := self._references.at(token)) is not None:
                    ends.append(end)
            if ends:
                yield fold(local_name(name)), ends

    def _ends(self, start: str) -> list[Element]:
        first = [start]
        for path in first:
            first += [other for other in self._stands_for.get(path, ()) if other not in first]
        ends: dict[str, Element] = {}
        for path in first:
            ends |= self._referred.get(path, {})
        self._follow(self._referring, [*first, *ends], ends)
        self._follow(self._referred, list(ends), ends)
        return [element for path, element in ends.items() if path not in first]

    def _follow(self, edges: _Edges, waiting: list[str], ends: dict[str, Element]) -> None:
        for start in waiting:
            for path, element in edges.get(start, {}).items():
                self._budget -= 1
                if len(ends) >= _MOST or self._budget < 0:
                    return
                if path not in ends and self._is_end(element):
                    ends[path] = element
                    waiting.append(path)

    def _is_end(self, element: Element) -> bool:
        """Tell whether an element is neither of a monitored model nor of the design."""
        is_package = self._document.is_package(element)
        return not is_package and self._package(element) not in {None, *_DESIGN}

    def _package(self, element: Element) -> str | None:
        """Return the class of the package that an element is in, ``None`` for one of a model."""
        if element not in self._packages:
            parent = element.getparent()
            package: str | None = ""
            if self._document.is_root(element) or self._document.is_package(element):
                package = self._document.class_of(element).name
            elif fold(feature_of(element)) == _MAPS or self._document.is_monitored(element):
                package = None
            elif parent is not None:
                package = self._package(parent)
            self._packages[element] = package
        return self._packages[element]

    def _owner(self, element: Element) -> Element:
        owner = element
        while not (owner.get("name") or owner.get("gid")):
            parent = owner.getparent()
            if parent is None or self._document.is_package(parent):
                return owner
            owner = parent
        return owner

"""What is linked with elements of monitored models: hazards, requirements, events, claims.

A link leads from an element of a model that a monitor is made of to one that nothing monitors by
itself: what it refers to, what refers to it or to that, what refers to these in turn, and what all
of these refer to. The elements of the design do not count: a system would link everything with
everything.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from eddi_scaffold.eddi_xml import vocabulary as word
from eddi_scaffold.eddi_xml.observers import Observed
from eddi_scaffold.eddi_xml.parsing import feature_of
from eddi_scaffold.eddi_xml.references import References, parse_fragment
from eddi_scaffold.eddi_xml.survey import MONITORED, kind_of_model, name_of
from eddi_scaffold.eddi_xml.vocabulary import fold, local_name

if TYPE_CHECKING:
    from eddi_scaffold.common.problems import Place
    from eddi_scaffold.eddi_xml.document import EddiDocument
    from eddi_scaffold.eddi_xml.parsing import Element

    _Edges = dict[str, dict[str, Element]]

_DESIGN = frozenset({"architecturepackage", "consertpackage", "ddipackage", "designpackage"})
"""Packages whose elements are no ends of links."""
_TEXTS = frozenset({"content", "description", "gid", "id", "key", "name", "tag", "value"})
"""Attributes that refer to nothing."""
_TRACE = {"odeelement", "sacmelement"}
_MOST = 100
"""Links of one element; an EDDI in which everything refers to everything has more."""
_STEPS = 1_000_000
"""Along references, for all elements together: a broken file may have no end of them."""


@dataclass(frozen=True)
class Link:
    """An element that nothing monitors by itself, and that is linked with one that is monitored.

    Attributes:
        class_name: its class as the file states it, or the feature that it is in.
        name: its name, or else its ``gid``.
        path: canonical fragment path.
        line: of its element.
    """

    class_name: str
    name: str
    path: str
    line: int | None

    def as_json(self) -> dict[str, str | int | None]:
        """Return the form in which a package remembers it."""
        return {
            "class": self.class_name,
            "name": self.name,
            "path": self.path,
            "line": self.line,
        }


@dataclass(frozen=True)
class Linked:
    """An element of a monitored model with its links.

    Attributes:
        element: what it is: the feature that it is in, or the tag of a value (``event``).
        id: its name.
        line: of it.
        links: the nearest first.
        is_cut: there are more.
    """

    element: str
    id: str
    line: int | None
    links: tuple[Link, ...]
    is_cut: bool = False

    def as_json(self) -> dict[str, str | int | list[dict[str, str | int | None]] | None]:
        """Return the form in which a package remembers it."""
        return {
            "element": self.element,
            "id": self.id,
            "line": self.line,
            "links": [link.as_json() for link in self.links],
            **({"cut": True} if self.is_cut else {}),
        }


Links = Mapping[str, Linked]
"""Path of an element of a monitored model -> what is linked with it."""


def links_of(document: EddiDocument, found: Observed | None = None) -> Links:
    """Return the links of all monitored elements that have some."""
    return dict(_LinkGraph(document, found or Observed(document)).ends())


def events_of(links: Links, id_: str) -> tuple[str, ...]:
    """Return the events that an element is linked with, each with its condition, for people."""
    found = [link for one in links.values() if one.id == id_ for link in one.links]
    return tuple(one.name for one in found if fold(one.class_name).endswith(("event", "events")))


def links_in(document: EddiDocument, place: Place, links: Links) -> Links:
    """Return the links of one model: of what lies in the element that it was read from.

    Args:
        document: the EDDI.
        place: of the model; of a fault tree, that of one of its causes.
        links: of the whole document.
    """
    element = document.at(place.path) if links and place.path else None
    while element is not None and kind_of_model(document, element) not in MONITORED:
        parent = element.getparent()
        if parent is None or fold(feature_of(element)) == "keyvaluemaps":
            break
        element = parent
    if element is None:
        return {}
    own = document.references.path(element)
    return {path: link for path, link in links.items() if f"{path}/".startswith(f"{own}/")}


def _linked(
    document: EddiDocument, start: Element, found: Sequence[Element], *, is_cut: bool
) -> Linked:
    what = fold(feature_of(start)).removesuffix("s").removeprefix("runtime")
    name = name_of(document, start)
    if what == "value":  # of a map of events: the name stands first in the declaration
        what = (start.get("tag") or what).lower()
        name = (start.get("value") or "").lstrip().partition(" ")[0].partition("(")[0]
    links = tuple(_link(document, one) for one in found)
    return Linked(what, name, document.place(start).line, links, is_cut)


def _link(document: EddiDocument, element: Element) -> Link:
    place = document.place(element)
    stated = document.class_of(element).printed or feature_of(element)
    name = name_of(document, element) or element.get("gid") or ""
    condition = element.get("condition")
    if condition and fold(local_name(stated)).endswith("event"):  # for people: nothing evaluates it
        name += f" ({condition})"
    return Link(local_name(stated), name, place.path or "/", place.line)


class _LinkGraph:
    """Which elements of an EDDI refer to which.

    Args:
        document: the EDDI.
        found: what says in it by which monitor it is observed.
    """

    def __init__(self, document: EddiDocument, found: Observed) -> None:
        self._document = document
        self._references = References(document.roots)  # must not disturb a reader's remarks
        self._models: list[Element] = []
        self._into: _Edges = {}
        """Path -> path and element of each that refers to it."""
        self._out: _Edges = {}
        """Path -> path and element of each that it refers to; also of elements of models."""
        self._stands_for: dict[str, list[str]] = {path: list(e) for path, e in found.events.items()}
        """Path -> paths whose links are its own: of a cause its failure, of evidence its event."""
        self._packages: dict[Element, str | None] = {}
        self._budget = _STEPS
        for root in document.roots:
            self._visit(root)
        for owner, by, _ in found.by:
            if self._is_end(owner):
                self._refer(owner, by)
            else:
                self._stands_for.setdefault(self._path(owner), []).append(by)
        for model in self._models if self._into or self._out else ():
            for cause in document.children(model, word.CAUSES):
                self._name_failure(model, cause)

    def ends(self) -> Iterator[tuple[str, Linked]]:
        """Yield path and links of each monitored element that has some."""
        for path in dict.fromkeys([*self._into, *self._out, *self._stands_for]):
            start = self._document.at(path)
            if start is not None and self._is_monitored(start):
                found = self._ends(path)
                if found:
                    is_cut = len(found) >= _MOST or self._budget < 0
                    yield path, _linked(self._document, start, found, is_cut=is_cut)

    def _visit(self, root: Element) -> None:
        """Note what refers to what outside of the monitored models."""
        waiting = [root]
        while waiting:
            element = waiting.pop()
            if kind_of_model(self._document, element) in MONITORED:
                self._models.append(element)
                self._visit_model(element)
                continue
            waiting += reversed(element)
            targets = dict(self._targets(element))
            if targets.keys() == _TRACE:
                self._trace(*(targets[name] for name in sorted(targets)))
                continue
            if not targets or not self._is_end(element):
                continue
            if "source" in targets and "target" in targets:
                # a relation: what it leads to rests on where it begins
                sources = targets.pop("source")
                for target in targets.pop("target"):
                    for source in sources:
                        self._refer(self._owner(target), self._path(source))
            owner = self._owner(element)
            for end in [end for ends in targets.values() for end in ends]:
                self._refer(owner, self._path(end))
                self._link(owner, [end] if self._is_end(end) else [])

    def _visit_model(self, model: Element) -> None:
        """Note what the parts of a model refer to outside of all models."""
        for part in model.iterchildren():
            for element in part.iter():
                targets = dict(self._targets(element))
                found = [end for ends in targets.values() for end in ends if self._is_end(end)]
                for start in targets.get("node", [part]):  # what is known of a node, or wanted
                    self._link(start, found)

    def _trace(self, ours: Sequence[Element], others: Sequence[Element]) -> None:
        """Note a trace, which is a link between two elements without a name of its own."""
        for start, ends in [*((our, others) for our in ours), *((other, ours) for other in others)]:
            self._link(start, [end for end in ends if self._is_end(end)])
            for end in ends if self._is_end(start) else ():
                self._refer(start, self._path(end))

    def _link(self, start: Element, ends: Sequence[Element]) -> None:
        for end in ends:
            self._out.setdefault(self._path(start), {})[self._path(end)] = end

    def _name_failure(self, model: Element, cause: Element) -> None:
        failures, _, _ = self._document.targets(cause, word.FAILURE)
        if not failures and cause.get("name"):
            same = self._document.children(model, word.FAILURES)
            failures = [one for one in same if one.get("name") == cause.get("name")]
        if failures:
            self._stands_for.setdefault(self._path(cause), []).append(self._path(failures[0]))

    def _targets(self, element: Element) -> Iterator[tuple[str, list[Element]]]:
        """Yield the features of an element that refer to others, by path or by ``xmi:id``."""
        for key, value in element.attrib.items():
            name, tokens = str(key), [token.removeprefix("#") for token in str(value).split()]
            if name.startswith("{") or fold(name) in _TEXTS:
                continue
            found = [end for token in tokens for end in self._end(token)]
            if found:
                yield fold(local_name(name)), found

    def _end(self, token: str) -> Sequence[Element]:
        if "/@" not in token:
            return self._references.by_id(token)
        fragment = parse_fragment(token)
        end = self._references.resolve(fragment) if fragment is not None else None
        return () if end is None else (end,)

    def _refer(self, owner: Element, to: str) -> None:
        self._into.setdefault(to, {})[self._path(owner)] = owner

    def _ends(self, start: str) -> list[Element]:
        """Return what is linked with an element, the nearest first."""
        first = {start: start}
        for path in (waiting := [start]):
            new = [one for one in self._stands_for.get(path, ()) if one not in first]
            first.update(zip(new, new, strict=True))
            waiting += new
        found: dict[str, Element] = {}
        for path in list(first):
            found |= self._out.get(path, {})
        self._follow(self._into, [*first, *found], found)
        self._follow(self._out, list(found), found)
        return [element for path, element in found.items() if path not in first]

    def _follow(
        self,
        edges: Mapping[str, Mapping[str, Element]],
        start: list[str],
        found: dict[str, Element],
    ) -> None:
        waiting = deque(start)
        while waiting:
            for path, element in edges.get(waiting.popleft(), {}).items():
                self._budget -= 1
                if len(found) >= _MOST or self._budget < 0:
                    return
                if path not in found and self._is_end(element):
                    found[path] = element
                    waiting.append(path)

    def _is_end(self, element: Element) -> bool:
        """Tell whether an element is neither of a monitored model nor of the design."""
        return not self._document.is_package(element) and self._package(element) not in {
            None,
            *_DESIGN,
        }

    def _is_monitored(self, element: Element) -> bool:
        return self._package(element) is None

    def _package(self, element: Element) -> str | None:
        """Return the class of the package that an element is in, None for one of a model."""
        if element not in self._packages:
            self._packages[element] = self._package_around(element)
        return self._packages[element]

    def _package_around(self, element: Element) -> str | None:
        if self._document.is_root(element) or self._document.is_package(element):
            return self._document.class_of(element).name
        is_map = fold(feature_of(element)) == "keyvaluemaps"
        if is_map or kind_of_model(self._document, element) in MONITORED:
            return None
        parent = element.getparent()
        return self._package(parent) if parent is not None else ""

    def _owner(self, element: Element) -> Element:
        """Return the element with a name that a nested one belongs to."""
        owner = element
        while not (owner.get("name") or owner.get("gid")):
            parent = owner.getparent()
            if parent is None or self._document.is_package(parent):
                return owner
            owner = parent
        return owner

    def _path(self, element: Element) -> str:
        return self._references.path(element)

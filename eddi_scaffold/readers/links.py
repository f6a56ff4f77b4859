"""What is linked with elements of monitored models: hazards, requirements, events, claims.

A link leads from an element of a model that a monitor is made of to one that nothing monitors by
itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from eddi_scaffold.readers.link_graph import Ends, LinkGraph
from eddi_scaffold.readers.monitored_by import Observed, observed
from eddi_scaffold.readers.spelling import fold, local_name
from eddi_scaffold.readers.survey import MONITORED, kind_of_model, name_of
from eddi_scaffold.readers.xmi import feature_of

if TYPE_CHECKING:
    from eddi_scaffold.problems import Place
    from eddi_scaffold.readers.document import EddiDocument
    from eddi_scaffold.readers.xmi import Element


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
            "links": [one.as_json() for one in self.links],
            **({"cut": True} if self.is_cut else {}),
        }


Links = Mapping[str, Linked]
"""Path of an element of a monitored model -> what is linked with it."""


def links_of(document: EddiDocument, found: Observed | None = None) -> Links:
    """Return the links of all monitored elements that have some."""
    graph = LinkGraph(document, found or observed(document))
    return {path: _linked(document, ends) for path, ends in graph.ends()}


def events_of(links: Links, id_: str) -> tuple[str, ...]:
    """Return the events that an element is linked with, each with its condition, for people."""
    found = [link for one in links.values() if one.id == id_ for link in one.links]
    return tuple(one.name for one in found if one.class_name.casefold().endswith("event"))


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
    return {path: one for path, one in links.items() if f"{path}/".startswith(f"{own}/")}


def _linked(document: EddiDocument, ends: Ends) -> Linked:
    start = ends.start
    what = fold(feature_of(start)).removesuffix("s").removeprefix("runtime")
    name = name_of(document, start)
    if what == "value":  # of a map of events: the name stands first in the declaration
        what = (start.get("tag") or what).lower()
        name = (start.get("value") or "").lstrip().partition(" ")[0].partition("(")[0]
    links = tuple(_link(document, one) for one in ends.found)
    return Linked(what, name, document.place(start).line, links, ends.is_cut)


def _link(document: EddiDocument, element: Element) -> Link:
    place = document.place(element)
    stated = document.class_of(element).printed or feature_of(element)
    name = name_of(document, element) or element.get("gid") or ""
    condition = element.get("condition")
    if condition and fold(local_name(stated)).endswith("event"):  # for people: nothing evaluates it
        name += f" ({condition})"
    return Link(local_name(stated), name, place.path or "/", place.line)

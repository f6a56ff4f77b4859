"""References between elements of XMI: the fragment paths of EMF, parsed, resolved and written.

``//@a.0/@b.3`` is entry 3 of feature ``b`` of entry 0 of feature ``a`` of the root. The index
counts the children of that feature only.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

from eddi_scaffold.eddi_xml.parsing import Element, feature_of, select
from eddi_scaffold.eddi_xml.vocabulary import fold

_FRAGMENT = re.compile(
    r"(?=/)(?:/{1,2}(?!@)([0-9]{1,9})?|/)?((?:/@[^\W\d][\w-]*(?:\.[0-9]{1,9})?)*)/?"
)
_DEEPEST = 256  # the depth of a file that the parser reads: a longer path points at nothing


class Fragment(NamedTuple):
    """A parsed fragment path."""

    root: int  # which root, 0 where there is one only
    segments: str  # `/@a.0/@b.3`, as written


def parse_fragment(text: str) -> Fragment | None:
    """Parse a fragment path; ``None`` when it is none."""
    match = _FRAGMENT.fullmatch(text)
    return Fragment(int(match.group(1) or 0), match.group(2)) if match else None


class _Children:
    def __init__(self, parent: Element) -> None:
        self.by_name: dict[str, list[Element]] = {}
        for child in parent.iterchildren():
            self.by_name.setdefault(feature_of(child), []).append(child)

    @cached_property
    def by_folded(self) -> dict[str, list[Element]]:
        folded: dict[str, list[Element]] = {}
        for name, group in self.by_name.items():
            folded.setdefault(fold(name), []).extend(group)
        return folded

    @cached_property
    def segments(self) -> dict[Element, str]:
        return {
            child: f"/@{name}.{index}"
            for name, group in self.by_name.items()
            for index, child in enumerate(group)
        }


class References:
    """Resolves references in one document, with an index of children and a table of paths."""

    def __init__(self, roots: Sequence[Element]) -> None:
        self._roots = tuple(roots)
        self._root_index = {root: index for index, root in enumerate(self._roots)}
        self._index: dict[Element, _Children] = {}
        self._resolved: dict[tuple[int, str], Element] = {}
        self._paths: dict[Element, str] = {}

    def children(self, parent: Element, *folded: str) -> list[Element]:
        """Return the children in the features with these folded names, in document order."""
        groups = [g for name in folded if (g := self._children(parent).by_folded.get(name))]
        if len(groups) < 2:
            return groups[0] if groups else []
        chosen = {child for group in groups for child in group}
        return [child for child in parent.iterchildren() if child in chosen]

    def path(self, element: Element) -> str:
        """Return the canonical path: each segment with its index, no slash at the end."""
        trail: list[Element] = []
        while element not in self._paths and element not in self._root_index:
            parent = element.getparent()
            if parent is None:  # the xmi:XMI element above the roots
                return "/"
            trail.append(element)
            element = parent
        path = self._paths.get(element, "/")
        if element in self._root_index and len(self._roots) > 1:
            path = f"/{self._root_index[element]}"
        for child in reversed(trail):
            path += self._children(element).segments[child]
            self._paths[child] = path
            element = child
        return path

    def at(self, path: str) -> Element | None:
        """Return the element that the text of a path points at, ``None`` when there is none."""
        fragment = parse_fragment(path)
        return self.resolve(fragment) if fragment is not None else None

    def resolve(self, fragment: Fragment) -> Element | None:
        """Return the element that a path points at, ``None`` when there is none."""
        root, head = fragment
        if root >= len(self._roots) or head.count("/@") > _DEEPEST:
            return None
        missing = []
        element = self._resolved.get(fragment)
        while element is None and head:
            head, _, last = head.rpartition("/@")
            missing.append(last)
            element = self._resolved.get((root, head))
        element = self._roots[root] if element is None else element
        for segment in reversed(missing):
            child = self._step(element, segment)
            if child is None:
                return None
            head = f"{head}/@{segment}"
            # Leaves are asked for once or twice; only what has children is worth a table entry.
            if len(child):
                self._resolved[root, head] = child
            element = child
        return element

    def by_id(self, xmi_id: str) -> Sequence[Element]:
        """Return the elements with an ``xmi:id``: one, unless the file is damaged."""
        return self._ids.get(xmi_id, ())

    def explain(self, fragment: Fragment) -> str:
        """Explain why a path points at nothing: the first segment that fails."""
        if fragment.root >= len(self._roots):
            return f"the file has no root {fragment.root}"
        element, segments = self._roots[fragment.root], fragment.segments.split("/@")[1:]
        while (child := self._step(element, segments[0])) is not None and segments[1:]:
            element, segments = child, segments[1:]
        return f'{self.path(element)} has no "{segments[0]}"'

    @cached_property
    def _ids(self) -> dict[str, list[Element]]:
        ids: dict[str, list[Element]] = {}
        query = 'descendant-or-self::*[@*[local-name()="id" and contains(namespace-uri(), "XMI")]]'
        for element in (element for root in self._roots for element in select(root, query)):
            for key, value in element.attrib.items():
                if str(key).endswith("}id"):
                    ids.setdefault(str(value), []).append(element)
        return ids

    def _children(self, parent: Element) -> _Children:
        entry = self._index.get(parent)
        if entry is None:
            entry = self._index[parent] = _Children(parent)
        return entry

    def _step(self, parent: Element, segment: str) -> Element | None:
        # from behind: an element that EMF did not write may have points in its name
        name, point, digits = segment.rpartition(".")
        name, index = (name, int(digits)) if point and digits.isdecimal() else (segment, 0)
        children = self._children(parent)
        exact = children.by_name.get(name, ())
        if index < len(exact):
            return exact[index]
        similar = children.by_folded.get(fold(name), ())
        return similar[index] if index < len(similar) else None

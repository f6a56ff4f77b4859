"""References between elements of XMI: the fragment paths of EMF, parsed, resolved and written.

``//@a.0/@b.3`` is entry 3 of feature ``b`` of entry 0 of feature ``a`` of the root. The index
counts the children of that feature only.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from eddi_scaffold.eddi_xml.parsing import feature_of, select
from eddi_scaffold.eddi_xml.vocabulary import fold, is_misprint

if TYPE_CHECKING:
    from eddi_scaffold.eddi_xml.parsing import Element

_FRAGMENT = re.compile(
    r"(?=/)(?:/{1,2}(?!@)([0-9]{1,9})?|/)?((?:/@[^\W\d][\w-]*(?:\.[0-9]{1,9})?)*)/?"
)
_SUGGESTION_BUDGET = 200_000
_DEEPEST = 256
"""The depth of a file that the parser reads: a longer path points at nothing."""


@dataclass(frozen=True)
class Fragment:
    """A parsed fragment path.

    Attributes:
        root: which root, 0 where there is one only.
        segments: ``/@a.0/@b.3``, as written.
    """

    root: int
    segments: str


@dataclass(frozen=True)
class ReferenceToken:
    """One reference as written.

    Attributes:
        text: the token.
        resource: the other file that it names, empty for this one.
        fragment: the parsed path, ``None`` when it is an ``xmi:id`` or does not parse.
        id: the ``xmi:id``, ``None`` when it is a path or does not parse.
    """

    text: str
    resource: str = ""
    fragment: Fragment | None = None
    id: str | None = None


def parse_fragment(text: str) -> Fragment | None:
    """Parse a fragment path; ``None`` when it is none."""
    match = _FRAGMENT.fullmatch(text)
    return Fragment(int(match.group(1) or 0), match.group(2)) if match else None


def parse_token(text: str) -> ReferenceToken:
    """Parse one reference: a path, ``#`` and a path, another file's, or an ``xmi:id``."""
    resource, sharp, rest = text.partition("#")
    if not sharp:
        resource, rest = "", text
    if rest.startswith("/"):
        return ReferenceToken(text, resource, fragment=parse_fragment(rest))
    return ReferenceToken(text, resource, id=rest or None)


class _Children:
    """The children of one element by feature."""

    def __init__(self, parent: Element) -> None:
        self._parent = parent
        self.by_name: dict[str, list[Element]] = {}
        for child in parent.iterchildren():
            self.by_name.setdefault(feature_of(child), []).append(child)

    @cached_property
    def by_folded(self) -> dict[str, list[Element]]:
        if len(self.by_name) == len({fold(name) for name in self.by_name}):
            return {fold(name): group for name, group in self.by_name.items()}
        merged: dict[str, list[Element]] = {}
        for child in self._parent.iterchildren():
            merged.setdefault(fold(feature_of(child)), []).append(child)
        return merged

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
        self._found: dict[tuple[int, str], Element] = {}
        self._paths: dict[Element, str] = {}
        self._budget = _SUGGESTION_BUDGET
        self.misprints: Counter[tuple[str, str]] = Counter()
        """(printed, intended) feature names that paths needed repaired, with their count."""

    def children(self, parent: Element, *folded: str) -> list[Element]:
        """Return the children in the features with these folded names, in document order."""
        groups = [g for name in folded if (g := self._children(parent).by_folded.get(name))]
        if len(groups) < 2:
            return groups[0] if groups else []
        wanted = {child for group in groups for child in group}
        return [child for child in parent.iterchildren() if child in wanted]

    def path(self, element: Element) -> str:
        """Return the canonical path: each segment with its index, no slash at the end."""
        trail: list[Element] = []
        while element not in self._paths and element not in self._root_index:
            parent = element.getparent()
            if parent is None:  # the xmi:XMI element above the roots
                return "/"
            trail.append(element)
            element = parent
        path = self._paths.get(element) or self._root_path(element)
        for child in reversed(trail):
            path += self._children(element).segments[child]
            self._paths[child] = path
            element = child
        return path

    def resolve(self, fragment: Fragment) -> Element | None:
        """Return the element that a path points at, ``None`` when there is none."""
        if fragment.root >= len(self._roots) or fragment.segments.count("/@") > _DEEPEST:
            return None
        head, missing = fragment.segments, []
        element = self._found.get((fragment.root, head))
        while element is None and head:
            head, _, last = head.rpartition("/@")
            missing.append(last)
            element = self._found.get((fragment.root, head))
        element = self._roots[fragment.root] if element is None else element
        for segment in reversed(missing):
            child = self._step(element, segment)
            if child is None:
                return None
            head = f"{head}/@{segment}"
            # Leaves are asked for once or twice; only what has children is worth a table entry.
            if len(child):
                self._found[fragment.root, head] = child
            element = child
        return element

    def by_id(self, xmi_id: str) -> Sequence[Element]:
        """Return the elements with an ``xmi:id``: one, unless the file is damaged."""
        return self._ids.get(xmi_id, ())

    def explain(self, fragment: Fragment) -> str:
        """Explain why a path points at nothing: the first segment that fails and what is there."""
        if fragment.root >= len(self._roots):
            return f"the file has {len(self._roots)} roots, the index {fragment.root} is too large"
        element = self._roots[fragment.root]
        segments = fragment.segments.split("/@")[1:]
        for depth, segment in enumerate(segments):
            child = self._step(element, segment)
            if child is None:
                suggestion = self._suggestion(fragment.root, segments[:depth], segments[depth:])
                return self._missing(element, segment) + suggestion
            element = child
        return "it exists"

    @cached_property
    def _ids(self) -> dict[str, list[Element]]:
        found: dict[str, list[Element]] = {}
        query = 'descendant-or-self::*[@*[local-name()="id" and contains(namespace-uri(), "XMI")]]'
        for root in self._roots:
            for element in select(root, query):
                for key, value in element.attrib.items():
                    if str(key).endswith("}id"):
                        found.setdefault(str(value), []).append(element)
        return found

    def _children(self, parent: Element) -> _Children:
        entry = self._index.get(parent)
        if entry is None:
            entry = self._index[parent] = _Children(parent)
        return entry

    def _root_path(self, root: Element) -> str:
        return "/" if len(self._roots) == 1 else f"/{self._root_index[root]}"

    def _step(self, parent: Element, segment: str) -> Element | None:
        # from behind: an element that EMF did not write may have points in its name
        name, point, digits = segment.rpartition(".")
        name, index = (name, int(digits)) if point and digits.isdecimal() else (segment, 0)
        children = self._children(parent)
        exact = children.by_name.get(name, ())
        if index < len(exact):
            return exact[index]
        similar = children.by_folded.get(fold(name), ())
        if index >= len(similar):
            return None
        there = feature_of(similar[index])
        right = is_misprint(there) and not is_misprint(name)
        self.misprints[(there, name) if right else (name, there)] += 1
        return similar[index]

    def _missing(self, parent: Element, segment: str) -> str:
        name, _, digits = segment.partition(".")
        here = self.path(parent)
        by_name = self._children(parent).by_name
        count = len(by_name.get(name, ()))
        if count:
            last = count - 1
            return f'{here} has {count} "{name}", the index {digits} is out of range (0 to {last})'
        if not by_name:
            return f'{here} has no "{name}", it has no children'
        features = [f'"{other}" ({len(group)})' for other, group in by_name.items()]
        shown = features[:8] + (["others"] if len(features) > 8 else [])
        there = " and ".join(filter(None, (", ".join(shown[:-1]), shown[-1])))
        return f'{here} has no "{name}", it has {there}'

    def _suggestion(self, root: int, good: Sequence[str], rest: Sequence[str]) -> str:
        """Return the one existing path that results from inserting one segment, as a question."""
        found: set[str] = set()
        for depth in range(len(good) + 1):
            prefix = "".join(f"/@{s}" for s in good[:depth])
            parent = self.resolve(Fragment(root, prefix))
            if parent is None:
                continue
            for segment in self._segments(parent):
                tail = "".join(f"/@{s}" for s in (*good[depth:], *rest))
                element = self.resolve(Fragment(root, f"{prefix}{segment}{tail}"))
                if element is not None:
                    found.add(self.path(element))
                if len(found) > 1:
                    return ""
        return f"; did you mean {found.pop()}?" if found else ""

    def _segments(self, parent: Element) -> Iterator[str]:
        """Yield the segments to the children, within a budget: a broken file may hold millions."""
        segments = self._children(parent).segments.values()
        self._budget -= len(segments)
        return iter(segments if self._budget >= 0 else ())

"""What this project adds to an EDDI: ``keyValueMaps`` whose key begins with ``eddi.``.

Every tool that is made of the metamodel keeps such maps when it reads and writes a file; elements,
attributes and comments of ours it would refuse or drop. ``docs/reference/eddi.md`` describes the
keys.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from eddi_scaffold.common.problems import Place, Problem, did_you_mean, problem
from eddi_scaffold.eddi_xml.parsing import select
from eddi_scaffold.eddi_xml.vocabulary import Spelling

if TYPE_CHECKING:
    from eddi_scaffold.eddi_xml.document import EddiDocument
    from eddi_scaffold.eddi_xml.parsing import Element

PREFIX = "eddi."
EVENTS, SAFEML, MONITORED_BY = "eddi.events", "eddi.safeml", "eddi.monitored_by"
KEYS = (EVENTS, SAFEML, MONITORED_BY)
MODEL = "model"
_QUERY = 'descendant-or-self::*[local-name()="keyValueMaps"][starts-with(@key, "eddi.")]'
_VALUES = Spelling("values")
_MOST_VALUES = 1000
_NAME = re.compile(r"[A-Za-z0-9](?:[A-Za-z0-9_-]|\.(?!\.)){0,99}")


@dataclass(frozen=True)
class Value:
    """One entry of a map: a tag, a text, and where it stands."""

    tag: str
    text: str
    place: Place


@dataclass(frozen=True)
class ExtensionMap:
    """One map of ours.

    Attributes:
        key: one of ``KEYS``, or an unknown one.
        element: the map itself.
        owner: the element that it stands on.
        place: of the map.
        values: in the order of the file.
    """

    key: str
    element: Element
    owner: Element
    place: Place
    values: tuple[Value, ...]

    @cached_property
    def model(self) -> str | None:
        """The name of the model that the map describes, ``None`` where it is not usable."""
        named = self.of(MODEL)
        return named[0].text if len(named) == 1 and _NAME.fullmatch(named[0].text) else None

    def of(self, *tags: str) -> list[Value]:
        """Return the values with one of some tags."""
        return [value for value in self.values if value.tag in tags]


def extension_maps(document: EddiDocument, *keys: str) -> Iterator[ExtensionMap]:
    """Yield the maps of ours, in document order; of some keys only."""
    for root in document.roots:
        for element in select(root, _QUERY):
            key, owner = str(element.get("key")), element.getparent()
            if owner is not None and (not keys or key in keys):
                values = document.children(element, _VALUES)[: _MOST_VALUES + 1]
                found = tuple(
                    Value(value.get("tag") or "", value.get("value") or "", document.place(value))
                    for value in values
                )
                yield ExtensionMap(key, element, owner, document.place(element), found)


def check_maps(document: EddiDocument) -> list[Problem]:
    """Check what does not depend on the kind of a model: keys, names and sizes (X010, X031)."""
    problems: list[Problem] = []
    first: dict[str, Place] = {}
    for extension_map in extension_maps(document):
        if extension_map.key not in KEYS:
            hint = did_you_mean(extension_map.key, KEYS) or f"keys: {', '.join(KEYS)}"
            problems.append(
                problem("X031.key", extension_map.place, hint=hint, key=extension_map.key)
            )
            continue
        if len(extension_map.values) > _MOST_VALUES:
            problems.append(
                problem(
                    "X003.values", extension_map.place, key=extension_map.key, limit=_MOST_VALUES
                )
            )
        if extension_map.key != MONITORED_BY:
            problems += _check_name(extension_map, first)
    return problems


def _check_name(one: ExtensionMap, first: dict[str, Place]) -> Iterator[Problem]:
    named = one.of(MODEL)
    if one.model is None:
        place = named[-1].place if named else one.place
        yield problem("X010.model", place, key=one.key)
    elif one.model in first:
        before = first[one.model].line
        yield problem("X010.same_name", named[0].place, model=one.model, before=before)
    else:
        first[one.model] = named[0].place


def unknown_tags(one: ExtensionMap, known: Sequence[str], once: Sequence[str]) -> Iterator[Problem]:
    """Yield an error (X031) for each tag that a map may not have, or has once too often.

    Args:
        one: the map.
        known: tags that it may have.
        once: those of them that may stand once.
    """
    seen: set[str] = set()
    for value in one.values:
        if value.tag not in known:
            hint = did_you_mean(value.tag, known) or f"tags: {', '.join(known)}"
            yield problem("X031.no_tag", value.place, hint=hint, key=one.key, tag=value.tag)
        elif value.tag in once and value.tag in seen and value.tag != MODEL:
            yield problem("X031.twice", value.place, tag=value.tag)
        seen.add(value.tag)

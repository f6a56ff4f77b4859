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
from typing import NamedTuple

from eddi_scaffold.common.problems import Place, Problem, did_you_mean, problem
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.eddi_xml.parsing import Element, select
from eddi_scaffold.eddi_xml.vocabulary import VALUES

EVENTS, SAFEML, MONITORED_BY = "eddi.events", "eddi.safeml", "eddi.monitored_by"
KEYS = (EVENTS, SAFEML, MONITORED_BY)
MODEL = "model"
_QUERY = 'descendant-or-self::*[local-name()="keyValueMaps"][starts-with(@key, "eddi.")]'
_MOST_VALUES = 1000
_NAME = re.compile(r"[A-Za-z0-9](?:[A-Za-z0-9_-]|\.(?!\.)){0,99}")


class Value(NamedTuple):
    """One entry of a map: a tag, a text, and where it stands."""

    tag: str
    text: str
    place: Place


@dataclass(frozen=True)
class ExtensionMap:
    """One map of ours."""

    key: str  # one of `KEYS`, or an unknown one
    element: Element  # the map itself
    owner: Element  # the element that it stands on
    place: Place  # of the map
    values: tuple[Value, ...]  # in the order of the file

    @cached_property
    def model(self) -> str | None:
        """The name of the model that the map describes, ``None`` where it is not usable."""
        models = self.of(MODEL)
        return models[0].text if len(models) == 1 and _NAME.fullmatch(models[0].text) else None

    def of(self, *tags: str) -> list[Value]:
        """Return the values with one of some tags."""
        return [value for value in self.values if value.tag in tags]


def extension_maps(document: EddiDocument, *keys: str) -> Iterator[ExtensionMap]:
    """Yield the maps of ours, in document order; of some keys only."""
    for element in (element for root in document.roots for element in select(root, _QUERY)):
        key, owner = str(element.get("key")), element.getparent()
        if owner is not None and (not keys or key in keys):
            values = tuple(
                Value(value.get("tag") or "", value.get("value") or "", document.place(value))
                for value in document.children(element, VALUES)[: _MOST_VALUES + 1]
            )
            yield ExtensionMap(key, element, owner, document.place(element), values)


def check_maps(document: EddiDocument) -> Iterator[Problem]:
    """Yield what is wrong whatever the kind of a model: keys, names and sizes (X010, X031)."""
    first: dict[str, Place] = {}
    for extension_map in extension_maps(document):
        key, place, model = extension_map.key, extension_map.place, extension_map.model
        if key not in KEYS:
            hint = did_you_mean(key, KEYS) or f"keys: {', '.join(KEYS)}"
            yield problem("X031.key", place, hint=hint, key=key)
            continue
        if len(extension_map.values) > _MOST_VALUES:
            yield problem("X003.values", place, key=key, limit=_MOST_VALUES)
        if key == MONITORED_BY:
            continue
        place = next((value.place for value in reversed(extension_map.of(MODEL))), place)
        if model is None:
            yield problem("X010.model", place, key=key)
        elif model in first:
            yield problem("X010.same_name", place, model=model, before=first[model].line)
        else:
            first[model] = place


def unknown_tags(
    extension_map: ExtensionMap, known: Sequence[str], once: Sequence[str]
) -> Iterator[Problem]:
    """Yield an error (X031) for each tag that is not known, or stands more than once."""
    seen: set[str] = set()
    for value in extension_map.values:
        if value.tag not in known:
            hint = did_you_mean(value.tag, known) or f"tags: {', '.join(known)}"
            fields = {"key": extension_map.key, "tag": value.tag}
            yield problem("X031.no_tag", value.place, hint=hint, **fields)
        elif value.tag in once and value.tag in seen and value.tag != MODEL:
            yield problem("X031.twice", value.place, tag=value.tag)
        seen.add(value.tag)

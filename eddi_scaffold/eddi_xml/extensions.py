"""What this project adds to an EDDI: ``keyValueMaps`` whose key begins with ``eddi.``.

Every tool that is made of the metamodel keeps such maps when it reads and writes a file; elements,
attributes and comments of ours it would refuse or drop. ``docs/reference/eddi.md`` describes the
keys.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from eddi_scaffold.common.problems import Place, Problem, did_you_mean, problem, shortened_list
from eddi_scaffold.eddi_xml import vocabulary as names
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.eddi_xml.parsing import Element, feature_of, select
from eddi_scaffold.eddi_xml.vocabulary import VALUES, fold

EVENTS, SAFEML, MONITORED_BY = "eddi.events", "eddi.safeml", "eddi.monitored_by"
MITIGATED_BY = "eddi.mitigated_by"
AFTER, PRIORITY = "eddi.after", "eddi.priority"  # of a transition; each has one value
KEYS = (EVENTS, SAFEML, MONITORED_BY, MITIGATED_BY, AFTER, PRIORITY)
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
        if key not in (EVENTS, SAFEML):
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


_TAGS = ("event", "safeml", "reliability", "network", "subject")
TAG_OF_KIND = {
    "fault_tree": "reliability",
    "markov_chain": "reliability",
    "bayesian_network": "network",
    "consert": "subject",
}
_EVENT = re.compile(r"\s*([A-Za-z_][A-Za-z0-9_]*)\s*(?:\(\s*([A-Za-z]+)\s*\))?")
_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


class _Event(NamedTuple):
    path: str  # of the value that declares it
    is_hazard: bool  # its polarity is HAZARD
    uses: frozenset[str]  # names in its condition


class Observed:
    """What observes what in a document, with paths in place of names."""

    def __init__(self, document: EddiDocument) -> None:
        self._document = document
        # element, path of the model or of the event that observes it, and name of what the model
        # claims of it; empty where it claims only one thing
        self.by: list[tuple[Element, str, str]] = []
        self.events: dict[str, list[str]] = {}  # path of an event -> of those that it is made of
        self.problems: list[Problem] = []  # names that mean nothing (X033), unknown tags (X031)
        self._events: dict[str, _Event] = {}  # by MODEL/NAME
        self._models: dict[str, dict[str, str]] = {tag: {} for tag in _TAGS}  # path by tag and name
        for extension_map in extension_maps(document, EVENTS, SAFEML):
            if extension_map.model is not None and extension_map.key == SAFEML:
                self._models["safeml"][extension_map.model] = extension_map.place.path or ""
            elif extension_map.model is not None:
                self._read_events(extension_map, extension_map.model)
        maps = list(extension_maps(document, MONITORED_BY))
        if any(value.tag in TAG_OF_KIND.values() for map_ in maps for value in map_.values):
            for element in document.document.iter():
                kind = document.kind_of(element)
                if kind in TAG_OF_KIND:
                    models = self._models[TAG_OF_KIND[kind]]
                    models[element.get("name") or ""] = document.references.path(element)
        for extension_map in maps:
            self._read_map(extension_map)

    def by_model(self, path: str | None) -> tuple[tuple[str, str], ...]:
        """Return what the model at a path observes: names of elements, each with its claim."""
        pairs = (
            (self._document.name_of(element) or feature_of(element), claim)
            for element, by, claim in self.by
            if path is not None and f"{by}/".startswith(f"{path}/")
        )
        return tuple(dict.fromkeys(pairs))

    def _read_events(self, extension_map: ExtensionMap, model: str) -> None:
        events: dict[str, _Event] = {}
        for value in extension_map.of("EVENT"):
            match = _EVENT.match(value.text)
            if match is not None:
                uses = frozenset(_IDENTIFIER.findall(value.text[match.end() :]))
                is_hazard = (match[2] or "").upper() == "HAZARD"
                events[match[1]] = _Event(value.place.path or "", is_hazard, uses)
        for event in events.values():
            paths = (events[name].path for name in event.uses if name in events)
            self.events[event.path] = [path for path in paths if path != event.path]
        self._events |= {f"{model}/{name}": event for name, event in events.items()}

    def _read_map(self, extension_map: ExtensionMap) -> None:
        self.problems.extend(unknown_tags(extension_map, _TAGS, ("subject",)))
        owner = self._subject(extension_map)
        for value in extension_map.of("event"):
            self._observe_event(owner, value)
        for value in extension_map.of("safeml", "reliability", "network"):
            model, _, claim = value.text.partition("/")
            if value.tag == "safeml":
                model, claim = value.text, ""
            models = self._models[value.tag]
            if model in models:
                self.by.append((owner, models[model], claim))
            else:
                self._report_unknown(value, model, models)

    def _observe_event(self, owner: Element, value: Value) -> None:
        event = self._events.get(value.text)
        kind = self._document.class_of(owner).name or fold(feature_of(owner))
        if event is None:
            self._report_unknown(value, value.text, self._events)
        elif event.is_hazard and names.EVIDENCE.accepts(feature_of(owner)):
            self.problems.append(problem("X033.hazard", value.place, event=value.text))
        else:
            if not event.is_hazard and kind in {"hazard", "hazards"}:
                self.problems.append(problem("X033.evidence", value.place, event=value.text))
            self.by.append((owner, event.path, value.text.partition("/")[2]))

    def _subject(self, extension_map: ExtensionMap) -> Element:
        """Return the evidence that a map is about, which may stand on another element."""
        conserts = self._models["subject"]
        for value in extension_map.of("subject")[:1]:
            name, _, evidence = value.text.partition("/")
            consert = self._document.references.at(conserts.get(name, ""))
            children = [] if consert is None else self._document.children(consert, names.EVIDENCE)
            by_name = {child.get("name") or "": child for child in children}
            if evidence in by_name:
                return by_name[evidence]
            known = [f"{name}/{each}" for each in by_name] or conserts
            self._report_unknown(value, value.text, known)
        return extension_map.owner

    def _report_unknown(self, value: Value, name: str, known: Collection[str]) -> None:
        hint = did_you_mean(name, known) or f"there are: {shortened_list(known)}"
        self.problems.append(
            problem("X033.unknown", value.place, hint=hint, tag=value.tag, event=name)
        )

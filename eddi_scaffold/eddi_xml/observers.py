"""The maps ``eddi.monitored_by``: which monitor observes an element, by name.

A reference cannot stand in a text, because tools do not follow when its target moves; so these are
names, and a name that means nothing is found here.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import NamedTuple

from eddi_scaffold.common.problems import Problem, did_you_mean, problem
from eddi_scaffold.eddi_xml import vocabulary as names
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.eddi_xml.extensions import (
    EVENTS,
    MONITORED_BY,
    SAFEML,
    ExtensionMap,
    Value,
    extension_maps,
    unknown_tags,
)
from eddi_scaffold.eddi_xml.parsing import Element, feature_of
from eddi_scaffold.eddi_xml.vocabulary import fold

_TAGS = ("event", "safeml", "reliability", "network", "subject")
_TAG_OF_KIND = {
    "fault_tree": "reliability",
    "markov_chain": "reliability",
    "bayesian_network": "network",
    "consert": "subject",
}
_EVENT = re.compile(r"\s*([A-Za-z_][A-Za-z0-9_]*)\s*(?:\(\s*([A-Za-z]+)\s*\))?")
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


class _Event(NamedTuple):
    """One event of the file."""

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
        if any(value.tag in _TAG_OF_KIND.values() for map_ in maps for value in map_.values):
            for element in document.document.iter():
                kind = document.kind_of(element)
                if kind in _TAG_OF_KIND:
                    models = self._models[_TAG_OF_KIND[kind]]
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
                uses = frozenset(_NAME.findall(value.text[match.end() :]))
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
        if event is None:
            self._report_unknown(value, value.text, self._events)
            return
        if event.is_hazard and names.EVIDENCE.accepts(feature_of(owner)):
            self.problems.append(problem("X033.hazard", value.place, event=value.text))
            return
        kind = self._document.class_of(owner).name or fold(feature_of(owner))
        if not event.is_hazard and kind in {"hazard", "hazards"}:
            self.problems.append(problem("X033.evidence", value.place, event=value.text))
        self.by.append((owner, event.path, value.text.partition("/")[2]))

    def _subject(self, extension_map: ExtensionMap) -> Element:
        """Return the evidence that a map is about, which may stand on another element."""
        conserts = self._models["subject"]
        for value in extension_map.of("subject")[:1]:
            name, _, evidence = value.text.partition("/")
            consert = self._document.at(conserts.get(name, ""))
            children = [] if consert is None else self._document.children(consert, names.EVIDENCE)
            by_name = {child.get("name") or "": child for child in children}
            if evidence in by_name:
                return by_name[evidence]
            known = [f"{name}/{each}" for each in by_name] or conserts
            self._report_unknown(value, value.text, known)
        return extension_map.owner

    def _report_unknown(self, value: Value, name: str, known: Collection[str]) -> None:
        listed = f"there are: {', '.join(known)}" if known else "there are none in this file"
        hint = did_you_mean(name, known) or listed
        self.problems.append(
            problem("X033.unknown", value.place, hint=hint, tag=value.tag, event=name)
        )

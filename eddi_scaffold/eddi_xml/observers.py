"""The maps ``eddi.monitored_by``: which monitor observes an element, by name.

A reference cannot stand in a text, because tools do not follow when its target moves; so these are
names, and a name that means nothing is found here.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from eddi_scaffold.common.problems import Problem, did_you_mean, problem
from eddi_scaffold.eddi_xml import vocabulary as word
from eddi_scaffold.eddi_xml.extensions import (
    EVENTS,
    MONITORED_BY,
    SAFEML,
    Value,
    extension_maps,
    unknown_tags,
)
from eddi_scaffold.eddi_xml.parsing import feature_of
from eddi_scaffold.eddi_xml.survey import MONITORED, kind_of_model, name_of
from eddi_scaffold.eddi_xml.vocabulary import fold

if TYPE_CHECKING:
    from eddi_scaffold.eddi_xml.document import EddiDocument
    from eddi_scaffold.eddi_xml.parsing import Element


_TAGS = ("event", "safeml", "reliability", "network", "subject")
_KINDS = {"reliability": ("fault_tree", "markov_chain"), "network": ("bayesian_network",)}
_EVENT = re.compile(r"\s*([A-Za-z_][A-Za-z0-9_]*)\s*(?:\(\s*([A-Za-z]+)\s*\))?")
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


@dataclass(frozen=True)
class Declared:
    """One event of the file.

    Attributes:
        path: of the value that declares it.
        is_hazard: its polarity is HAZARD.
        uses: names in its condition.
    """

    path: str
    is_hazard: bool
    uses: frozenset[str]


@dataclass(frozen=True)
class Observed:
    """What observes what, with paths in place of names.

    Attributes:
        by: element, path of the model or of the event that observes it, and name of what the model
            claims of it; empty where it claims only one thing.
        events: path of an event -> paths of the events that it is made of.
        problems: names that mean nothing (X033), unknown tags (X031).
    """

    by: list[tuple[Element, str, str]] = field(default_factory=list)
    events: dict[str, list[str]] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)

    def by_model(self, document: EddiDocument, path: str | None) -> tuple[tuple[str, str], ...]:
        """Return what the model at a path observes: names of elements, each with its claim."""
        found = (
            (name_of(document, element) or feature_of(element), claim)
            for element, by, claim in self.by
            if path is not None and f"{by}/".startswith(f"{path}/")
        )
        return tuple(dict.fromkeys(found))


def observed(document: EddiDocument) -> Observed:
    """Read the maps of a document."""
    found = Observed()
    models: dict[str, dict[str, str]] = {}
    events: dict[str, dict[str, Declared]] = {}
    for one in extension_maps(document, EVENTS, SAFEML):
        if one.model is not None and one.key == SAFEML:
            models.setdefault("safeml", {})[one.model] = one.place.path or ""
        elif one.model is not None:
            events[one.model] = dict(_declared(one.of("EVENT")))
    for own in events.values():
        for event in own.values():
            used = [own[name].path for name in event.uses if name in own]
            found.events[event.path] = [path for path in used if path != event.path]
    maps = list(extension_maps(document, MONITORED_BY))
    named = [value for map_ in maps for value in map_.values]
    if any(value.tag in _KINDS or value.tag == "subject" for value in named):
        _name_models(document, models)
    for one in maps:
        found.problems.extend(unknown_tags(one, _TAGS, ("subject",)))
        owner = _subject(document, one.of("subject"), one.owner, models, found.problems)
        for value in one.of("event"):
            _observe_event(document, owner, value, events, found)
        for value in one.of("safeml", *_KINDS):
            model, _, claim = (
                value.text.partition("/") if value.tag in _KINDS else (value.text, "", "")
            )
            known = models.get(value.tag, {})
            if model in known:
                found.by.append((owner, known[model], claim))
            else:
                found.problems.append(_unknown(value, model, known))
    return found


def _declared(values: list[Value]) -> Iterator[tuple[str, Declared]]:
    for value in values:
        match = _EVENT.match(value.text)
        if match is not None:
            uses = frozenset(_NAME.findall(value.text[match.end() :]))
            hazard = (match.group(2) or "").upper() == "HAZARD"
            yield match.group(1), Declared(value.place.path or "", hazard, uses)


def _name_models(document: EddiDocument, models: dict[str, dict[str, str]]) -> None:
    tags = {kind: tag for tag, kinds in _KINDS.items() for kind in kinds} | {"consert": "subject"}
    for element in document.document.iter():
        kind = kind_of_model(document, element)
        if kind in MONITORED and kind in tags:
            path = document.references.path(element)
            models.setdefault(tags[kind], {})[element.get("name") or ""] = path


def _observe_event(
    document: EddiDocument,
    owner: Element,
    value: Value,
    events: dict[str, dict[str, Declared]],
    found: Observed,
) -> None:
    model, _, name = value.text.partition("/")
    event = events.get(model, {}).get(name)
    if event is None:
        known = [f"{one}/{each}" for one, own in events.items() for each in own]
        found.problems.append(_unknown(value, value.text, known))
        return
    if event.is_hazard and word.EVIDENCE.accepts(feature_of(owner)):
        found.problems.append(problem("X033.hazard", value.place, event=value.text))
        return
    kind = document.class_of(owner).name or fold(feature_of(owner))
    if not event.is_hazard and kind in {"hazard", "hazards"}:
        found.problems.append(problem("X033.evidence", value.place, event=value.text))
    found.by.append((owner, event.path, name))


def _subject(
    document: EddiDocument,
    values: list[Value],
    owner: Element,
    models: dict[str, dict[str, str]],
    problems: list[Problem],
) -> Element:
    """Return the evidence that a map on another element is about."""
    for value in values[:1]:
        name, _, evidence = value.text.partition("/")
        path = models.get("subject", {}).get(name)
        consert = document.at(path) if path is not None else None
        inside = document.children(consert, word.EVIDENCE) if consert is not None else []
        by_name = {one.get("name") or "": one for one in inside}
        if evidence in by_name:
            return by_name[evidence]
        known = [f"{name}/{one}" for one in by_name] or list(models.get("subject", {}))
        problems.append(_unknown(value, value.text, known))
    return owner


def _unknown(value: Value, name: str, known: object) -> Problem:
    names = [str(one) for one in known] if isinstance(known, list | dict) else []
    shown = f"there are: {', '.join(names)}" if names else "there are none in this file"
    hint = did_you_mean(name, names) or shown
    return problem("X033.unknown", value.place, hint=hint, tag=value.tag, event=name)

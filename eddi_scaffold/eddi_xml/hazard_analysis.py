"""Hazards, measures and requirements of an EDDI, and the guarantees that they name.

Severities and the like are texts. A guarantee is linked by the map ``eddi.mitigated_by``, because
somebody decided it; what only observes (``eddi.monitored_by``, also of a failure) stays apart.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Literal

from eddi_scaffold.common import units
from eddi_scaffold.common.graphs import reached, reversed_graph
from eddi_scaffold.common.problems import Place, Problem
from eddi_scaffold.eddi_xml import vocabulary as names
from eddi_scaffold.eddi_xml.document import EddiDocument, EddiFindings
from eddi_scaffold.eddi_xml.extensions import (
    MITIGATED_BY,
    MONITORED_BY,
    TAG_OF_KIND,
    ExtensionMap,
    Value,
    extension_maps,
    unknown_tags,
)
from eddi_scaffold.eddi_xml.parsing import Element, select
from eddi_scaffold.eddi_xml.vocabulary import Spelling

_TRACES = "descendant::*[@odeElement][@sacmElement]"
_RISKS = ("severity", "likelihood", "controlability")
Kind = Literal["hazard", "requirement", "measure"]
_FEATURES: dict[Kind, tuple[Spelling, ...]] = {
    "hazard": (names.HAZARDS, names.HAZARD),
    "requirement": (names.REQUIREMENTS, names.REFINED_REQUIREMENTS),
    "measure": (names.MEASURES,),
}
"""The first holds them, all refer to them."""


@dataclass(frozen=True)
class Item:
    """A hazard, a requirement or a measure; what the metamodel does not give it is empty."""

    kind: Kind
    name: str
    place: Place  # its path tells it from others
    mitigated_by: tuple[Value, ...]  # each is the text `CONSERT/GUARANTEE`
    # tag and text of what observes it or a failure of it: ("event", "motor_watch/hot")
    observers: tuple[tuple[str, str], ...]
    claims: tuple[str, ...]  # of the assurance case, by traces
    condition: str  # of a hazard
    risks: tuple[str, ...]  # of its risk assessments, as stated: `severity S3`
    malfunctions: tuple[str, ...]  # names of those that lead to it
    is_goal: bool  # a safety goal
    refers_to: Mapping[str, tuple[str, ...]]  # kind -> paths; of a requirement its refinements
    # attribute (`failureDetectionTime`) -> seconds; what is 0 is not given
    times: Mapping[str, float]

    @property
    def path(self) -> str:
        """Its canonical fragment path."""
        return self.place.path or "/"

    @property
    def within_s(self) -> float | None:
        """Seconds within which a failure must be detected; ``None`` where none are stated."""
        return self.times.get(names.DETECTION_TIME.name)

    @property
    def title(self) -> str:
        """What it is, for people."""
        return f"{'safety goal' if self.is_goal else self.kind} {self.name}"


@dataclass(frozen=True)
class HazardAnalysis:
    """All of an EDDI."""

    items: Mapping[str, Item]  # by path, hazards first
    problems: tuple[Problem, ...]  # names, times and references that mean nothing

    def unlinked(self) -> list[Item]:
        """Return hazards and safety goals for which no guarantee is named, in linear time."""
        of_hazards, *graphs = self._graphs
        named = {path for path, of in self.items.items() if of.mitigated_by}
        named |= {path for path, of in self.items.items() if named & {*of.refers_to["measure"]}}
        starts = named & graphs[0].keys()
        named |= {path for graph in graphs for path in reached(graph, starts)}
        return [
            item
            for path, item in self.items.items()
            if item.kind == "hazard" or item.is_goal
            if named.isdisjoint([path, *of_hazards.get(path, ()), *item.refers_to["hazard"]])
        ]

    @cached_property
    def _graphs(self) -> Sequence[Mapping[str, Sequence[str]]]:
        """The requirements of each hazard, and the refinements of requirements both ways."""
        of_hazards: dict[str, list[str]] = defaultdict(list)
        down: dict[str, list[str]] = {}
        known = {path: of for path, of in self.items.items() if of.kind == "requirement"}
        for path, of in known.items():
            down[path] = [to for to in of.refers_to["requirement"] if to in known]
            for hazard in of.refers_to["hazard"]:
                of_hazards[hazard].append(path)
        return of_hazards, down, reversed_graph(down)

    def parts(self, item: Item) -> list[Item]:
        """Return the items whose guarantees are those of an item, itself first.

        They are the requirements of a hazard or the hazards of a requirement, refinements of these,
        and the measures of all.
        """
        of_hazards, *graphs = self._graphs
        own = [item.path] if item.kind == "requirement" else of_hazards.get(item.path, ())
        # up or down only: two goals with one refinement are not each other's
        others = sorted({path for graph in graphs for path in reached(graph, own)})
        paths = [item.path, *own, *others, *item.refers_to["hazard"]]
        items = [self.items[path] for path in paths if path in self.items]
        measures = [path for of in items for path in of.refers_to["measure"]]
        items += [self.items[path] for path in measures if path in self.items]
        return list({of.path: of for of in items}.values())


def hazard_analysis(document: EddiDocument) -> HazardAnalysis | None:
    """Read what the dependability packages of a document say; ``None`` where it has no items."""
    reader = _Reader(document)
    items = {item.path: item for item in reader.items()}
    for map_ in extension_maps(document, MITIGATED_BY):
        reader.findings.add(*unknown_tags(map_, ("guarantee",), ()))
        if document.references.path(map_.owner) not in items:
            element = document.describe(map_.owner)
            reader.findings.report("J005.elsewhere", map_.element, element=element)
    return HazardAnalysis(items, tuple(reader.findings.problems())) if items else None


class _Reader:
    def __init__(self, document: EddiDocument) -> None:
        self.document, self.findings = document, EddiFindings(document)
        self._maps: dict[Element, list[ExtensionMap]] = defaultdict(list)
        for map_ in extension_maps(document, MITIGATED_BY, MONITORED_BY):
            self._maps[map_.owner].append(map_)
        self._packages = [of for of in document.packages() if not document.is_monitored(of)]

    def _elements(self, feature: Spelling) -> list[Element]:
        children = (self.document.children(package, feature) for package in self._packages)
        return [of for elements in children for of in elements if of.get("href") is None]

    def _ends(self, element: Element, link: Spelling) -> list[Element]:
        ends, problems, _ = self.document.targets(element, link)
        # what is linked may well be in a file of its own
        self.findings.add(*(of for of in problems if of.case != "X007.resource"))
        return ends

    def _referring(self) -> Iterator[tuple[str, Element, str]]:
        """Yield what else is stated: field of an item, the item, and a text."""
        name_of = self.document.name_of
        for assessment in self._elements(names.RISK_ASSESSMENTS):
            stated = [assessment, *self._ends(assessment, names.RISK_PARAMETERS)]
            risks = [f"{key} {of.get(key)}" for of in stated for key in _RISKS if of.get(key)]
            yield from product(["risks"], self._ends(assessment, names.HAZARD), risks)
        for malfunction in self._elements(names.MALFUNCTIONS):
            hazards = self._ends(malfunction, names.HAZARDS)
            yield from product(["malfunctions"], hazards, [name_of(malfunction)])
        for trace in (of for root in self.document.roots for of in select(root, _TRACES)):
            claims = [of.get("gid") or name_of(of) for of in self._ends(trace, names.SACM_ELEMENT)]
            yield from product(["claims"], self._ends(trace, names.ODE_ELEMENT), claims)

    def items(self) -> Iterator[Item]:
        """Yield all hazards, requirements and measures."""
        document, path = self.document, self.document.references.path
        stated: dict[tuple[str, Element], list[str]] = defaultdict(list)
        for name, element, text in self._referring():
            stated[name, element].append(text)
        for kind, (feature, *_) in _FEATURES.items():
            for element in self._elements(feature):
                goal = document.attribute(element, names.IS_SAFETY_GOAL) or ""
                failures = self._ends(element, names.FAILURES)
                values = self._values(MONITORED_BY, element, *failures)
                observers = [(value.tag, value.text) for value in values]
                for model in (of for failure in failures for of in failure.iterancestors()):
                    if document.is_monitored(model):
                        tag = TAG_OF_KIND.get(document.kind_of(model) or "", "model")
                        observers.append((tag, document.name_of(model)))
                yield Item(
                    kind,
                    document.name_of(element),
                    document.place(element),
                    tuple(v for v in self._values(MITIGATED_BY, element) if v.tag == "guarantee"),
                    tuple(dict.fromkeys(observers)),
                    tuple(stated["claims", element]),
                    document.attribute(element, names.CONDITION) or "",
                    tuple(stated["risks", element]),
                    tuple(stated["malfunctions", element]),
                    goal.strip().lower() in {"true", "1"},
                    {
                        to: tuple(path(end) for link in links for end in self._ends(element, link))
                        for to, links in _FEATURES.items()
                    },
                    self._times(element),
                )

    def _values(self, key: str, *owners: Element) -> Iterator[Value]:
        maps = (map_ for owner in owners for map_ in self._maps.get(owner, ()))
        return (value for map_ in maps if map_.key == key for value in map_.values)

    def _times(self, element: Element) -> dict[str, float]:
        unit, times = self.findings.key_value(element, "unit"), {}
        for spelling in (names.DETECTION_TIME, names.REACTION_TIME, names.LATENCY_TIME):
            text, name = self.document.attribute(element, spelling) or "0", spelling.name
            try:
                times[name] = units.seconds(text if text == "0" else f"{text} {unit or 's'}")
            except units.QuantityError as wrong:
                hint, reason = wrong.hint, str(wrong)
                self.findings.report("J006.time", element, hint=hint, time=name, reason=reason)
        times = {name: of for name, of in times.items() if of}
        if times and unit is None:
            self.findings.report("J006.no_unit", element, times=", ".join(times))
        return times

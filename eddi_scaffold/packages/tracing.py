"""The trace table of a package: which element of the model became what.

Everything comes from the package's answers, so the table describes what was generated, not what the
model contains today.
"""

from __future__ import annotations

from ast import literal_eval
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from eddi_scaffold.common.claims import Element
from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.deployments.hazards import HazardTrace, Verification
from eddi_scaffold.deployments.support import WiredMonitor
from eddi_scaffold.eddi_xml.links import Link
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.compiling import MonitorFacts
from eddi_scaffold.monitors.compiling import from_json as facts_of
from eddi_scaffold.monitors.loading import read_models
from eddi_scaffold.packages.rendering import ANSWERS_FILE
from eddi_scaffold.regions.check import list_regions


@dataclass(frozen=True)
class TraceLink:
    """An element of the EDDI that nothing monitors by itself, and that is linked with a row."""

    to: Link
    through: str = ""  # the element on which the row rests, and which has the link; or its own

    def as_json(self) -> dict[str, JsonValue]:
        """Return the JSON form of ``trace --json``."""
        place = {"line": self.to.line, "path": self.to.path, "through": self.through or None}
        return {"class": self.to.class_name, "name": self.to.name, **place}

    def as_text(self, file: str) -> str:
        """Return the link for people."""
        through = f" through {self.through}" if self.through else ""
        return f"{self.to.class_name} {self.to.name} ({file}:{self.to.line or '-'}){through}"


@dataclass(frozen=True)
class TraceRow:
    """One element of the model."""

    element: str  # what it is (`guarantee`, `node`)
    id: str  # as in the model
    line: int | None  # line in the model file, `None` when the file has none
    path: str  # EMF fragment path in an EDDI, `""` for other files
    code: str = ""  # its place in the generated code (`EDDIInput.process_RtE_E0`), or `""`
    topics: tuple[str, ...] = ()  # what it is read from
    links: tuple[TraceLink, ...] = ()  # hazards, requirements, claims and others that refer to it
    is_configured: bool = False  # the configuration says it, not the model file


@dataclass(frozen=True)
class Trace:
    """The table of one package."""

    package: str  # name of the package
    kind: str  # kind of the monitor
    model: str  # id of the model
    file: str  # model file it was generated from
    sha256: str  # digest of that file's bytes
    model_sha256: str  # digest of all that decides what the monitor computes
    outputs: Sequence[str]  # topics it publishes
    facts: Sequence[str]  # lines about the whole, such as the result of a cross-check
    rows: Sequence[TraceRow]  # elements in the order of the model
    links: Sequence[TraceLink] = ()  # those of the model as a whole

    def as_json(self) -> dict[str, JsonValue]:
        """Return the JSON form of ``trace --json``."""
        elements = [
            {
                "element": row.element,
                "id": row.id,
                "file": None if row.is_configured else self.file,
                "line": row.line,
                "path": row.path,
                "code": row.code,
                "topics": " ".join(row.topics),
                "links": [link.as_json() for link in row.links],
            }
            for row in self.rows
        ]
        own = {name: value for name, value in vars(self).items() if name not in {"rows", "links"}}
        return {**own, "elements": elements, "links": [link.as_json() for link in self.links]}

    def as_text(self) -> str:
        """Return the table for people."""
        lines = [
            f"{self.package}: {self.kind} {self.model}",
            f"  generated from {self.file} (sha256 {self.sha256})",
            f"  the monitor has the digest {self.model_sha256}",
            *(f"  publishes {topic}" for topic in self.outputs),
            *(f"  {fact}" for fact in self.facts),
            *(f"  linked with {link.as_text(self.file)}" for link in self.links),
        ]
        table = []
        for row in self.rows:
            place = self.file if row.line is None else f"{self.file}:{row.line}"
            place = "(configuration)" if row.is_configured else place
            table.append((row.element, row.id, place, row.path, row.code))
        widths = [max(map(len, column)) for column in zip(*table, strict=True)]
        for row, texts in zip(self.rows, table, strict=True):
            cells = [text.ljust(width) for text, width in zip(texts, widths, strict=True)]
            lines.append("  ".join(["", *cells, *row.topics]).rstrip())
            lines += [f"      linked with {link.as_text(self.file)}" for link in row.links]
        return "\n".join(lines)


def trace_of(answers: Mapping[str, Any]) -> Trace:
    """Return the table of a package from its answers; of damaged ones, EddiError T005."""
    try:
        return _trace_of(answers)
    except (AttributeError, KeyError, SyntaxError, TypeError, ValueError) as damage:
        place = Place(f"{answers.get('package')}/{ANSWERS_FILE}")
        raise EddiError(problem("T005.damaged", place, answer=damage)) from None


def hazard_trace(
    eddi: Path,
    monitors: Sequence[WiredMonitor],
    packages: Iterable[Path],
    known: Mapping[str, Verification] = MappingProxyType({}),
) -> HazardTrace:
    """Follow the hazards of an EDDI to packages.

    Args:
        eddi: the file.
        monitors: of the packages.
        packages: their folders, in which files may have been edited.
        known: of each, by its name.

    Raises:
        EddiError: the file cannot be read, or has neither hazards nor requirements (F004).
    """
    source = read_source(eddi)
    reading = read_models(source)
    if reading.hazards is None:
        errors = [of for of in reading.problems if of.level == "error"]
        raise EddiError(*(errors or [problem("F004.no_hazards", Place(source.name))]))
    verified = {}
    for package in packages:
        edited = sorted({of.file for of in list_regions(package) if of.state == "outside"})
        of_package = known.get(package.name, Verification())
        verified[package.name] = replace(of_package, differs=tuple(edited))
    return HazardTrace(reading.hazards, monitors, verified=verified)


def _trace_of(answers: Mapping[str, Any]) -> Trace:
    facts = facts_of(answers["facts"])
    all_links = facts.links or {}
    code = dict(_code(answers))
    inputs = {input_.id: input_ for input_ in facts.inputs}
    config: Mapping[str, Any] = answers.get("config") or {}
    topics = {item["id"]: item.get("topic", "") for item in config.get("SimulatorOutputs", ())}
    section = config.get("Model") or {}
    limits = [*(section.get("evidence") or ()), *(section.get("thresholds") or ())]
    configured = {limit["id"] for limit in limits} | inputs.keys()
    links = {path: tuple(map(TraceLink, linked.links)) for path, linked in all_links.items()}
    names = {element.id for element in facts.elements}
    elements = [*facts.elements, *(Element("input", name) for name in inputs if name not in names)]
    rows: list[TraceRow] = []
    for element in elements:
        required = inputs[element.id].requires if element.id in inputs else ()
        inside = (of for path, of in links.items() if _is_inside(path, element.path))
        row = TraceRow(
            element.element,
            element.id,
            element.line,
            element.path or "",
            code.get(element.id, ""),
            tuple(topics.get(name) or name for name in required),
            tuple(link for of in inside for link in of),
            element.line is None and element.id in configured,
        )
        rows.append(row)
    paths = [row.path for row in rows]
    for path, linked in all_links.items():
        if path != facts.path and not any(_is_inside(path, above) for above in paths):
            row = TraceRow(linked.element, linked.id, linked.line, path, links=links[path])
            rows = [other for other in rows if other.path or other.id != row.id] + [row]
    readme = [line for line in answers.get("readme") or () if line and "|" not in line]
    more = [linked for linked in all_links.values() if linked.is_cut]
    return Trace(
        package=answers["package"],
        kind=answers["kind"],
        model=facts.id,
        file=answers["model_file"],
        sha256=answers["model_sha256"],
        model_sha256=facts.digest,
        outputs=[item["topic_text"] for item in answers.get("publications") or ()],
        facts=[
            *(line for line in readme if not line.startswith("#")),
            *(f"{of.element} {of.id} has more links: the nearest are listed" for of in more),
        ],
        rows=_with_support(rows, facts, {e.claim or e.id: e.id for e in elements}),
        links=links.get(facts.path or "", ()),
    )


def _is_inside(path: str, above: str | None) -> bool:
    """Return whether an element of the EDDI is another one, or a part of it."""
    return bool(above) and f"{path}/".startswith(f"{above}/")


def _with_support(
    rows: Sequence[TraceRow], facts: MonitorFacts, published: Mapping[str, str]
) -> list[TraceRow]:
    """Return claims with the links of what they rest on, which lead back to their hazards."""
    linked = {row.id: row.links for row in rows if row.links}
    rests_on = {published.get(claim.id, claim.id): claim.rests_on for claim in facts.claims}
    supported = []
    for row in rows:
        links = {link.to.path: link for link in row.links}
        for name in sorted(rests_on.get(row.id, ())):
            for link in linked.get(name, ()):
                links.setdefault(link.to.path, TraceLink(link.to, name))
        supported.append(replace(row, links=tuple(links.values())))
    return supported


def _code(answers: Mapping[str, Any]) -> Iterable[tuple[str, str]]:
    """Yield (id of an element, method in which a person may write about it)."""
    for item in answers.get("inputs") or ():
        yield literal_eval(item["id"]), f"EDDIInput.process_{item['attribute']}"
    for module in answers.get("modules") or ():
        for method in module["methods"]:
            yield literal_eval(method["about"]), f"{module['name']}.{method['name']}"

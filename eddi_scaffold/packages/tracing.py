"""The trace table of a package: which element of the model became what.

Everything comes from the package's answers, so the table describes what was generated, not what the
model contains today.
"""

from __future__ import annotations

import json
from ast import literal_eval
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from eddi_scaffold.common.claims import Element
from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.facts import MonitorFacts
from eddi_scaffold.monitors.facts import from_json as facts_of
from eddi_scaffold.packages.rendering import ANSWERS_FILE

COLUMNS = ("element", "id", "file", "line", "path", "code", "topics", "links")


@dataclass(frozen=True)
class TraceLink:
    """An element of the EDDI that nothing monitors by itself, and that is linked with a row.

    Attributes:
        class_name: its class as the file states it.
        name: its name.
        line: line of it in the model file.
        path: EMF fragment path.
        through: the element on which the row rests, and which has the link; empty for its own.
    """

    class_name: str
    name: str
    line: int | None
    path: str
    through: str = ""

    def as_json(self) -> dict[str, JsonValue]:
        """Return the JSON form of ``trace --json``."""
        return {
            "class": self.class_name,
            "name": self.name,
            "line": self.line,
            "path": self.path,
            "through": self.through or None,
        }

    def as_text(self, file: str) -> str:
        """Return the link for people."""
        through = f" through {self.through}" if self.through else ""
        return f"{self.class_name} {self.name} ({file}:{self.line or '-'}){through}"


@dataclass(frozen=True)
class TraceRow:
    """One element of the model.

    Attributes:
        element: what it is (``guarantee``, ``node``).
        id: as in the model.
        line: line in the model file, ``None`` when the file has none.
        path: EMF fragment path in an EDDI, ``""`` for other files.
        code: its place in the generated code (``EDDIInput.process_RtE_E0``), or ``""``.
        topics: what it is read from.
        links: hazards, requirements, failure modes, claims and others that refer to it.
        is_configured: the configuration says it, not the model file.
    """

    element: str
    id: str
    line: int | None
    path: str
    code: str = ""
    topics: tuple[str, ...] = ()
    links: tuple[TraceLink, ...] = ()
    is_configured: bool = False


@dataclass(frozen=True)
class Trace:
    """The table of one package.

    Attributes:
        package: name of the package.
        kind: kind of the monitor.
        model: id of the model.
        file: model file it was generated from.
        sha256: digest of that file's bytes.
        model_sha256: digest of all that decides what the monitor computes.
        outputs: topics it publishes.
        facts: lines about the whole, such as the result of a cross-check.
        rows: elements in the order of the model.
        links: those of the model as a whole.
    """

    package: str
    kind: str
    model: str
    file: str
    sha256: str
    model_sha256: str
    outputs: tuple[str, ...]
    facts: tuple[str, ...]
    rows: tuple[TraceRow, ...]
    links: tuple[TraceLink, ...] = ()

    def as_json(self) -> dict[str, JsonValue]:
        """Return the JSON form of ``trace --json``."""
        rows: list[JsonValue] = [
            {
                **dict(zip(COLUMNS, self.cells(row), strict=True)),
                "links": [link.as_json() for link in row.links],
            }
            for row in self.rows
        ]
        return {
            "package": self.package,
            "kind": self.kind,
            "model": self.model,
            "file": self.file,
            "sha256": self.sha256,
            "model_sha256": self.model_sha256,
            "outputs": list(self.outputs),
            "facts": list(self.facts),
            "elements": rows,
            "links": [link.as_json() for link in self.links],
        }

    def cells(self, row: TraceRow) -> tuple[JsonValue, ...]:
        """Return the values of one row in the order of ``COLUMNS``."""
        topics = " ".join(row.topics)
        links = "; ".join(link.as_text(self.file) for link in row.links)
        file = None if row.is_configured else self.file
        return (row.element, row.id, file, row.line, row.path, row.code, topics, links)

    def _place(self, row: TraceRow) -> str:
        if row.is_configured:
            return "(configuration)"
        return self.file if row.line is None else f"{self.file}:{row.line}"

    def as_text(self) -> str:
        """Return the table for people."""
        head = [
            f"{self.package}: {self.kind} {self.model}",
            f"  generated from {self.file} (sha256 {self.sha256})",
            f"  the monitor has the digest {self.model_sha256}",
        ]
        head += [f"  publishes {topic}" for topic in self.outputs]
        head += [f"  {fact}" for fact in self.facts]
        head += [f"  linked with {link.as_text(self.file)}" for link in self.links]
        shown = [
            (row.element, row.id, self._place(row), row.path, row.code, *row.topics)
            for row in self.rows
        ]
        widths = [max((len(line[k]) for line in shown), default=0) for k in range(5)]
        body = [
            "  ".join(
                [text.ljust(width) for text, width in zip(line[:5], widths, strict=True)]
                + list(line[5:])
            ).rstrip()
            for line in shown
        ]
        lines = []
        for row, line in zip(self.rows, body, strict=True):
            lines.append(f"  {line}")
            lines += [f"      linked with {link.as_text(self.file)}" for link in row.links]
        return "\n".join([*head, *lines])


def trace_of(answers: Mapping[str, Any]) -> Trace:
    """Return the table of a package from its answers.

    Raises:
        EddiError: the answers are damaged (T005).
    """
    try:
        return _trace_of(answers)
    except (AttributeError, KeyError, SyntaxError, TypeError, ValueError) as damage:
        place = Place(f"{answers.get('package')}/{ANSWERS_FILE}")
        raise EddiError(problem("T005.damaged", place, answer=damage)) from None


def _trace_of(answers: Mapping[str, Any]) -> Trace:
    facts = facts_of(answers["facts_json"])
    code = dict(_code(answers))
    inputs = {input_.id: input_ for input_ in facts.inputs}
    config: Mapping[str, Any] = json.loads(answers.get("config_json") or "{}")
    topics = {item["id"]: item.get("topic", "") for item in config.get("SimulatorOutputs", ())}
    section = config.get("Model") or {}
    limits = [*(section.get("evidence") or ()), *(section.get("thresholds") or ())]
    configured = {limit["id"] for limit in limits} | inputs.keys()
    links = {
        path: tuple(
            TraceLink(link.class_name, link.name, link.line, link.path) for link in of.links
        )
        for path, of in (facts.links or {}).items()
    }
    rows: list[TraceRow] = []
    known = {element.id for element in facts.elements}
    of_inputs = (Element("input", name) for name in inputs if name not in known)
    elements = [*facts.elements, *of_inputs]
    for element in elements:
        given = inputs.get(element.id)
        heard = tuple(topics.get(name) or name for name in given.requires) if given else ()
        rows.append(
            TraceRow(
                element.element,
                element.id,
                element.line,
                element.path or "",
                code.get(element.id, ""),
                heard,
                tuple(
                    link
                    for at, of in links.items()
                    if element.path and f"{at}/".startswith(f"{element.path}/")
                    for link in of
                ),
                element.line is None and element.id in configured,
            )
        )
    paths = [row.path for row in rows if row.path]
    for path, linked in (facts.links or {}).items():
        if path != facts.path and not any(f"{path}/".startswith(f"{at}/") for at in paths):
            row = TraceRow(linked.element, linked.id, linked.line, path, links=links[path])
            rows = [other for other in rows if other.path or other.id != row.id] + [row]
    return Trace(
        package=answers["package"],
        kind=answers["kind"],
        model=facts.id,
        file=answers["model_file"],
        sha256=answers["model_sha256"],
        model_sha256=facts.digest,
        outputs=tuple(item["topic_text"] for item in answers.get("publications") or ()),
        facts=tuple(
            line
            for line in answers.get("readme") or ()
            if line and "|" not in line and not line.startswith("#")
        )
        + tuple(
            f"{linked.element} {linked.id} has more links: the nearest are listed"
            for linked in (facts.links or {}).values()
            if linked.is_cut
        ),
        rows=_with_support(rows, facts, {e.claim or e.id: e.id for e in elements}),
        links=links.get(facts.path or "", ()),
    )


def _with_support(
    rows: Sequence[TraceRow], facts: MonitorFacts, published: Mapping[str, str]
) -> tuple[TraceRow, ...]:
    """Return claims with the links of what they rest on: these lead back to their hazards.

    Args:
        rows: the table.
        facts: of the monitor.
        published: name of a claim in messages -> its id.
    """
    linked = {row.id: row.links for row in rows if row.links}
    if not linked:
        return tuple(rows)
    resting = {published.get(claim.id, claim.id): claim.rests_on for claim in facts.claims}
    return tuple(
        replace(row, links=_all_links(row, linked, resting.get(row.id, ()))) for row in rows
    )


def _all_links(
    row: TraceRow, linked: Mapping[str, tuple[TraceLink, ...]], on: Iterable[str]
) -> tuple[TraceLink, ...]:
    found = {link.path: link for link in row.links}
    for name in sorted(on):
        for link in linked.get(name, ()):
            found.setdefault(link.path, replace(link, through=name))
    return tuple(found.values())


def _code(answers: Mapping[str, Any]) -> Iterable[tuple[str, str]]:
    """Yield (id of an element, method in which a person may write about it)."""
    for item in answers.get("inputs") or ():
        yield literal_eval(item["id"]), f"EDDIInput.process_{item['attribute']}"
    for module in answers.get("modules") or ():
        for method in module["methods"]:
            yield literal_eval(method["about"]), f"{module['name']}.{method['name']}"

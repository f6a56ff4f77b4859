"""The trace table of a package: which element of the model became what.

Everything comes from the package's answers, so the table describes what was generated, not what the
model contains today.
"""

from __future__ import annotations

import json
import re
from ast import literal_eval
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.kinds import JsonValue, kinds
from eddi_scaffold.packages.rendering import ANSWERS_FILE

_LINE = re.compile(r"line ([0-9]+)")
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
        model_sha256: digest of its ``model.json``, which the monitor checks when it starts.
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
            f"  model.json has sha256 {self.model_sha256}",
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
    except (AttributeError, KeyError, TypeError, ValueError) as damage:
        place = Place(f"{answers.get('package')}/{ANSWERS_FILE}")
        raise EddiError(problem("T005.damaged", place, answer=damage)) from None


def _trace_of(answers: Mapping[str, Any]) -> Trace:
    document = json.loads(answers["model_json"])
    code = dict(_code(answers))
    inputs = {item["id"]: item for item in document["inputs"]}
    config = _config(answers)
    topics = {item["id"]: item.get("topic", "") for item in config.get("SimulatorOutputs", ())}
    section = config.get("Model") or {}
    limits = [*(section.get("evidence") or ()), *(section.get("thresholds") or ())]
    configured = {limit["id"] for limit in limits} | inputs.keys()
    links = {path: _linked(link) for path, link in document.get("links", {}).items()}
    rows: list[TraceRow] = []
    published: dict[str, str] = {}
    elements = list(_elements(document["model"], in_eddi=bool(document["source"]["path"])))
    known = {item["id"] for _, item in elements}
    elements += [("input", item) for name, item in inputs.items() if name not in known]
    for element, item in elements:
        given = inputs.get(item["id"], {})
        published[item.get("class_name", item["id"])] = item["id"]
        heard = tuple(topics.get(name) or name for name in given.get("requires", ()))
        rows.append(
            TraceRow(
                element,
                item["id"],
                item.get("line"),
                item.get("path") or "",
                code.get(item["id"], ""),
                heard,
                tuple(one for at, of in links.items() if _is_in(at, item) for one in of),
                item.get("line") is None and item["id"] in configured,
            )
        )
    paths = [row.path for row in rows if row.path]
    whole = document["source"]["path"]
    for path, link in document.get("links", {}).items():
        if path != whole and not any(f"{path}/".startswith(f"{at}/") for at in paths):
            row = TraceRow(link["element"], link["id"], link["line"], path, links=links[path])
            rows = [other for other in rows if other.path or other.id != row.id] + [row]
    return Trace(
        package=answers["package"],
        kind=answers["kind"],
        model=document["id"],
        file=answers["model_file"],
        sha256=answers["model_sha256"],
        model_sha256=document["sha256"],
        outputs=tuple(item["topic_text"] for item in answers.get("publications") or ()),
        facts=tuple(
            line
            for line in answers.get("readme") or ()
            if line and "|" not in line and not line.startswith("#")
        )
        + tuple(
            f"{link['element']} {link['id']} has more links: the nearest are listed"
            for link in document.get("links", {}).values()
            if link.get("cut")
        ),
        rows=_with_support(rows, document, published),
        links=links.get(whole, ()),
    )


def _linked(one: Mapping[str, Any]) -> tuple[TraceLink, ...]:
    return tuple(
        TraceLink(link["class"], link["name"], link["line"], link["path"]) for link in one["links"]
    )


def _is_in(path: str, item: Mapping[str, Any]) -> bool:
    at = item.get("path")
    return bool(at) and f"{path}/".startswith(f"{at}/")


def _with_support(
    rows: Sequence[TraceRow], document: Mapping[str, Any], published: Mapping[str, str]
) -> tuple[TraceRow, ...]:
    """Return claims with the links of what they rest on: these lead back to their hazards.

    Args:
        rows: the table.
        document: ``config/model.json``.
        published: name of a claim in messages -> its id.
    """
    linked = {row.id: row.links for row in rows if row.links}
    if not linked:
        return tuple(rows)
    support = kinds()[document["kind"]].functions.support(document)
    resting = {published.get(name, name): inputs for name, inputs in support.items()}
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


def _config(answers: Mapping[str, Any]) -> Mapping[str, Any]:
    text = answers.get("config_json")
    found: Mapping[str, Any] = json.loads(text) if text else {}
    return found


def _elements(
    model: Mapping[str, Any], *, in_eddi: bool
) -> Iterable[tuple[str, Mapping[str, Any]]]:
    """Yield what has an id or a name, list by list in the order of their names."""
    for name, items in sorted(model.items()):
        for item in items if isinstance(items, Sequence) and not isinstance(items, str) else ():
            id_ = item.get("id", item.get("name")) if isinstance(item, dict) else None
            if isinstance(id_, str):
                line = _LINE.fullmatch(str(item.get("place")))
                of = {"line": int(line[1])} if line else {}
                yield name.removesuffix("s").replace("_", " "), {**of, **item, "id": id_}
    form = model.get("form") or {"outputs": []}  # of events: where the condition of each is
    for item in form["outputs"]:
        line = None if in_eddi else form["nodes"][item["node"]]["at"][0]  # of its own text there
        yield "event", {"id": item["id"], "line": line}
    if "reference" in model:  # of SafeML: the sample, a file of its own
        yield "reference", {"id": model["reference"]["name"]}


def _code(answers: Mapping[str, Any]) -> Iterable[tuple[str, str]]:
    """Yield (id of an element, method in which a person may write about it)."""
    for item in answers.get("inputs") or ():
        yield literal_eval(item["id"]), f"EDDIInput.process_{item['attribute']}"
    for module in answers.get("modules") or ():
        for method in module["methods"]:
            yield literal_eval(method["about"]), f"{module['name']}.{method['name']}"

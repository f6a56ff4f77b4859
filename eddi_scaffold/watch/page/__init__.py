"""The view as a page on this machine: texts, graph and pictures of a snapshot as HTML."""

from __future__ import annotations

import zlib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from eddi_scaffold.common.claims import State
from eddi_scaffold.common.escaping import xml_text
from eddi_scaffold.common.files import read_source
from eddi_scaffold.config.deployment_file import is_fleet
from eddi_scaffold.deployments.sites import sites_of
from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry, Tone, drawn
from eddi_scaffold.kinds import Model, kinds
from eddi_scaffold.monitors.loading import checked_models, is_config
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.watch.fleet import Change, MonitorView, RobotView, Snapshot, VerdictView
from eddi_scaffold.watch.text import Clock, because

SHOWN_CHANGES = 50


@dataclass(frozen=True)
class Row:
    """One verdict.

    Attributes:
        id: of its row in the page.
        monitor: its monitor.
        kind: of the monitor.
        name: id of the verdict.
        state: in words.
        why: why it is not active, or further facts.
        since: since when.
    """

    id: str
    monitor: str
    kind: str
    name: str
    state: str
    why: str
    since: str

    @property
    def parts(self) -> tuple[str, str, str]:
        """What may change while the row stays."""
        return self.state, self.why, self.since


@dataclass(frozen=True)
class Group:
    """One robot.

    Attributes:
        id: of its section in the page.
        number: its place.
        name: of the robot.
        summary: how many verdicts are in which state.
        rows: its verdicts.
        facts: lines about its monitors: what is accepted, what nodes report.
        graph: another number when its graph is another one.
    """

    id: str
    number: int
    name: str
    summary: str
    rows: tuple[Row, ...]
    facts: tuple[str, ...]
    graph: int


@dataclass(frozen=True)
class View:
    """The page.

    Attributes:
        time: of the snapshot.
        shape: another number when robots, monitors or verdicts came or went.
        groups: the robots.
        changes: number and line of the last changes, the newest first.
        notes: what else a person should know.
    """

    time: str
    shape: int
    groups: tuple[Group, ...]
    changes: tuple[tuple[int, str], ...]
    notes: tuple[str, ...]


def view_of(snapshot: Snapshot, clock: Clock, notes: tuple[str, ...] = ()) -> View:
    """Return what the page shows of a snapshot.

    Args:
        snapshot: of the fleet.
        clock: writes times.
        notes: of the source.
    """
    groups = tuple(_group(number, robot, clock) for number, robot in enumerate(snapshot.robots))
    names = [(group.name, [(r.monitor, r.kind, r.name) for r in group.rows]) for group in groups]
    changes = tuple(
        (snapshot.changed - k, _change(change, clock))
        for k, change in enumerate(snapshot.changes[:SHOWN_CHANGES])
    )
    return View(
        clock(snapshot.t).strip(), _number(names), groups, changes, (*notes, *snapshot.notes)
    )


def _group(number: int, robot: RobotView, clock: Clock) -> Group:
    rows = tuple(
        _row(f"v{number}-{k}-{n}", monitor, verdict, clock)
        for k, monitor in enumerate(robot.monitors)
        for n, verdict in enumerate(monitor.verdicts)
    )
    counted = Counter(row.state for row in rows)
    summary = ", ".join(f"{counted[s]} {s}" for s in ("active", "not active", "unknown"))
    facts = tuple(fact for monitor in robot.monitors for fact in _facts(monitor))
    drawn = [
        (monitor.name, monitor.silent, v.id, v.state, v.reasons)
        for monitor in robot.monitors
        for v in monitor.verdicts
    ]
    return Group(
        f"r{number}", number, robot.name, summary, rows, facts, _number([robot.name, drawn])
    )


def _row(id_: str, monitor: MonitorView, one: VerdictView, clock: Clock) -> Row:
    reasons = because(one.reasons)
    if one.state != "active" and monitor.report is not None:
        reasons = monitor.report.reasons.get(one.id, reasons)  # the same, with topics and ages
    why = "; ".join(part for part in (reasons, one.text) if part)
    since = clock(one.since).strip()
    return Row(
        id_,
        monitor.name,
        monitor.title,
        one.id,
        one.state,
        why,
        since if one.seen else f"≤ {since}",
    )


def _facts(monitor: MonitorView) -> list[str]:
    found = [f"{monitor.name} accepts {text}" for text in monitor.accepted]
    if monitor.report is not None:
        found.append(f"{monitor.name}: {monitor.report.message}")
    return found


def _change(one: Change, clock: Clock) -> str:
    why = f" ({because(one.reasons)})" if one.reasons else ""
    who = f"{one.robot} {one.monitor} {one.id}"
    return f"{clock(one.t).strip()} {who} is {one.state}{why}"


def _number(value: object) -> int:
    return zlib.crc32(repr(value).encode())


TITLE = "Fleet"
MARKS = {"active": "●", "not active": "✕", "unknown": "?"}
"""A state is told by its words and a mark, its colour only adds to them."""


def render(view: View) -> str:
    """Return the whole page."""
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{TITLE}</title>
<link rel="stylesheet" href="/style.css">
<script src="/page.js" defer></script>
<noscript><meta http-equiv="refresh" content="2"></noscript>
</head>
<body>
<a class="skip" href="#changes-title">Skip to the last changes</a>
{main(view)}
<p id="said" class="aside" role="status" aria-live="polite"></p>
</body>
</html>
"""


def main(view: View) -> str:
    """Return what a view fills."""
    empty = "" if view.groups else '<p id="empty">No monitor has been heard of yet.</p>\n'
    return f"""<main data-shape="{view.shape}">
<h1>{TITLE}</h1>
<p>At <span id="time">{xml_text(view.time)}</span>. <span id="link">Live.</span></p>
<ul id="notes">{"".join(f"<li>{xml_text(note)}</li>" for note in view.notes)}</ul>
{empty}{"".join(map(_group_html, view.groups))}<section aria-labelledby="changes-title">
<h2 id="changes-title" tabindex="-1">Last changes</h2>
<ol id="changes" reversed tabindex="0" aria-labelledby="changes-title">
{"".join(f'<li data-number="{number}">{xml_text(text)}</li>' for number, text in view.changes)}
</ol>
</section>
</main>"""


def _group_html(one: Group) -> str:
    name = xml_text(one.name)
    return f"""<section aria-labelledby="{one.id}">
<h2 id="{one.id}">{name}</h2>
<p id="{one.id}-summary">{xml_text(one.summary)}</p>
<details id="{one.id}-graph" open><summary>Graph</summary>
<img alt="Graph of the guarantees of {name}; the table says the same in words" \
src="/graph/{one.number}.svg?{one.graph}">
</details>
<table>
<caption class="aside">Guarantees of {name}</caption>
<thead><tr><th scope="col">Monitor</th><th scope="col">Guarantee</th><th scope="col">State</th>\
<th scope="col">Why</th><th scope="col">Since</th></tr></thead>
<tbody>
{"".join(map(_row_html, one.rows))}</tbody>
</table>
<details><summary>Monitors</summary><ul id="{one.id}-facts">\
{"".join(f"<li>{xml_text(fact)}</li>" for fact in one.facts)}</ul></details>
</section>
"""


def _row_html(one: Row) -> str:
    return (
        f'<tr id="{one.id}" data-state="{xml_text(one.state)}"><td>{xml_text(one.monitor)} '
        f'<span class="kind">{xml_text(one.kind)}</span></td>'
        f'<th scope="row">{xml_text(one.name)}</th>'
        f'<td><span class="state"><span aria-hidden="true">{MARKS[one.state]}</span> '
        f"<span>{xml_text(one.state)}</span></span></td>"
        f"<td>{xml_text(one.why)}</td><td>{xml_text(one.since)}</td></tr>\n"
    )


Pictures = Mapping[tuple[str, str], Diagram]
"""Title of the kind, name of the model -> its picture."""


def pictures_of(paths: Iterable[Path]) -> Pictures:
    """Return the pictures of the models in some files.

    Args:
        paths: models, configurations that name theirs, or deployment files.

    Raises:
        EddiError: a file cannot be read, or has errors.
    """
    found = {}
    for model in (model for path in paths for model in _models(path)):
        kind = kinds()[model.kind]
        picture = model.diagram()
        if picture is not None:
            found[kind.title, model.name] = picture
    return found


def _models(path: Path) -> Sequence[Model]:
    source = read_source(path)
    if is_fleet(source):
        sites, _ = sites_of(source, checked_models)
        return [monitor.model for site in sites for monitor in site.monitors]
    if is_config(source):
        monitors, _ = monitors_of(None, [path])
        return [monitor.model for monitor in monitors]
    return checked_models(path, ()).models


TONES: dict[State, Tone] = {"active": "output", "not active": "refused", "unknown": "warning"}
_LEGEND = (
    LegendEntry("monitor", "box", "neutral"),
    LegendEntry("active", "rounded", "output"),
    LegendEntry("not active", "rounded", "refused"),
    LegendEntry("unknown", "rounded", "warning"),
    LegendEntry("what it lacks", "ellipse", "refused"),
)
_LACKS = "lacks"
Part = DiagramNode | DiagramEdge


def verdict_graph(robot: RobotView, pictures: Pictures) -> str:
    """Return the SVG of a robot's verdicts.

    Args:
        robot: what is known of it.
        pictures: of the models that are known here; of others, only what monitors say is drawn.
    """
    parts = [
        part
        for number, monitor in enumerate(robot.monitors)
        for part in _parts(f"m{number}", monitor, pictures.get((monitor.title, monitor.name)))
    ]
    nodes = tuple(part for part in parts if isinstance(part, DiagramNode))
    edges = tuple(part for part in parts if isinstance(part, DiagramEdge))
    text = "below a monitor its guarantees, below these what they rest on, or lack"
    return drawn(Diagram(robot.name, nodes, edges, "up", _LEGEND, text))


def _parts(key: str, monitor: MonitorView, picture: Diagram | None) -> Iterator[Part]:
    lines = (monitor.name, "silent" if monitor.silent else monitor.title)
    yield DiagramNode(key, lines, "box", "neutral")
    for verdict in monitor.verdicts:
        yield DiagramEdge(f"{key} {verdict.id}", key, arrow=False)
    if picture is not None and fits(monitor, picture):
        yield from _of_model(key, monitor, picture)
    else:
        yield from _of_words(key, monitor)


def fits(monitor: MonitorView, picture: Diagram) -> bool:
    """Return whether the picture has all that the monitor says: else it is of another version."""
    return {verdict.id for verdict in monitor.verdicts} <= {node.id for node in picture.nodes}


def _of_model(key: str, monitor: MonitorView, picture: Diagram) -> Iterator[Part]:
    """Yield the picture of the model, with what the monitor says."""
    states = {verdict.id: verdict.state for verdict in monitor.verdicts}
    lacking = {reason for verdict in monitor.verdicts for reason in verdict.reasons}
    for node in picture.nodes:
        head, *rest = node.lines
        made = replace(node, id=f"{key} {node.id}")
        if node.id in states:
            state = states[node.id]
            made = replace(made, lines=(head, state, *rest), tone=TONES[state])
        elif node.id in lacking:
            made = replace(made, lines=(head, _LACKS, *rest), tone="refused")
        yield made
    for edge in picture.edges:
        yield replace(edge, source=f"{key} {edge.source}", target=f"{key} {edge.target}")


def _of_words(key: str, monitor: MonitorView) -> Iterator[Part]:
    """Yield verdicts, and the reasons that they have."""
    lacking: dict[str, list[str]] = {}
    for verdict in monitor.verdicts:
        id_ = f"{key} {verdict.id}"
        yield DiagramNode(id_, (verdict.id, verdict.state), "rounded", TONES[verdict.state])
        for reason in verdict.reasons if not monitor.silent else ():
            lacking.setdefault(reason, []).append(id_)
    for reason, users in lacking.items():
        id_ = f"{key} lacks {reason}"
        yield DiagramNode(id_, (reason, _LACKS), "ellipse", "refused")
        for user in users:
            yield DiagramEdge(id_, user)

"""The view as a page: a snapshot as HTML, over HTTP on the loopback interface only."""

from __future__ import annotations

import json
import re
import threading
import time
import zlib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from http import HTTPStatus
from importlib.resources import files
from typing import Any

from eddi_scaffold.common import local_server
from eddi_scaffold.common.claims import State
from eddi_scaffold.common.escaping import xml_text
from eddi_scaffold.common.local_server import CSS, HTML, JAVASCRIPT, Handler, LimitedServer, Refused
from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry, Tone
from eddi_scaffold.diagrams.svg import drawn
from eddi_scaffold.watch.fleet import MonitorView, RobotView, Snapshot, VerdictView
from eddi_scaffold.watch.following import CONTENT_TYPE, Clock, metrics_text

SHOWN_CHANGES = 50


@dataclass(frozen=True)
class Row:
    """One verdict: its place in the page, of which monitor, and what may change of it."""

    id: str
    monitor: str
    kind: str
    name: str
    parts: tuple[str, str, str]  # state, why or further facts, since when


@dataclass(frozen=True)
class Group:
    """One robot."""

    number: int  # its place
    name: str
    summary: str  # how many verdicts are in which state
    rows: tuple[Row, ...]
    facts: tuple[str, ...]  # lines about its monitors: what is accepted, what nodes report
    graph: int  # another number when its graph is another one

    @property
    def id(self) -> str:
        """Of its section in the page."""
        return f"r{self.number}"


@dataclass(frozen=True)
class View:
    """The page."""

    snapshot: Snapshot
    time: str  # of the snapshot
    shape: int  # another number when robots, monitors or verdicts came or went
    groups: tuple[Group, ...]
    changes: tuple[tuple[int, str], ...]  # number and line of the last changes, the newest first
    notes: tuple[str, ...]  # what else a person should know

    def news(self, previous: View | None) -> dict[str, Any]:
        """Return for the script of the page what an earlier view has not, or has otherwise."""
        groups = {} if previous is None else {group.id: group for group in previous.groups}
        rows = {row for group in groups.values() for row in group.rows}
        change = previous.changes[0][0] if previous is not None and previous.changes else 0
        return {
            "time": self.time,
            "shape": self.shape,
            "rows": {r.id: r.parts for group in self.groups for r in group.rows if r not in rows},
            "groups": [
                {"id": g.id, "number": g.number, "summary": g.summary}
                | {"facts": g.facts, "graph": g.graph}
                for g in self.groups
                if groups.get(g.id) != g
            ],
            "changes": [entry for entry in self.changes if entry[0] > change],
            "notes": self.notes,
        }


def view_of(snapshot: Snapshot, clock: Clock, notes: Sequence[str] = ()) -> View:
    """Return what the page shows of a snapshot, and of the notes of its source."""
    groups = tuple(_group(number, robot, clock) for number, robot in enumerate(snapshot.robots))
    names = [(group.name, [(r.monitor, r.kind, r.name) for r in group.rows]) for group in groups]
    changes = []
    for index, change in enumerate(snapshot.changes[:SHOWN_CHANGES]):
        why = f" ({', '.join(change.reasons)})" if change.reasons else ""
        what = f"{change.robot} {change.monitor} {change.id} is {change.state}{why}"
        changes.append((snapshot.changed - index, f"{clock(change.t).strip()} {what}"))
    time = clock(snapshot.t).strip()
    return View(snapshot, time, _number(names), groups, tuple(changes), (*notes, *snapshot.notes))


def _group(number: int, robot: RobotView, clock: Clock) -> Group:
    rows, facts, graph = [], [], []
    for index, monitor in enumerate(robot.monitors):
        for place, verdict in enumerate(monitor.verdicts):
            row_id, since = f"v{number}-{index}-{place}", clock(verdict.since).strip()
            parts = (verdict.state, _why(monitor, verdict), since if verdict.seen else f"≤ {since}")
            rows.append(Row(row_id, monitor.name, monitor.title, verdict.id, parts))
            graph.append((monitor.name, monitor.silent, verdict.id, verdict.state, verdict.reasons))
        facts += [f"{monitor.name} accepts {text}" for text in monitor.accepted]
        if monitor.report is not None:
            facts.append(f"{monitor.name}: {monitor.report.message}")
    counts = Counter(row.parts[0] for row in rows)
    summary = ", ".join(f"{counts[state]} {state}" for state in MARKS)
    key = _number([robot.name, graph])
    return Group(number, robot.name, summary, tuple(rows), tuple(facts), key)


def _why(monitor: MonitorView, verdict: VerdictView) -> str:
    reasons = ", ".join(verdict.reasons)
    if verdict.state != "active" and monitor.report is not None:
        reasons = monitor.report.reasons.get(verdict.id, reasons)  # the same, with topics and ages
    return "; ".join(part for part in (reasons, verdict.text) if part)


def _number(value: object) -> int:
    return zlib.crc32(repr(value).encode())


# a state is told by its words and a mark, its colour only adds to them
MARKS = {"active": "●", "not active": "✕", "unknown": "?"}


def render(view: View) -> str:
    """Return the whole page."""
    empty = "" if view.groups else "No monitor has been heard of yet."
    return _filled(
        "page",
        {"time": view.time, "shape": view.shape, "empty": empty},
        notes="".join(f"<li>{xml_text(note)}</li>" for note in view.notes),
        groups="".join(map(_group_html, view.groups)),
        changes="".join(
            f'<li data-number="{number}">{xml_text(text)}</li>' for number, text in view.changes
        ),
    )


@cache
def static(name: str) -> bytes:
    """Return a file that belongs to the page."""
    return files(__package__).joinpath("static", name).read_bytes()


def _filled(template: str, texts: Mapping[str, object], **html: str) -> str:
    escaped = {name: xml_text(str(text)) for name, text in texts.items()}
    return static(f"{template}.html").decode().format_map({**escaped, **html})


def _group_html(group: Group) -> str:
    rows = []
    for row in group.rows:
        state, why, since = row.parts
        texts = {**vars(row), "mark": MARKS[state], "state": state, "why": why, "since": since}
        rows.append(_filled("verdict", texts))
    facts = "".join(f"<li>{xml_text(fact)}</li>" for fact in group.facts)
    texts = {key: getattr(group, key) for key in ("id", "number", "name", "summary", "graph")}
    return _filled("robot", texts, rows="".join(rows), facts=facts)


Pictures = Mapping[tuple[str, str], Diagram]  # title of the kind, name of the model -> its picture


TONES: dict[State, Tone] = {"active": "output", "not active": "refused", "unknown": "warning"}
_LEGEND = (
    LegendEntry("monitor", "box", "neutral"),
    *(LegendEntry(state, "rounded", tone) for state, tone in TONES.items()),
    LegendEntry("what it lacks", "ellipse", "refused"),
)
Part = DiagramNode | DiagramEdge


def verdict_graph(robot: RobotView, pictures: Pictures) -> str:
    """Return the SVG of a robot's verdicts; of models not known here, what monitors say."""
    nodes, edges = [], []
    for number, monitor in enumerate(robot.monitors):
        for part in _parts(f"m{number}", monitor, pictures.get((monitor.title, monitor.name))):
            if isinstance(part, DiagramNode):
                nodes.append(part)
            else:
                edges.append(part)
    text = "below a monitor its guarantees, below these what they rest on, or lack"
    return drawn(Diagram(robot.name, tuple(nodes), tuple(edges), "up", _LEGEND, text))


def _parts(key: str, monitor: MonitorView, picture: Diagram | None) -> Iterator[Part]:
    lines = (monitor.name, "silent" if monitor.silent else monitor.title)
    yield DiagramNode(key, lines, "box", "neutral")
    states = {verdict.id: verdict.state for verdict in monitor.verdicts}
    for id_ in states:
        yield DiagramEdge(f"{key} {id_}", key, arrow=False)
    lacking: dict[str, list[str]] = {}
    for verdict in monitor.verdicts if not monitor.silent else ():
        for reason in verdict.reasons:
            lacking.setdefault(reason, []).append(f"{key} {verdict.id}")
    if picture is not None and states.keys() <= {node.id for node in picture.nodes}:
        yield from _of_model(key, states, lacking, picture)
        return
    for id_, state in states.items():  # no picture, or one of another version
        yield DiagramNode(f"{key} {id_}", (id_, state), "rounded", TONES[state])
    for reason, users in lacking.items():
        lacks = f"{key} lacks {reason}"
        yield DiagramNode(lacks, (reason, "lacks"), "ellipse", "refused")
        for user in users:
            yield DiagramEdge(lacks, user)


def _of_model(
    key: str, states: Mapping[str, State], lacking: Iterable[str], picture: Diagram
) -> Iterator[Part]:
    """Yield the picture of the model, with what the monitor says."""
    for node in picture.nodes:
        head, *rest = node.lines
        node_here = replace(node, id=f"{key} {node.id}")
        if node.id in states:
            state = states[node.id]
            node_here = replace(node_here, lines=(head, state, *rest), tone=TONES[state])
        elif node.id in lacking:
            node_here = replace(node_here, lines=(head, "lacks", *rest), tone="refused")
        yield node_here
    for edge in picture.edges:
        yield replace(edge, source=f"{key} {edge.source}", target=f"{key} {edge.target}")


STREAMS = 16  # at once; the other connections are for pages
_STREAM_S = 600.0  # after which a stream ends; a browser opens it anew
_ALIVE_S = 5.0
_PICTURES = 64
_OLD_S = 10.0
"""After which numbers are not given any more: the view hangs, or the recording has ended."""
_FILES = {"/style.css": CSS, "/page.js": JAVASCRIPT}
_GRAPH = re.compile(r"/graph/([0-9]{1,5})\.svg")
_POLICY = (
    "default-src 'none'; style-src 'self'; script-src 'self'; img-src 'self'; "
    "connect-src 'self'; form-action 'none'; base-uri 'none'; frame-ancestors 'none'"
)


class Feed:
    """Holds the newest view, for all who look at it."""

    def __init__(self, view: View) -> None:
        self._news = threading.Condition()
        self.view, self.since = view, time.monotonic()
        self.closed = False

    def show(self, view: View) -> None:
        """Replace what is shown, and wake who waits for it."""
        with self._news:
            self.view, self.since = view, time.monotonic()
            self._news.notify_all()

    def after(self, view: View | None, seconds: float) -> View:
        """Return the newest, and wait for it as long as it is one that was shown already."""
        with self._news:
            self._news.wait_for(lambda: self.closed or self.view is not view, seconds)
            return self.view

    def close(self) -> None:
        """Let everybody who waits go."""
        with self._news:
            self.closed = True
            self._news.notify_all()


def open_server(
    port: int,
    feed: Feed,
    models: Pictures | None = None,
    *,
    seconds: float = 20.0,
    connections: int = 32,
) -> LimitedServer:
    """Return a server of the page on a port (0: any that is free), not serving yet.

    Within some seconds a request has come, and an answer or event is taken; who connects when there
    are too many is asked to retry.

    Raises:
        EddiError: the port is taken (E024).
    """
    parts: dict[str, Any] = {"feed": feed, "models": models or {}, "pictures": {}}
    parts["streams"] = threading.Semaphore(min(STREAMS, connections // 2))
    parts["seconds"] = seconds
    return local_server.open_server(port, _Handler, parts, connections=connections)


class _Handler(Handler):
    feed: Feed
    streams: threading.Semaphore
    models: Pictures
    pictures: dict[int, bytes]
    policy = _POLICY

    def get(self) -> None:
        """Answer with the page, a part of it, its events, or numbers."""
        path, view = self.path.partition("?")[0], self.feed.view
        if path == "/":
            self.send(HTTPStatus.OK, HTML, render(view).encode())
        elif path == "/events":
            self._stream()
        elif path in _FILES:
            self.send(HTTPStatus.OK, _FILES[path], static(path[1:]))
        elif path == "/metrics":
            if time.monotonic() - self.feed.since > _OLD_S:
                raise Refused(HTTPStatus.SERVICE_UNAVAILABLE, "the view is not new any more")
            self.send(HTTPStatus.OK, CONTENT_TYPE, metrics_text(view.snapshot).encode())
        elif match := _GRAPH.fullmatch(path):
            self._graph(view, int(match[1]))
        else:
            super().get()

    def _graph(self, view: View, number: int) -> None:
        if number >= len(view.groups):
            raise Refused(HTTPStatus.NOT_FOUND, "there is no such robot")
        version = view.groups[number].graph
        if version not in self.pictures:
            if len(self.pictures) >= _PICTURES:
                self.pictures.clear()
            graph = verdict_graph(view.snapshot.robots[number], self.models)
            self.pictures[version] = graph.encode()
        more = {"Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'"}
        self.send(HTTPStatus.OK, "image/svg+xml", self.pictures[version], more)

    def _stream(self) -> None:
        if not self.streams.acquire(blocking=False):
            raise Refused(HTTPStatus.SERVICE_UNAVAILABLE, "too many pages are open")
        try:
            self.begin(HTTPStatus.OK, "text/event-stream", {})
            end, sent = time.monotonic() + _STREAM_S, None
            while time.monotonic() < end and not self.feed.closed:
                view = self.feed.after(sent, _ALIVE_S)
                text = ": nothing new\n\n"
                if view is not sent:
                    text, sent = f"data: {json.dumps(view.news(sent))}\n\n", view
                self.more_time()
                self.wfile.write(text.encode())
        finally:
            self.streams.release()

"""The view as a page: a snapshot as HTML, over HTTP on the loopback interface only."""

from __future__ import annotations

import json
import re
import threading
import time
import zlib
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from http import HTTPStatus
from http.server import ThreadingHTTPServer
from importlib.resources import files

from eddi_scaffold.common import local_server
from eddi_scaffold.common.escaping import xml_text
from eddi_scaffold.common.local_server import CSS, HTML, JAVASCRIPT, Handler, Refused
from eddi_scaffold.diagrams.svg import drawn
from eddi_scaffold.watch.fleet import RobotView, Snapshot
from eddi_scaffold.watch.following import CONTENT_TYPE, Clock, metrics_text
from eddi_scaffold.watch.robot_graph import robot_graph

SHOWN_CHANGES = 50
# a state is told by its words and a mark, its colour only adds to them
MARKS = {"active": "●", "not active": "✕", "unknown": "?"}


@dataclass(frozen=True)
class View:
    """What is shown."""

    snapshot: Snapshot
    clock: Clock
    notes: Sequence[str] = ()  # of the source

    @cached_property
    def page(self) -> str:
        """The page, as HTML."""
        snapshot, changes = self.snapshot, []
        for index, change in enumerate(snapshot.changes[:SHOWN_CHANGES]):
            why = f" ({', '.join(change.reasons)})" if change.reasons else ""
            what = f"{change.robot} {change.monitor} {change.id} is {change.state}{why}"
            text = xml_text(f"{self.time(change.t)} {what}")
            changes.append(f'<li data-number="{snapshot.changed - index}">{text}</li>')
        return _filled(
            "page",
            {"time": self.time(snapshot.t)},
            notes=_items((*self.notes, *snapshot.notes)),
            robots="".join(self._robot(*numbered) for numbered in enumerate(snapshot.robots)),
            changes="".join(changes),
        )

    def time(self, t: float) -> str:
        """Return a time as a person reads it."""
        return self.clock(t).strip()

    def _robot(self, number: int, robot: RobotView) -> str:
        rows, facts, counts = [], [], Counter[str]()
        for monitor in robot.monitors:
            for verdict in monitor.verdicts:
                why, since = ", ".join(verdict.reasons), self.time(verdict.since)
                told = verdict.why.sentence if verdict.why and verdict.why.causes else ""
                why = told or ("" if verdict.word == "absent" else why)
                why = "; ".join(filter(None, (why, verdict.text)))
                texts = {
                    "monitor": monitor.name, "kind": monitor.title, "name": verdict.id,
                    "state": verdict.word, "good": verdict.good, "mark": MARKS[verdict.good],
                    "why": why, "since": since if verdict.seen else f"≤ {since}",
                }  # fmt: skip
                rows.append(_filled("verdict", texts))
                counts[verdict.word] += 1
            facts += [f"{monitor.name} accepts {text}" for text in monitor.accepted]
            if monitor.report is not None and not monitor.silent:
                facts.append(f"{monitor.name}: {monitor.report.message}")
        words = [*MARKS, *(word for word in ("absent", "present") if counts[word])]
        summary = ", ".join(f"{counts[word]} {word}" for word in words)
        # another number for another graph, so that a browser asks for it anew
        graph = zlib.crc32(repr(robot_graph(robot)).encode())
        head = {"number": number, "name": robot.name, "summary": summary, "graph": graph}
        return _filled("robot", head, rows="".join(rows), facts=_items(facts))


def _items(texts: Iterable[str]) -> str:
    return "".join(f"<li>{xml_text(text)}</li>" for text in texts)


def _filled(template: str, texts: Mapping[str, object], **html: str) -> str:
    escaped = {name: xml_text(str(text)) for name, text in texts.items()}
    return static(f"{template}.html").decode().format_map({**escaped, **html})


@cache
def static(name: str) -> bytes:
    """Return a file that belongs to the page."""
    return files(__package__).joinpath("static", name).read_bytes()


STREAMS = 16  # at once
_STREAM_S = 600.0  # after which a stream ends; a browser opens it anew
_ALIVE_S = 5.0
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

    def show(self, view: View) -> None:
        """Replace what is shown, and wake who waits for it."""
        with self._news:
            self.view, self.since = view, time.monotonic()
            self._news.notify_all()

    def after(self, view: View | None, seconds: float) -> View:
        """Return the newest, and wait for it as long as it is one that was shown already."""
        with self._news:
            self._news.wait_for(lambda: self.view is not view, seconds)
            return self.view


def open_server(port: int, feed: Feed) -> ThreadingHTTPServer:
    """Return a server of the page on a port (0: any that is free), not serving yet.

    Raises:
        EddiError: the port is taken (E024).
    """
    parts = {"feed": feed, "streams": threading.Semaphore(STREAMS)}
    return local_server.open_server(port, _Handler, parts)


class _Handler(Handler):
    feed: Feed
    streams: threading.Semaphore
    policy = _POLICY

    def get(self) -> None:
        """Answer with the page, a part of it, its events, or numbers."""
        path, view = self.path.partition("?")[0], self.feed.view
        if path == "/":
            self.send(HTTPStatus.OK, HTML, view.page.encode())
        elif path == "/events":
            self._stream()
        elif path in _FILES:
            self.send(HTTPStatus.OK, _FILES[path], static(path[1:]))
        elif path == "/metrics":
            if time.monotonic() - self.feed.since > _OLD_S:
                raise Refused(HTTPStatus.SERVICE_UNAVAILABLE, "the view is not new any more")
            self.send(HTTPStatus.OK, CONTENT_TYPE, metrics_text(view.snapshot).encode())
        elif match := _GRAPH.fullmatch(path):
            if int(match[1]) >= len(view.snapshot.robots):
                raise Refused(HTTPStatus.NOT_FOUND, "there is no such robot")
            picture = drawn(robot_graph(view.snapshot.robots[int(match[1])])).encode()
            more = {"Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'"}
            self.send(HTTPStatus.OK, "image/svg+xml", picture, more)
        else:
            super().get()

    def _stream(self) -> None:
        if not self.streams.acquire(blocking=False):
            raise Refused(HTTPStatus.SERVICE_UNAVAILABLE, "too many pages are open")
        try:
            self.begin(HTTPStatus.OK, "text/event-stream", {})
            end, sent = time.monotonic() + _STREAM_S, None
            while time.monotonic() < end:
                view = self.feed.after(sent, _ALIVE_S)
                text = ": nothing new" if view is sent else f"data: {json.dumps(view.page)}"
                sent = view
                self.wfile.write(f"{text}\n\n".encode())
        finally:
            self.streams.release()

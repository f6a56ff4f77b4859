"""The page over HTTP, on the loopback interface only; it takes nothing from anybody."""

from __future__ import annotations

import json
import re
import threading
import time
from dataclasses import dataclass
from http import HTTPStatus
from typing import Any

from eddi_scaffold.common import local_server
from eddi_scaffold.common.local_server import CSS, HTML, JAVASCRIPT, Handler, LimitedServer, Refused
from eddi_scaffold.watch.fleet import Snapshot
from eddi_scaffold.watch.metrics import CONTENT_TYPE, metrics_text
from eddi_scaffold.watch.page import Pictures, View, render, static, verdict_graph

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


@dataclass(frozen=True)
class Shown:
    """A snapshot and its view; how many there were before; when, on the monotonic clock."""

    snapshot: Snapshot
    view: View
    number: int
    at: float


class Feed:
    """Holds the newest view, for all who look at it."""

    def __init__(self, snapshot: Snapshot, view: View) -> None:
        self._news = threading.Condition()
        self.shown = Shown(snapshot, view, 0, time.monotonic())
        self.closed = False

    def show(self, snapshot: Snapshot, view: View) -> None:
        """Replace what is shown, and wake who waits for it."""
        with self._news:
            self.shown = Shown(snapshot, view, self.shown.number + 1, time.monotonic())
            self._news.notify_all()

    def after(self, number: int, seconds: float) -> Shown:
        """Return the newest, and wait for it as long as it is not newer than a number."""
        with self._news:
            self._news.wait_for(lambda: self.closed or self.shown.number > number, seconds)
            return self.shown

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
        path, shown = self.path.partition("?")[0], self.feed.shown
        if path == "/":
            self.send(HTTPStatus.OK, HTML, render(shown.view).encode())
        elif path == "/events":
            self._stream()
        elif path in _FILES:
            self.send(HTTPStatus.OK, _FILES[path], static(path[1:]))
        elif path == "/metrics":
            if time.monotonic() - shown.at > _OLD_S:
                raise Refused(HTTPStatus.SERVICE_UNAVAILABLE, "the view is not new any more")
            self.send(HTTPStatus.OK, CONTENT_TYPE, metrics_text(shown.snapshot).encode())
        elif match := _GRAPH.fullmatch(path):
            self._graph(shown, int(match[1]))
        else:
            super().get()

    def _graph(self, shown: Shown, number: int) -> None:
        if number >= len(shown.view.groups):
            raise Refused(HTTPStatus.NOT_FOUND, "there is no such robot")
        version = shown.view.groups[number].graph
        if version not in self.pictures:
            if len(self.pictures) >= _PICTURES:
                self.pictures.clear()
            graph = verdict_graph(shown.snapshot.robots[number], self.models)
            self.pictures[version] = graph.encode()
        more = {"Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'"}
        self.send(HTTPStatus.OK, "image/svg+xml", self.pictures[version], more)

    def _stream(self) -> None:
        if not self.streams.acquire(blocking=False):
            raise Refused(HTTPStatus.SERVICE_UNAVAILABLE, "too many pages are open")
        try:
            self.begin(HTTPStatus.OK, "text/event-stream", {})
            end, number, sent = time.monotonic() + _STREAM_S, -1, None
            while time.monotonic() < end and not self.feed.closed:
                shown = self.feed.after(number, _ALIVE_S)
                text = ": nothing new\n\n"
                if shown.number > number:
                    text = f"data: {json.dumps(shown.view.news(sent))}\n\n"
                    number, sent = shown.number, shown.view
                self.more_time()
                self.wfile.write(text.encode())
        finally:
            self.streams.release()

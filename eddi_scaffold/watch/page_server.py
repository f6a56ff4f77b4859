"""The page over HTTP, on the loopback interface only; it takes nothing from anybody."""

from __future__ import annotations

import json
import re
import threading
import time
from http import HTTPStatus
from typing import Any

from eddi_scaffold.common import local_server
from eddi_scaffold.common.local_server import CSS, HTML, JAVASCRIPT, Handler, LimitedServer, Refused
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

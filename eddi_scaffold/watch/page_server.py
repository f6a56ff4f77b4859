"""The page over HTTP, on the loopback interface only; it takes nothing from anybody."""

from __future__ import annotations

import json
import re
import threading
import time
from http import HTTPStatus
from importlib.resources import files
from typing import Any

from eddi_scaffold.common import local_server
from eddi_scaffold.common.local_server import CSS, HTML, JAVASCRIPT, Handler, LimitedServer, Refused
from eddi_scaffold.watch.page import Pictures, render, verdict_graph
from eddi_scaffold.watch.page_feed import Feed, Sent

STREAMS = 16
"""At once; the other connections are for pages."""
_STREAM_S = 600.0
"""After which a stream ends; a browser opens it anew."""
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


def open_server(
    port: int,
    feed: Feed,
    models: Pictures | None = None,
    *,
    seconds: float = 20.0,
    connections: int = 32,
) -> LimitedServer:
    """Return a server of the page, not serving yet.

    Args:
        port: 0 for any that is free.
        feed: what is shown.
        models: pictures of known models, for the graphs.
        seconds: within which a request has come, and an answer or event is taken.
        connections: at once; a further one is asked to retry.

    Raises:
        EddiError: the port is taken (E024).
    """
    streams = threading.Semaphore(min(STREAMS, connections // 2))
    parts: dict[str, Any] = {
        "feed": feed,
        "streams": streams,
        "models": models or {},
        "pictures": {},
    }
    parts["seconds"] = seconds
    return local_server.open_server(port, _Handler, parts, connections=connections)


class _Handler(Handler):
    """Answers one connection."""

    feed: Feed
    streams: threading.Semaphore
    models: Pictures
    pictures: dict[int, bytes]
    policy = _POLICY

    def get(self) -> None:
        """Answer with the page, a part of it, or its events."""
        path = self.path.partition("?")[0]
        found = _GRAPH.fullmatch(path)
        if path == "/":
            self.send(HTTPStatus.OK, HTML, render(self.feed.shown.view).encode())
        elif path == "/events":
            self._stream()
        elif found:
            self._graph(int(found[1]))
        elif path == "/metrics":
            self._metrics()
        elif path in _FILES:
            data = files(__package__).joinpath("page", path[1:]).read_bytes()
            self.send(HTTPStatus.OK, _FILES[path], data)
        else:
            super().get()

    def _graph(self, number: int) -> None:
        shown = self.feed.shown
        if number >= len(shown.view.groups):
            raise Refused(HTTPStatus.NOT_FOUND, "there is no such robot")
        version = shown.view.groups[number].graph
        if version not in self.pictures:
            if len(self.pictures) >= _PICTURES:
                self.pictures.clear()
            self.pictures[version] = verdict_graph(
                shown.snapshot.robots[number], self.models
            ).encode()
        more = {"Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'"}
        self.send(HTTPStatus.OK, "image/svg+xml", self.pictures[version], more)

    def _metrics(self) -> None:
        try:
            from eddi_scaffold.watch.metrics import CONTENT_TYPE, exposed  # noqa: PLC0415
        except ImportError:
            text = "metrics need prometheus-client: pipx inject eddi-scaffold prometheus-client"
            raise Refused(HTTPStatus.NOT_IMPLEMENTED, text) from None
        shown = self.feed.shown
        if time.monotonic() - shown.at > _OLD_S:
            raise Refused(HTTPStatus.SERVICE_UNAVAILABLE, "the view is not new any more")
        self.send(HTTPStatus.OK, CONTENT_TYPE, exposed(shown.snapshot))

    def _stream(self) -> None:
        if not self.streams.acquire(blocking=False):
            raise Refused(HTTPStatus.SERVICE_UNAVAILABLE, "too many pages are open")
        try:
            self.begin(HTTPStatus.OK, "text/event-stream", {})
            self._write_events(time.monotonic() + _STREAM_S)
        finally:
            self.streams.release()

    def _write_events(self, end: float) -> None:
        number, sent = -1, Sent()
        while time.monotonic() < end and not self.feed.closed:
            shown = self.feed.after(number, _ALIVE_S)
            text = ": nothing new\n\n"
            if shown.number > number:
                number = shown.number
                text = f"data: {json.dumps(sent.news(shown.view))}\n\n"
            self.more_time()
            self.wfile.write(text.encode())

"""Pages for a person on this machine: served on the loopback interface only."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from eddi_scaffold.common.problems import EddiError, problem

HOST = "127.0.0.1"
HTML = "text/html; charset=utf-8"
CSS = "text/css; charset=utf-8"
JAVASCRIPT = "text/javascript; charset=utf-8"
MAX_BODY = 64 * 1024
_DRAINED = 4 * 1024 * 1024
"""Bytes of a body that is too long which are still read, so that the answer arrives."""
_LENGTH = re.compile(r"[0-9]{1,18}")
_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    # With no-referrer, browsers send forms with the origin "null", which is refused below.
    "Referrer-Policy": "same-origin",
    "Cache-Control": "no-store",
}


def open_server(port: int, handler: type[Handler], parts: Mapping[str, Any]) -> ThreadingHTTPServer:
    """Return a server on the loopback interface that does not serve yet; E024: port taken."""
    try:
        return ThreadingHTTPServer((HOST, port), type("Handler", (handler,), dict(parts)))
    except OSError as failure:
        raise EddiError(problem("E024", port=port, reason=failure.strerror or failure)) from None


class Refused(Exception):  # noqa: N818 - an answer, not an error
    """The answer is no."""

    def __init__(self, status: HTTPStatus, text: str) -> None:
        super().__init__(text)
        self.status, self.text = status, text


class Handler(BaseHTTPRequestHandler):
    """Answers one connection."""

    server: ThreadingHTTPServer
    timeout = 20.0  # seconds in which nothing comes, or is taken, and the connection ends
    policy: str  # what a page may load
    server_version = "eddi-scaffold"
    sys_version = ""

    def do_GET(self) -> None:
        """Answer, or say why not."""
        self.guarded(self.get)

    def do_POST(self) -> None:
        """Answer, or say why not."""
        self.guarded(self.post)

    def get(self) -> None:
        """Refuse: there is nothing at this path."""
        raise Refused(HTTPStatus.NOT_FOUND, "there is nothing here")

    post = get

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002 - its name there
        """Log nothing: the terminal belongs to the command."""

    def guarded(self, respond: Callable[[], None]) -> None:
        """Answer, or say why not."""
        try:
            self._check_origin()
            respond()
        except Refused as refused:
            self.close_connection = True
            self.send(refused.status, "text/plain; charset=utf-8", f"{refused.text}\n".encode())
        except (ConnectionError, TimeoutError):
            self.close_connection = True

    def _check_origin(self) -> None:
        """Refuse what a page from elsewhere sends, also by a name that it points at us."""
        hosts, port = self.headers.get_all("Host", []), self.server.server_port
        host = hosts[0] if len(hosts) == 1 else ""
        names = (HOST, "localhost")
        if host not in [*(f"{name}:{port}" for name in names), *(names if port == 80 else ())]:
            raise Refused(HTTPStatus.FORBIDDEN, "this page is for localhost only")
        origin = self.headers.get("Origin")
        if origin not in (None, "null", f"http://{host}") or (
            origin == "null" and self.command == "POST"
        ):
            raise Refused(HTTPStatus.FORBIDDEN, "this page takes no orders from another one")

    def body(self) -> bytes:
        """Return what was sent; Refused if it is too long, or shorter than was said."""
        stated = self.headers.get("Content-Length", "")
        if not _LENGTH.fullmatch(stated):
            raise Refused(HTTPStatus.BAD_REQUEST, "the Content-Length is not a number of bytes")
        length = int(stated)
        if length > MAX_BODY:
            self.rfile.read(min(length, _DRAINED))
            text = f"more than {MAX_BODY} bytes are not taken: go back and shorten the text"
            raise Refused(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, text)
        body = self.rfile.read(length)
        if len(body) < length:
            raise Refused(HTTPStatus.BAD_REQUEST, "the body is shorter than its Content-Length")
        return body

    def send(
        self, status: HTTPStatus, kind: str, data: bytes, more: Mapping[str, str] | None = None
    ) -> None:
        """Send a whole answer."""
        self.begin(status, kind, {"Content-Length": str(len(data)), **(more or {})})
        self.wfile.write(data)

    def begin(self, status: HTTPStatus, kind: str, more: Mapping[str, str]) -> None:
        """Send the head of an answer."""
        self.send_response(status)
        headers = {"Content-Type": kind, "Content-Security-Policy": self.policy, **_HEADERS}
        for name, value in {**headers, **more}.items():
            self.send_header(name, value)
        self.end_headers()

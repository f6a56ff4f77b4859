"""Pages for a person on this machine: served on the loopback interface, with limits."""

from __future__ import annotations

import re
import socket
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from io import BufferedReader, RawIOBase
from typing import Any

from eddi_scaffold.common.problems import EddiError, problem

_BUSY = b"HTTP/1.0 503 Service Unavailable\r\nContent-Length: 0\r\nRetry-After: 5\r\n\r\n"


class TimedInput(RawIOBase):
    """What comes over a connection, until its time is over: however slowly it drips."""

    def __init__(self, connection: socket.socket, seconds: float) -> None:
        self._connection = connection
        self._end = time.monotonic() + seconds

    def readable(self) -> bool:
        """Return True: it can be read."""
        return True

    def readinto(self, buffer: Any) -> int:
        """Wait for more, as long as there is time (TimeoutError)."""
        self.limit()
        return self._connection.recv_into(buffer)

    def limit(self) -> None:
        """Give what is read or written next no more than the remaining time (TimeoutError)."""
        remaining = self._end - time.monotonic()
        if remaining <= 0:
            raise TimeoutError
        self._connection.settimeout(remaining)


class LimitedServer(ThreadingHTTPServer):
    """A server with a thread for each connection, and an end to their number.

    Attributes:
        names: what ``Host`` may be.
    """

    daemon_threads = True

    def __init__(self, address: tuple[str, int], handler: Any, connections: int) -> None:
        self._free = threading.Semaphore(connections)
        super().__init__(address, handler)
        hosts = (address[0], "localhost")
        self.names = frozenset(f"{host}:{self.server_port}" for host in hosts)
        if self.server_port == 80:  # then browsers leave it out
            self.names |= frozenset(hosts)

    def process_request(self, request: Any, client_address: Any) -> None:
        """Answer in a thread of its own, or not at all."""
        if self._free.acquire(blocking=False):
            super().process_request(request, client_address)
            return
        with suppress(OSError):
            request.setblocking(False)
            request.send(_BUSY)
        self.shutdown_request(request)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """Answer, and make room for the next one."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._free.release()


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


def open_server(
    port: int, handler: type[Handler], parts: Mapping[str, Any], *, connections: int = 32
) -> LimitedServer:
    """Return a server on the loopback interface that does not serve yet; E024: port taken."""
    try:
        return LimitedServer((HOST, port), type("Handler", (handler,), dict(parts)), connections)
    except OSError as failure:
        raise EddiError(problem("E024", port=port, reason=failure.strerror or failure)) from None


class Refused(Exception):  # noqa: N818 - an answer, not an error
    """The answer is no."""

    def __init__(self, status: HTTPStatus, text: str) -> None:
        super().__init__(text)
        self.status, self.text = status, text


class Handler(BaseHTTPRequestHandler):
    """Answers one connection."""

    server: LimitedServer
    # within which a request has come and its answer is taken, or the connection ends
    seconds: float = 20.0
    policy: str  # what a page may load
    server_version = "eddi-scaffold"
    sys_version = ""

    def setup(self) -> None:
        """Let the time of the request begin."""
        super().setup()
        self.rfile.close()
        self._time = TimedInput(self.connection, self.seconds)
        self.rfile = BufferedReader(self._time)

    def more_time(self) -> None:
        """Let the time begin anew, for a further part of an answer that has no end."""
        self._time = TimedInput(self.connection, self.seconds)
        self._time.limit()

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
        hosts = self.headers.get_all("Host", [])
        host = hosts[0] if len(hosts) == 1 else ""
        if host not in self.server.names:
            raise Refused(HTTPStatus.FORBIDDEN, "this page is for localhost only")
        origin = self.headers.get("Origin")
        if origin not in (None, "null", f"http://{host}") or (
            origin == "null" and self.command == "POST"
        ):
            raise Refused(HTTPStatus.FORBIDDEN, "this page takes no orders from another one")

    def body(self) -> bytes:
        """Return what was sent; Refused if it is too long, or shorter than was said."""
        length = self._length()
        if length > MAX_BODY:
            remaining = min(length, _DRAINED)
            while remaining > 0:
                block = self.rfile.read(min(remaining, MAX_BODY))
                remaining = remaining - len(block) if block else 0
            text = f"more than {MAX_BODY} bytes are not taken: go back and shorten the text"
            raise Refused(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, text)
        body = self.rfile.read(length)
        if len(body) < length:
            raise Refused(HTTPStatus.BAD_REQUEST, "the body is shorter than its Content-Length")
        return body

    def _length(self) -> int:
        lengths = self.headers.get_all("Content-Length", [])
        if "Transfer-Encoding" in self.headers or not lengths:
            raise Refused(HTTPStatus.LENGTH_REQUIRED, "a Content-Length is required")
        if len(lengths) > 1 or not _LENGTH.fullmatch(lengths[0]):
            raise Refused(HTTPStatus.BAD_REQUEST, "the Content-Length is not a number of bytes")
        return int(lengths[0])

    def send(
        self, status: HTTPStatus, kind: str, data: bytes, more: Mapping[str, str] | None = None
    ) -> None:
        """Send a whole answer."""
        self.begin(status, kind, {"Content-Length": str(len(data)), **(more or {})})
        self.wfile.write(data)

    def begin(self, status: HTTPStatus, kind: str, more: Mapping[str, str]) -> None:
        """Send the head of an answer."""
        self._time.limit()
        self.send_response(status)
        headers = {"Content-Type": kind, "Content-Security-Policy": self.policy, **_HEADERS}
        for name, value in {**headers, **more}.items():
            self.send_header(name, value)
        self.end_headers()

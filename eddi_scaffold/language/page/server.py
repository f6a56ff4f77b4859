"""The page over HTTP, on the loopback interface only; nothing is written to disk."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler
from importlib.resources import files
from io import BufferedReader
from typing import Any
from urllib.parse import parse_qs

from eddi_scaffold.language.page.html import Page, render
from eddi_scaffold.language.page.limits import LimitedServer, TimedInput
from eddi_scaffold.language.page.responses import (
    ReadSignal,
    Request,
    analysis_of,
    answer,
    download,
)
from eddi_scaffold.language.report import as_json
from eddi_scaffold.language.targets import generate
from eddi_scaffold.problems import EddiError, error

HOST = "127.0.0.1"
MAX_BODY = 64 * 1024
_DRAINED = 4 * 1024 * 1024
"""Bytes of a body that is too long which are still read, so that the answer arrives."""
_LENGTH = re.compile(r"[0-9]{1,18}")
_HEADERS = {
    "Content-Security-Policy": (
        "default-src 'none'; style-src 'self'; script-src 'self'; img-src data:; "
        "form-action 'self'; base-uri 'none'; frame-ancestors 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    # With no-referrer, browsers send forms with the origin "null", which is refused below.
    "Referrer-Policy": "same-origin",
    "Cache-Control": "no-store",
}
_START = Page(text="AVERAGE(temp, 5s) > 100 AND TIME(warning == TRUE, 5s)")
_HTML = "text/html; charset=utf-8"
_FILES = {"/style.css": "text/css; charset=utf-8", "/page.js": "text/javascript; charset=utf-8"}


def open_server(
    port: int, read_signal: ReadSignal, *, seconds: float = 20.0, connections: int = 32
) -> LimitedServer:
    """Return a server that listens on the loopback interface and is not serving yet.

    Args:
        port: 0 for any that is free.
        read_signal: reads recorded values.
        seconds: within which a request has come and its answer is taken, or the connection ends.
        connections: at once; a further one is asked to retry.

    Raises:
        EddiError: the port is taken (E024).
    """
    parts = {"read_signal": staticmethod(read_signal), "seconds": seconds}
    try:
        return LimitedServer((HOST, port), type("Handler", (_Handler,), parts), connections)
    except OSError as problem:
        message = f"the port {port} cannot be used: {problem.strerror or problem}"
        raise EddiError(error("E024", message, hint="choose another one with --port")) from None


class _Refused(Exception):  # noqa: N818 - an answer, not an error
    def __init__(self, status: HTTPStatus, text: str) -> None:
        super().__init__(text)
        self.status = status
        self.text = text


class _Handler(BaseHTTPRequestHandler):
    """Answers one connection."""

    server: LimitedServer
    read_signal: ReadSignal
    seconds: float
    server_version = "eddi-scaffold"
    sys_version = ""

    def setup(self) -> None:
        """Let the time of the request begin."""
        super().setup()
        self.rfile.close()
        self._input = TimedInput(self.connection, self.seconds)
        self.rfile = BufferedReader(self._input)

    def do_GET(self) -> None:
        """Answer with the page, or one of its two files."""
        self._guarded(self._get)

    def do_POST(self) -> None:
        """Check or generate what was sent."""
        self._guarded(self._post)

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002 - its name there
        """Log nothing: the terminal belongs to the command."""

    def _guarded(self, respond: Any) -> None:
        try:
            self._check_origin()
            respond()
        except _Refused as refused:
            self.close_connection = True
            self._send(refused.status, "text/plain; charset=utf-8", f"{refused.text}\n".encode())
        except (ConnectionError, TimeoutError):
            self.close_connection = True

    def _check_origin(self) -> None:
        """Refuse what a page from elsewhere sends, also by a name that it points at us."""
        hosts = self.headers.get_all("Host", [])
        host = hosts[0] if len(hosts) == 1 else ""
        if host not in self.server.names:
            raise _Refused(HTTPStatus.FORBIDDEN, "this page is for localhost only")
        origin = self.headers.get("Origin")
        if origin not in (None, "null", f"http://{host}") or (
            origin == "null" and self.command == "POST"
        ):
            raise _Refused(HTTPStatus.FORBIDDEN, "this page takes no orders from another one")

    def _get(self) -> None:
        if self.path == "/":
            self._send(HTTPStatus.OK, _HTML, render(_START).encode())
        elif self.path in _FILES:
            data = files(__package__).joinpath(self.path[1:]).read_bytes()
            self._send(HTTPStatus.OK, _FILES[self.path], data)
        else:
            raise _Refused(HTTPStatus.NOT_FOUND, "there is nothing here")

    def _post(self) -> None:
        if self.path not in ("/check", "/generate"):
            raise _Refused(HTTPStatus.NOT_FOUND, "there is nothing here")
        body, kind = self._body(), self.headers.get_content_type()
        if kind == "application/json":
            self._post_json(body)
            return
        if kind != "application/x-www-form-urlencoded":
            raise _Refused(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "a form or JSON is expected")
        try:
            pairs = parse_qs(body.decode("utf-8"), keep_blank_values=True, max_num_fields=20)
        except ValueError:
            raise _Refused(HTTPStatus.BAD_REQUEST, "this is not a form") from None
        form = {name: values[-1] for name, values in pairs.items()}
        page = answer(_request(form), self.read_signal, code=self.path == "/generate")
        if form.get("download") and page.files:
            name, data = download(page.files)
            disposition = {"Content-Disposition": f'attachment; filename="{name}"'}
            self._send(HTTPStatus.OK, "application/octet-stream", data, disposition)
        else:
            self._send(HTTPStatus.OK, _HTML, render(page).encode("utf-8", "replace"))

    def _post_json(self, body: bytes) -> None:
        try:
            document = json.loads(body)
        except (ValueError, RecursionError):
            document = None
        if not isinstance(document, dict):
            raise _Refused(HTTPStatus.BAD_REQUEST, "a JSON object is expected")
        request = _request({name: str(value) for name, value in document.items()})
        try:
            analysis = analysis_of(request)
        except EddiError as failure:
            found: dict[str, Any] = {
                "ok": False,
                "problems": [problem.as_json() for problem in failure.problems],
            }
        else:
            wanted = self.path == "/generate" and analysis.form is not None
            made = generate(analysis, request.language, request.name) if wanted else {}
            found = as_json(analysis, made)
        self._send(HTTPStatus.OK, "application/json", json.dumps(found).encode())

    def _body(self) -> bytes:
        length = self._length()
        if length > MAX_BODY:
            left = min(length, _DRAINED)
            while left > 0:
                block = self.rfile.read(min(left, MAX_BODY))
                left = left - len(block) if block else 0
            text = f"more than {MAX_BODY} bytes are not taken: go back and shorten the text"
            raise _Refused(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, text)
        body = self.rfile.read(length)
        if len(body) < length:
            raise _Refused(HTTPStatus.BAD_REQUEST, "the body is shorter than its Content-Length")
        return body

    def _length(self) -> int:
        lengths = self.headers.get_all("Content-Length", [])
        if "Transfer-Encoding" in self.headers or not lengths:
            raise _Refused(HTTPStatus.LENGTH_REQUIRED, "a Content-Length is required")
        if len(lengths) > 1 or not _LENGTH.fullmatch(lengths[0]):
            raise _Refused(HTTPStatus.BAD_REQUEST, "the Content-Length is not a number of bytes")
        return int(lengths[0])

    def _send(
        self, status: HTTPStatus, kind: str, data: bytes, more: Mapping[str, str] | None = None
    ) -> None:
        self._input.limit()
        self.send_response(status)
        headers = {"Content-Type": kind, "Content-Length": str(len(data)), **_HEADERS}
        for name, value in {**headers, **(more or {})}.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(data)


def _request(form: Mapping[str, str]) -> Request:
    return Request(
        text=form.get("text", ""),
        rate=form.get("rate", ""),
        target=form.get("target", "python"),
        name=form.get("name") or "event",
        signal=form.get("signal", ""),
        example=bool(form.get("example")),
    )

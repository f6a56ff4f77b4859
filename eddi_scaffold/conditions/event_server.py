"""The page over HTTP, on the loopback interface only; nothing is written to disk."""

from __future__ import annotations

import json
from collections.abc import Mapping
from http import HTTPStatus
from importlib.resources import files
from typing import Any
from urllib.parse import parse_qs

from eddi_scaffold.common import local_server
from eddi_scaffold.common.local_server import CSS, HTML, JAVASCRIPT, Handler, LimitedServer, Refused
from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.conditions.event_page import (
    Page,
    ReadSignal,
    Request,
    analysis_of,
    answer,
    download,
    render,
)
from eddi_scaffold.conditions.report import as_json
from eddi_scaffold.conditions.standalone import generate

_POLICY = (
    "default-src 'none'; style-src 'self'; script-src 'self'; img-src data:; "
    "form-action 'self'; base-uri 'none'; frame-ancestors 'none'"
)
START = Page(text="AVERAGE(temp, 5s) > 100 AND TIME(warning == TRUE, 5s)")
_FILES = {"/style.css": CSS, "/page.js": JAVASCRIPT}


def open_server(
    port: int,
    read_signal: ReadSignal,
    start: Page = START,
    *,
    seconds: float = 20.0,
    connections: int = 32,
) -> LimitedServer:
    """Return a server of the page on the loopback interface, not serving yet.

    Args:
        port: 0 for any that is free.
        read_signal: reads recorded values.
        start: what the page shows at first.
        seconds: within which a request has come and its answer is taken, or the connection ends.
        connections: at once; a further one is asked to retry.

    Raises:
        EddiError: the port is taken (E024).
    """
    parts = {"read_signal": staticmethod(read_signal), "start": start, "seconds": seconds}
    return local_server.open_server(port, _Handler, parts, connections=connections)


class _Handler(Handler):
    """Answers one connection."""

    read_signal: ReadSignal
    start: Page
    policy = _POLICY

    def get(self) -> None:
        """Answer with the page, or one of its two files."""
        if self.path == "/":
            self.send(HTTPStatus.OK, HTML, render(self.start).encode())
        elif self.path in _FILES:
            data = files(__package__).joinpath("page", self.path[1:]).read_bytes()
            self.send(HTTPStatus.OK, _FILES[self.path], data)
        else:
            raise Refused(HTTPStatus.NOT_FOUND, "there is nothing here")

    def post(self) -> None:
        """Check or generate what was sent."""
        if self.path not in ("/check", "/generate"):
            raise Refused(HTTPStatus.NOT_FOUND, "there is nothing here")
        body, kind = self.body(), self.headers.get_content_type()
        if kind == "application/json":
            self._post_json(body)
            return
        if kind != "application/x-www-form-urlencoded":
            raise Refused(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "a form or JSON is expected")
        try:
            pairs = parse_qs(body.decode("utf-8"), keep_blank_values=True, max_num_fields=20)
        except ValueError:
            raise Refused(HTTPStatus.BAD_REQUEST, "this is not a form") from None
        form = {name: values[-1] for name, values in pairs.items()}
        page = answer(_request(form), self.read_signal, code=self.path == "/generate")
        if form.get("download") and page.files:
            name, data = download(page.files)
            disposition = {"Content-Disposition": f'attachment; filename="{name}"'}
            self.send(HTTPStatus.OK, "application/octet-stream", data, disposition)
        else:
            self.send(HTTPStatus.OK, HTML, render(page).encode("utf-8", "replace"))

    def _post_json(self, body: bytes) -> None:
        try:
            document = json.loads(body)
        except (ValueError, RecursionError):
            document = None
        if not isinstance(document, dict):
            raise Refused(HTTPStatus.BAD_REQUEST, "a JSON object is expected")
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
        self.send(HTTPStatus.OK, "application/json", json.dumps(found).encode())


def _request(form: Mapping[str, str]) -> Request:
    return Request(
        text=form.get("text", ""),
        rate=form.get("rate", ""),
        target=form.get("target", "python"),
        name=form.get("name") or "event",
        signal=form.get("signal", ""),
        example=bool(form.get("example")),
    )

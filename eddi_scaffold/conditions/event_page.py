"""The Event Creator page of SESAME D7.2 Fig 24: served on this machine only, nothing from outside.

One HTML form without JavaScript, rendered here. Nothing is written to disk.
"""

from __future__ import annotations

import base64
import io
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from html import escape
from http import HTTPStatus
from http.server import ThreadingHTTPServer
from importlib.resources import files
from string import Template
from types import MappingProxyType
from typing import Any
from urllib.parse import parse_qs

from eddi_scaffold.common import local_server
from eddi_scaffold.common.local_server import CSS, HTML, Handler, Refused
from eddi_scaffold.common.problems import EddiError, Problem, has_errors, problem
from eddi_scaffold.conditions.analysis import Analysis, analyse
from eddi_scaffold.conditions.standalone import as_text, columns, generate, play
from eddi_scaffold.diagrams.plot import plot, tracks_of
from eddi_scaffold.program.standalone import Target

Rows = Sequence[tuple[float, Mapping[str, Any]]]
ReadSignal = Callable[[str, Mapping[str, str]], tuple[Rows | None, Sequence[Problem]]]
"""CSV text, type of each column -> (time, new samples) rows, and what is wrong with it."""
_POLICY = (
    "default-src 'none'; style-src 'self'; img-src data:; "
    "form-action 'self'; base-uri 'none'; frame-ancestors 'none'"
)


@dataclass(frozen=True)
class Page:
    """The contents of the page: what was typed, and the result."""

    text: str = "AVERAGE(temp, 5s) > 100 AND TIME(warning == TRUE, 5s)"  # the events
    rate: str = "10"  # in Hz, as typed; empty for none
    target: Target = "python"  # of the generated code
    name: str = "event"  # of the monitor
    signal: str = ""  # recorded values as CSV
    result: str = ""  # HTML


def open_server(
    port: int,
    read_signal: ReadSignal,
    start: Page | None = None,
) -> ThreadingHTTPServer:
    """Return a server of the page on the loopback interface, not serving yet.

    Raises:
        EddiError: the port is taken (E024).
    """
    parts = {"read_signal": staticmethod(read_signal), "start": start or Page()}
    return local_server.open_server(port, _Handler, parts)


class _Handler(Handler):
    read_signal: ReadSignal
    start: Page
    policy = _POLICY

    def get(self) -> None:
        if self.path == "/":
            self.send(HTTPStatus.OK, HTML, _render(self.start))
        elif self.path == "/style.css":
            self.send(HTTPStatus.OK, CSS, _file("style.css"))
        else:
            super().get()

    def post(self) -> None:
        if self.path not in ("/check", "/generate"):
            super().post()
        body, code = self.body(), self.path == "/generate"
        if self.headers.get_content_type() != "application/x-www-form-urlencoded":
            raise Refused(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "a form is expected")
        try:
            pairs = parse_qs(body.decode("utf-8"), keep_blank_values=True, max_num_fields=20)
        except ValueError:
            raise Refused(HTTPStatus.BAD_REQUEST, "this is not a form") from None
        form = {name: values[-1].replace("\r\n", "\n") for name, values in pairs.items()}
        target: Target = "c" if form.get("target") == "c" else "python"
        typed = Page(
            form.get("text", ""),
            form.get("rate", "").strip(),
            target,
            form.get("name") or "event",
            form.get("signal", ""),
        )
        page, texts = self.answer(typed, code=code)
        if form.get("download") and texts:
            name, data = _download(texts)
            disposition = {"Content-Disposition": f'attachment; filename="{name}"'}
            self.send(HTTPStatus.OK, "application/octet-stream", data, disposition)
        else:
            self.send(HTTPStatus.OK, HTML, _render(page))

    def answer(self, page: Page, *, code: bool) -> tuple[Page, Mapping[str, str]]:
        """Return the page with the result of what was typed, and the files that were generated."""
        try:
            analysis = analyse(page.text, rate=_rate(page.rate))
        except EddiError as failure:
            return replace(page, result=_result(failure.problems)), {}
        problems, picture, texts = list(analysis.problems), "", dict[str, str]()
        if analysis.program is not None and page.signal.strip():
            rows, more = self.read_signal(page.signal, columns(analysis))
            problems += more
            picture = _plot(analysis, rows) if rows else ""
        if analysis.program is not None and code:
            texts = generate(analysis, page.target, page.name)
        return replace(page, result=_result(problems, as_text(analysis), picture, texts)), texts


def _rate(text: str) -> float | None:
    try:
        return float(text) if text else None
    except ValueError:
        raise EddiError(problem("E005.rate_text", rate=text[:40])) from None


def _download(texts: Mapping[str, str]) -> tuple[str, bytes]:
    """Return name and content of one file: the module, or a zip of several files."""
    if len(texts) == 1:
        ((name, text),) = texts.items()
        return name, text.encode()
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name, text in texts.items():
            archive.writestr(zipfile.ZipInfo(name), text)
    return f"{min(texts, key=len).partition('.')[0]}.zip", stream.getvalue()


def _file(name: str) -> bytes:
    return files(__package__).joinpath("page", name).read_bytes()


def _render(page: Page) -> bytes:
    fields = {name: escape(getattr(page, name)) for name in ("text", "rate", "name", "signal")}
    html = Template(_file("index.html").decode()).substitute(
        fields,
        python=" selected" if page.target == "python" else "",
        c=" selected" if page.target == "c" else "",
        open=" open" if page.signal else "",
        result=page.result,
    )
    return html.encode("utf-8", "replace")


def _result(
    problems: Sequence[Problem],
    lines: Sequence[str] = (),
    picture: str = "",
    texts: Mapping[str, str] = MappingProxyType({}),
) -> str:
    parts = [] if has_errors(problems) else ['<p class="good">No errors.</p>']
    for entry in problems:
        place = ":".join(str(part) for part in (entry.place.line, entry.place.col) if part)
        text = f"<strong>{entry.level}</strong> {place} {escape(entry.message)} [{entry.code}]"
        hint = f"<p>Hint: {escape(entry.hint)}</p>" if entry.hint else ""
        if entry.excerpt is not None:
            hint = f"<pre>{escape(entry.excerpt)}\n{'^':>{entry.place.col or 1}}</pre>{hint}"
        parts.append(f'<div class="problem {entry.level}"><p>{text}</p>{hint}</div>')
    if lines:
        parts.append(f"<pre>{escape(chr(10).join(lines))}</pre>")
    if picture:
        data = base64.b64encode(picture.encode()).decode()
        alt = "Values and verdicts over time"
        parts.append(f'<img alt="{alt}" src="data:image/svg+xml;base64,{data}">')
    for number, (name, text) in enumerate(texts.items()):
        rows = min(30, text.count("\n") + 1)
        parts.append(
            f'<h2><label for="code{number}">{escape(name)}</label></h2>\n'
            f'<textarea id="code{number}" class="code" rows="{rows}" readonly '
            f'spellcheck="false">\n{escape(text)}</textarea>'
        )
    return "\n".join(parts)


def _plot(analysis: Analysis, rows: Rows) -> str:
    held: dict[str, Any] = {variable.name: None for variable in analysis.inputs}
    inputs = [(t, held := {**held, **samples}) for t, samples in rows]
    tracks = [*tracks_of("values", inputs), *tracks_of("events", list(play(analysis, rows)))]
    return plot("Values and verdicts", tracks)

"""From what was typed to what is shown; without HTTP."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from eddi_scaffold.diagrams.plotting.svg import plot
from eddi_scaffold.diagrams.plotting.tracks import tracks_of
from eddi_scaffold.language.analysis import Analysis, analyse
from eddi_scaffold.language.page.html import Page
from eddi_scaffold.language.page.signals import example_signal
from eddi_scaffold.language.recorded_values import columns, play
from eddi_scaffold.language.report import as_text
from eddi_scaffold.language.standalone import Target, generate
from eddi_scaffold.problems import EddiError, Problem, error

Rows = Sequence[tuple[float, Mapping[str, Any]]]
ReadSignal = Callable[[str, Mapping[str, str]], tuple[Rows | None, Sequence[Problem]]]
"""CSV text, type of each column -> (time, new samples) rows, and what is wrong with it."""


@dataclass(frozen=True)
class Request:
    """What was typed.

    Attributes:
        text: the events.
        rate: in Hz, as typed; empty for none.
        target: ``python`` or ``c``.
        name: of the monitor.
        signal: CSV.
        example: example values are wanted.
    """

    text: str = ""
    rate: str = ""
    target: str = "python"
    name: str = "event"
    signal: str = ""
    example: bool = False

    @property
    def language(self) -> Target:
        """The target; Python when it is no other that we know."""
        return "c" if self.target == "c" else "python"


def analysis_of(request: Request) -> Analysis:
    """Check what was typed.

    Raises:
        EddiError: the rate is not a number of steps per second (E005).
    """
    rate = None
    if request.rate.strip():
        try:
            rate = float(request.rate.strip())
        except ValueError:
            message = f"the rate {request.rate.strip()[:40]!r} is not a number of steps per second"
            raise EddiError(error("E005", message)) from None
    return analyse(_lines(request.text), rate=rate)


def answer(request: Request, read_signal: ReadSignal, *, code: bool) -> Page:
    """Return the page for a request.

    Args:
        request: what was typed.
        read_signal: reads the recorded values.
        code: generate the monitor as well.
    """
    text = _lines(request.text)
    page = Page(
        text=text,
        rate=request.rate,
        target=request.language,
        name=request.name,
        signal=_lines(request.signal),
        asked=True,
    )
    try:
        analysis = analysis_of(request)
    except EddiError as failure:
        return replace(page, problems=failure.problems)
    page = replace(page, problems=analysis.problems, lines=as_text(analysis))
    if analysis.form is None:
        return replace(page, error_at=_offset(text, analysis.problems))
    if request.example:
        rate = float(request.rate) if request.rate.strip() else None
        page = replace(page, signal=example_signal(analysis, rate))
    if page.signal.strip():
        rows, found = read_signal(page.signal, columns(analysis))
        page = replace(page, problems=[*page.problems, *found])
        if rows:
            page = replace(page, plot=_plot(analysis, rows))
    return replace(page, files=generate(analysis, request.language, request.name)) if code else page


def download(files: Mapping[str, str]) -> tuple[str, bytes]:
    """Return name and content of one file: the module, or a zip of several files."""
    if len(files) == 1:
        ((name, text),) = files.items()
        return name, text.encode()
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name, text in files.items():
            archive.writestr(zipfile.ZipInfo(name), text)
    return f"{min(files, key=len).partition('.')[0]}.zip", stream.getvalue()


def _plot(analysis: Analysis, rows: Rows) -> str:
    held: dict[str, Any] = {variable.name: None for variable in analysis.inputs}
    inputs = []
    for t, samples in rows:
        held = {**held, **samples}
        inputs.append((t, held))
    verdicts = list(play(analysis, rows))
    return plot(
        "Values and verdicts", [*tracks_of("values", inputs), *tracks_of("events", verdicts)]
    )


def _lines(text: str) -> str:
    """Return a text as it was typed: forms send CR LF."""
    return text.replace("\r\n", "\n")


def _offset(text: str, problems: Sequence[Problem]) -> int | None:
    """Return the offset of the first error."""
    for problem in problems:
        line, col = problem.place.line, problem.place.col
        if problem.level == "error" and line is not None and col is not None:
            return sum(len(one) + 1 for one in text.split("\n")[: line - 1]) + col - 1
    return None

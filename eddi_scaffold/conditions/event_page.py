"""The Event Creator page of SESAME D7.2 Fig 24: served on this machine only, nothing from outside.

One HTML form, rendered here; it works without JavaScript, which only adds copying, Ctrl+Enter and
the caret at an error.
"""

from __future__ import annotations

import base64
import io
import math
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from html import escape
from typing import Any

from eddi_scaffold.common.problems import EddiError, Problem, problem
from eddi_scaffold.conditions.analysis import Analysis, analyse
from eddi_scaffold.conditions.recorded_values import columns, play
from eddi_scaffold.conditions.report import as_text
from eddi_scaffold.conditions.scope import Variable
from eddi_scaffold.conditions.standalone import Target, generate
from eddi_scaffold.conditions.syntax import number_text
from eddi_scaffold.diagrams.plot import plot, tracks_of

_TARGETS = {"python": "Python", "c": "C99"}
TITLE = "Event Creator"


@dataclass(frozen=True)
class Page:
    """The contents of the page.

    Attributes:
        text: the events.
        rate: as it was typed.
        target: ``python`` or ``c``.
        name: of the monitor.
        signal: recorded values as CSV.
        asked: something was asked for: there is a result.
        problems: what is wrong.
        lines: report on a checked text.
        files: what was generated.
        plot: SVG of the signal and the verdicts, empty for none.
        error_at: offset of the first error in the text, ``None`` for none.
    """

    text: str = ""
    rate: str = "10"
    target: str = "python"
    name: str = "event"
    signal: str = ""
    asked: bool = False
    problems: Sequence[Problem] = ()
    lines: Sequence[str] = ()
    files: Mapping[str, str] = field(default_factory=dict)
    plot: str = ""
    error_at: int | None = None


def render(page: Page) -> str:
    """Return the whole page."""
    at = "" if page.error_at is None else f' data-at="{page.error_at}"'
    options = "".join(
        f'<option value="{key}"{" selected" if key == page.target else ""}>{label}</option>'
        for key, label in _TARGETS.items()
    )
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{TITLE}</title>
<link rel="stylesheet" href="/style.css">
<script src="/page.js" defer></script>
</head>
<body>
<main>
<h1>{TITLE}</h1>
<form method="post" action="/check">
<label for="text">Expression, or declarations and events</label>
<textarea id="text" name="text" rows="6" spellcheck="false" autofocus{at}>
{escape(page.text)}</textarea>
<div class="row">
<p><label for="rate">Sampling rate in Hz</label>
<input id="rate" name="rate" inputmode="decimal" value="{escape(page.rate)}"></p>
<p><label for="target">Target language</label>
<select id="target" name="target">{options}</select></p>
<p><label for="name">Name of the monitor</label>
<input id="name" name="name" value="{escape(page.name)}"></p>
</div>
<details{" open" if page.signal else ""}>
<summary>Recorded values (CSV with a column t, and one for each variable)</summary>
<label for="signal">Values</label>
<textarea id="signal" name="signal" rows="6" spellcheck="false">
{escape(page.signal)}</textarea>
<button name="example" value="1">Example values</button>
</details>
<p class="buttons">
<button id="check">Check</button>
<button id="generate" formaction="/generate">Generate</button>
<button id="download" formaction="/generate" name="download" value="1">Download</button>
</p>
</form>
<section id="result" aria-label="Result" aria-live="polite">
{_result(page) if page.asked else ""}
</section>
</main>
</body>
</html>
"""


def _result(page: Page) -> str:
    parts = [_problem(problem) for problem in page.problems]
    if not any(problem.level == "error" for problem in page.problems):
        parts.insert(0, '<p class="good">No errors.</p>')
    if page.lines:
        parts.append(f"<pre>{escape(chr(10).join(page.lines))}</pre>")
    if page.plot:
        data = base64.b64encode(page.plot.encode()).decode()
        alt = "Values and verdicts over time"
        parts.append(f'<img alt="{alt}" src="data:image/svg+xml;base64,{data}">')
    for number, (name, text) in enumerate(page.files.items()):
        rows = min(30, text.count("\n") + 1)
        parts.append(
            f'<h2><label for="code{number}">{escape(name)}</label> '
            f'<button type="button" class="copy" data-copies="code{number}" hidden>Copy</button>'
            f'</h2>\n<textarea id="code{number}" class="code" rows="{rows}" readonly '
            f'spellcheck="false">\n{escape(text)}</textarea>'
        )
    return "\n".join(parts)


def _problem(problem: Problem) -> str:
    place = ":".join(str(part) for part in (problem.place.line, problem.place.col) if part)
    text = f"<strong>{problem.level}</strong> {place} {escape(problem.message)} [{problem.code}]"
    shown = [f'<div class="problem {problem.level}"><p>{text}</p>']
    if problem.excerpt is not None and problem.place.col is not None:
        shown.append(f"<pre>{_marked(problem.excerpt, problem.place.col)}</pre>")
    if problem.hint:
        shown.append(f"<p>Hint: {escape(problem.hint)}</p>")
    return "".join([*shown, "</div>"])


def _marked(line: str, column: int) -> str:
    """Return a line with the character at a column highlighted, and a caret below it."""
    start = max(0, column - 80)
    before, at, after = line[start : column - 1], line[column - 1 : column], line[column:]
    caret = " " * len(before) + "^"
    return f"{escape(before)}<mark>{escape(at) or ' '}</mark>{escape(after[:80])}\n{caret}"


MIN_ROWS, MAX_ROWS = 60, 600
_CELLS = 4000
"""Cells at most: the page takes the values back in a form of limited size."""


def example_signal(analysis: Analysis, rate: float | None) -> str:
    """Return a recording as CSV, some windows long: waves for numbers, slow changes for all else.

    In its last part one sample of each number is missing.
    """
    rows = _rows(analysis)
    lines = [",".join(["t", *(variable.name for variable in analysis.inputs)])]
    for row in range(rows):
        part = row / rows
        missing = row == rows * 4 // 5
        cells = [
            "nan" if missing and _kind(variable) == "number" else _cell(variable, part, k, analysis)
            for k, variable in enumerate(analysis.inputs)
        ]
        lines.append(",".join([number_text(round(row / (rate or 1.0), 9)), *cells]))
    return "\n".join(lines) + "\n"


def _rows(analysis: Analysis) -> int:
    assert analysis.form is not None
    longest: int = max((node.get("window", 0) for node in analysis.form["nodes"]), default=0)
    wanted: int = 6 * longest // max(1, analysis.form["period"])
    room = _CELLS // (len(analysis.inputs) + 1)
    return max(2, min(max(wanted, MIN_ROWS), MAX_ROWS, room))


def _kind(variable: Variable) -> str:
    return "number" if variable.type is None else variable.type.kind


def _cell(variable: Variable, part: float, number: int, analysis: Analysis) -> str:
    """Return the value at a part (0 to 1) of the recording."""
    if variable.type is not None and variable.type.enum:
        literals = analysis.enums[variable.type.enum]
        return literals[int(part * 3 * len(literals)) % len(literals)]
    if _kind(variable) == "bool":
        return "false" if (part * (3 + number)) % 1 < 0.15 else "true"
    low, high = variable.range or (0.0, 120.0)
    wave = 0.5 - 0.5 * math.cos(2 * math.pi * part * (2 + 0.5 * number))
    return number_text(round(low + (high - low) * min(1.0, 1.5 * wave), 3))


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
            raise EddiError(problem("E005.rate_text", rate=request.rate.strip()[:40])) from None
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
    for reported in problems:
        line, col = reported.place.line, reported.place.col
        if reported.level == "error" and line is not None and col is not None:
            return sum(len(one) + 1 for one in text.split("\n")[: line - 1]) + col - 1
    return None

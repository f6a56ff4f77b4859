"""The page as text. Whatever a person typed is escaped; there is no inline script or style."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape

from eddi_scaffold.problems import Problem

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

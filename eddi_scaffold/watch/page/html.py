"""The page as text. Whatever a robot sent is escaped; there is no inline script or style."""

from __future__ import annotations

from eddi_scaffold.escaping import xml_text
from eddi_scaffold.watch.page.view import Group, Row, View

TITLE = "Fleet"
MARKS = {"active": "●", "not active": "✕", "unknown": "?"}
"""A state is told by its words and a mark, its colour only adds to them."""


def render(view: View) -> str:
    """Return the whole page."""
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{TITLE}</title>
<link rel="stylesheet" href="/style.css">
<script src="/page.js" defer></script>
<noscript><meta http-equiv="refresh" content="2"></noscript>
</head>
<body>
<a class="skip" href="#changes-title">Skip to the last changes</a>
{main(view)}
<p id="said" class="aside" role="status" aria-live="polite"></p>
</body>
</html>
"""


def main(view: View) -> str:
    """Return what a view fills."""
    empty = "" if view.groups else '<p id="empty">No monitor has been heard of yet.</p>\n'
    return f"""<main data-shape="{view.shape}">
<h1>{TITLE}</h1>
<p>At <span id="time">{xml_text(view.time)}</span>. <span id="link">Live.</span></p>
<ul id="notes">{"".join(f"<li>{xml_text(one)}</li>" for one in view.notes)}</ul>
{empty}{"".join(map(_group, view.groups))}<section aria-labelledby="changes-title">
<h2 id="changes-title" tabindex="-1">Last changes</h2>
<ol id="changes" reversed tabindex="0" aria-labelledby="changes-title">
{"".join(f'<li data-number="{number}">{xml_text(text)}</li>' for number, text in view.changes)}
</ol>
</section>
</main>"""


def _group(one: Group) -> str:
    name = xml_text(one.name)
    return f"""<section aria-labelledby="{one.id}">
<h2 id="{one.id}">{name}</h2>
<p id="{one.id}-summary">{xml_text(one.summary)}</p>
<details id="{one.id}-graph" open><summary>Graph</summary>
<img alt="Graph of the guarantees of {name}; the table says the same in words" \
src="/graph/{one.number}.svg?{one.graph}">
</details>
<table>
<caption class="aside">Guarantees of {name}</caption>
<thead><tr><th scope="col">Monitor</th><th scope="col">Guarantee</th><th scope="col">State</th>\
<th scope="col">Why</th><th scope="col">Since</th></tr></thead>
<tbody>
{"".join(map(_row, one.rows))}</tbody>
</table>
<details><summary>Monitors</summary><ul id="{one.id}-facts">\
{"".join(f"<li>{xml_text(fact)}</li>" for fact in one.facts)}</ul></details>
</section>
"""


def _row(one: Row) -> str:
    return (
        f'<tr id="{one.id}" data-state="{xml_text(one.state)}"><td>{xml_text(one.monitor)} '
        f'<span class="kind">{xml_text(one.kind)}</span></td>'
        f'<th scope="row">{xml_text(one.name)}</th>'
        f'<td><span class="state"><span aria-hidden="true">{MARKS[one.state]}</span> '
        f"<span>{xml_text(one.state)}</span></span></td>"
        f"<td>{xml_text(one.why)}</td><td>{xml_text(one.since)}</td></tr>\n"
    )

"""Plots of a run over time as SVG, without a plotting library."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from operator import itemgetter
from typing import Literal

from eddi_scaffold.common.escaping import xml_text
from eddi_scaffold.diagrams.svg import DRAWING, document

Value = bool | int | float | str | None  # `None` is unknown

Span = tuple[float, float]  # from when to when
Form = Literal["truth", "number", "text"]


@dataclass(frozen=True)
class Track:
    """One value over time."""

    name: str  # for people
    group: str  # heading under which it is shown (`inputs`, `outputs`)
    times: tuple[float, ...]  # seconds, ascending
    values: tuple[Value, ...]  # one per time
    reasons: tuple[str, ...] = ()  # one per time, why it is not so, empty for none

    @property
    def form(self) -> Form:
        """How it is drawn: by the first value that is known."""
        first = next((value for value in self.values if value is not None), True)
        if isinstance(first, bool):
            return "truth"
        return "text" if isinstance(first, str) else "number"


def plain(value: object) -> Value:
    """Return a value as it can be drawn: NaN and what is not a single value are unknown."""
    if isinstance(value, float) and math.isnan(value):
        return None
    return value if isinstance(value, bool | int | float | str) else None


def tracks_of(group: str, samples: Iterable[tuple[float, Mapping[str, object]]]) -> Sequence[Track]:
    """Turn time-stamped values into one track per name, in the order of their first sample."""
    times: dict[str, list[float]] = {}
    values: dict[str, list[Value]] = {}
    for t, named in samples:
        for name, value in named.items():
            times.setdefault(name, []).append(t)
            values.setdefault(name, []).append(plain(value))
    return [Track(name, group, tuple(times[name]), tuple(values[name])) for name in times]


def shown_time(tracks: Iterable[Track]) -> Span:
    """Return from when to when tracks are shown: their last values can be seen as well."""
    times = [track.times for track in tracks if track.times]
    if not times:
        return 0.0, 1.0
    start, end = min(time[0] for time in times), max(time[-1] for time in times)
    if not end > start:
        return start, start + 1.0
    step = max((time[-1] - time[-2] for time in times if len(time) > 1), default=0.0)
    return start, end + max(step, (end - start) / 100)


def stretches(track: Track, end: float) -> list[tuple[float, float, Value, str]]:
    """Return (from, to, value, reason) of each stretch of equal ones; the last ends at ``end``."""
    parts: list[tuple[float, float, Value, str]] = []
    reasons = track.reasons or [""] * len(track.times)
    for k, (t, value, why) in enumerate(zip(track.times, track.values, reasons, strict=True)):
        until = track.times[k + 1] if k + 1 < len(track.times) else end
        if parts and parts[-1][2:] == (value, why) and type(parts[-1][2]) is type(value):
            parts[-1] = (parts[-1][0], until, value, why)
        else:
            parts.append((t, until, value, why))
    return parts


def ticks(low: float, high: float) -> list[float]:
    """Return round numbers between two bounds, both included where they are round."""
    if not high > low:
        return [low]
    rough = (high - low) / 8
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(factor * power for factor in (1, 2, 5, 10) if factor * power >= rough)
    first = math.ceil(low / step - 1e-9)
    last = math.floor(high / step + 1e-9)
    return [round(k * step, 12) for k in range(first, last + 1)]


_LEFT, _RIGHT, _WIDTH = 200, 60, 860  # as wide as the column of a README: nothing is scaled
_TOP, _BAND, _GRAPH, _REASON, _GAP, _HEADING = 46, 18, 64, 14, 8, 24
_COLOURS = {True: "#1f5f99", False: "#c9ced6", None: "url(#unknown)"}
_WORDS = {True: "holds", False: "known not to hold", None: "unknown"}
_LEGEND = {
    True: "holds, true; of NOT x: hazard x is absent",
    False: "known not to hold, false",
    None: "unknown, which counts as not",
}


def plot(title: str, tracks: Sequence[Track]) -> str:
    """Return the SVG of some tracks over their common time."""
    span = shown_time(tracks)
    body: list[str] = []
    y = _TOP
    group = None
    for track in tracks:
        if track.group != group:
            group = track.group
            body.append(_text(12, y + 14, group, "group"))
            y += _HEADING
        height = _GRAPH if track.form == "number" else _BAND
        body.append(_text(_LEFT - 10, y + height // 2 + 4, track.name, anchor="end", width=28))
        body += (_line if track.form == "number" else _bands)(track, y, height, span)
        y += height + _GAP + (_REASON if any(track.reasons) else 0)
    body = [_text(12, 24, title, "title"), *_grid(span, y), *body, *_legend(y + 40)]
    return document(xml_text(title), f"{_WIDTH}", f"{y + 56}", [DRAWING["plot"]], body)


def _bands(track: Track, y: int, height: int, span: Span) -> Iterable[str]:
    parts = stretches(track, span[1])
    for begin, until, value, reason in parts:
        x, wide = _x(begin, span), max(_x(until, span) - _x(begin, span), 1.0)
        truth = None if value is None else bool(value)
        colour = "#d6e4f5" if isinstance(value, str) else _COLOURS[truth]
        text = value if isinstance(value, str) else _WORDS[truth]
        place = f'x="{_n(x)}" y="{y}" width="{_n(wide)}" height="{height}"'
        why = f", {reason}" if reason else ""
        title = xml_text(f"{text}: {begin:g} s to {until:g} s{why}")
        yield f'<rect {place} fill="{colour}"><title>{title}</title></rect>'
        if isinstance(value, str) and wide / 7 > len(value):
            yield _text(x + 4, y + 13, value, "small")
    # Below, the reason that lasted longest of each time without a change, up to the next one.
    runs = (max(run, key=lambda one: one[1] - one[0]) for _, run in groupby(parts, itemgetter(2)))
    told = [(_x(begin, span), reason) for begin, _, _, reason in runs if reason]
    for (x, reason), (end, _) in pairwise([*told, (float(_WIDTH), "")]):
        most = int((end - x) / 5.3) - 1  # characters
        if most > 10:  # else too little of it could be read
            yield _text(x, y + height + 11, reason, "reason", width=most, title=xml_text(reason))


def _line(track: Track, y: int, height: int, span: Span) -> Iterable[str]:
    known = [v for v in track.values if isinstance(v, int | float) and math.isfinite(v)]
    low, high = (min(known), max(known)) if known else (0.0, 1.0)
    difference = high - low or 1.0
    right = _WIDTH - _RIGHT

    def level(value: float) -> float:
        share = (min(max(value, low), high) - low) / difference
        return y + height - 4 - share * (height - 8)

    frame = f'x="{_LEFT}" y="{y}" width="{right - _LEFT}" height="{height}"'
    yield f'<rect {frame} fill="none" stroke="#e4e7eb"/>'
    yield _text(right + 6, y + 12, f"{high:.4g}", "small")
    yield _text(right + 6, y + height - 2, f"{low:.4g}", "small")
    path, move = "", "M"
    for begin, until, value, _ in stretches(track, span[1]):
        left, end = _n(_x(begin, span)), _n(_x(until, span))
        if value is None or isinstance(value, str):
            place = f'x="{left}" y="{y}" width="{_n(float(end) - float(left))}" height="{height}"'
            yield f'<rect {place} fill="url(#unknown)" opacity="0.6"><title>unknown</title></rect>'
            move = "M"
        else:
            path += f"{move}{left} {_n(level(float(value)))}L{end} {_n(level(float(value)))}"
            move = "L"
    if path:
        yield f'<path class="line" d="{path}"/>'


def _grid(span: Span, bottom: int) -> Iterable[str]:
    for t in ticks(*span):
        x = float(_n(_x(t, span)))
        ends = f'x1="{_n(x)}" y1="{_n(_TOP - 6)}" x2="{_n(x)}" y2="{_n(bottom)}"'
        yield f'<line class="grid" {ends}/>'
        yield _text(x, bottom + 14, f"{t:g}", "small", anchor="middle")
    yield _text(_WIDTH - _RIGHT + 18, bottom + 14, "s", "small")


def _legend(y: int) -> Iterable[str]:
    x = 12.0
    for value, word in _LEGEND.items():
        yield f'<rect x="{_n(x)}" y="{y - 9}" width="14" height="10" fill="{_COLOURS[value]}"/>'
        yield _text(x + 20, y, word, "small")
        x += 50 + 5.6 * len(word)


def _x(t: float, span: Span) -> float:
    start, end = span
    return _LEFT + (t - start) / (end - start) * (_WIDTH - _LEFT - _RIGHT)


def _n(value: float) -> str:
    return f"{value:.2f}".rstrip("0").rstrip(".")


def _text(
    x: float,
    y: float,
    text: str,
    kind: str = "",
    *,
    anchor: str = "start",
    width: int = 200,
    title: str = "",
) -> str:
    shown = text if len(text) <= width else f"{text[: width - 1]}…"
    style = f' class="{kind}"' if kind else ""
    place = f'x="{_n(x)}" y="{_n(y)}"'
    hover = f"<title>{title}</title>" if title else ""
    return f'<text {place}{style} text-anchor="{anchor}">{hover}{xml_text(shown)}</text>'

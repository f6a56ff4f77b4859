"""What is reported of monitors that a recording is played to."""

from __future__ import annotations

import csv
import io
import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from eddi_scaffold.diagrams.plot import plot, tracks_of
from eddi_scaffold.recordings.playing import Playback

if TYPE_CHECKING:
    from eddi_runtime import Monitor as RuntimeMonitor
    from eddi_runtime.monitor import Value


_PATIENCE = 2.0
"""Seconds of work after which progress is reported."""

_NO_OTHER = "unknown inputs"
"""The reason of a result that only lacks inputs: their names are more precise."""


def watched(play: Playback, report: Callable[[str], None]) -> Playback:
    """Report from time to time the progress of a long recording."""
    reported = time.monotonic()
    for part, frame in play:
        yield part, frame
        if time.monotonic() - reported >= _PATIENCE:
            reported = time.monotonic()
            report(f"{frame.t:.0f} s of the recording are played")


def steps(play: Playback) -> Iterator[dict[str, Any]]:
    """Yield time in seconds, inputs and output as JSON for each step.

    A step without output has the reason, and ``blocked`` is there while it is not empty: input ->
    what is not given because this input is not known. Lists are left out of the inputs. With
    several monitors, each entry has the name of its monitor.
    """
    for part, frame in play:
        running = part.running
        row: dict[str, Any] = {"t": frame.t}
        if part.name:
            row["monitor"] = part.name
        row["inputs"] = {k: _plain(v) for k, v in frame.inputs.items() if not _is_list(v)}
        row["outputs"] = running.as_json(frame.output)
        blocked = running.blocked()
        if blocked:
            row["blocked"] = {name: list(outputs) for name, outputs in blocked.items()}
        why = getattr(running, "status_name", None)
        if row["outputs"] is None and why is not None:
            row["status"] = why()
        beside = getattr(running, "beside_json", None)
        if beside is not None:
            row.update(beside())
        yield row


def changes(play: Playback) -> Iterator[str]:
    """Yield a line for the first step of each monitor, and for each with a new verdict.

    A verdict is what the kind calls one, the reason why it is not to be relied on, and which
    inputs keep outputs from being given; not each digit. A line has every value of the step, the
    reasons why these inputs are not known, and what else is wrong.
    """
    last: dict[str, object] = {}
    for part, frame in play:
        running = part.running
        reason = _reason(frame.output)
        decided = _decided(running, frame.output)
        now = decided, reason, set(running.blocked())
        if last.get(part.name) == now:
            continue
        last[part.name] = now
        values = {**running.series(frame.output), **decided}
        shown = "  ".join(f"{name} {_shown(value)}" for name, value in values.items())
        beside = _beside(running, frame.output) + _blocking(running)
        who = f"{part.name}: " if part.name else ""
        yield f"{frame.t:10.3f}  {who}{shown}{beside}".rstrip()


def table(play: Playback) -> Iterator[str]:
    """Yield the lines of a CSV: time, then every named value of the output in each step.

    Kinds whose results explain why they are not to be relied on have columns at the end:
    ``reason``, and ``unknown`` with the ids of inputs, blanks between them.
    """
    for number, (part, frame) in enumerate(play):
        values = dict(part.running.series(frame.output))
        for name, fact in _facts(frame.output).items():
            values.setdefault(name, fact)
        if number == 0:
            yield _csv_line(["t", *values])
        yield _csv_line([repr(frame.t), *(_cell(value) for value in values.values())])


def picture(title: str, play: Playback) -> str:
    """Return an SVG of inputs and outputs over time; of several monitors, of their verdicts."""
    groups: dict[str, list[tuple[float, Mapping[str, object]]]] = {}
    for part, frame in play:
        if part.name:
            groups.setdefault(part.name, []).append((frame.t, _decided(part.running, frame.output)))
            continue
        inputs = {name: value for name, value in frame.inputs.items() if not _is_list(value)}
        groups.setdefault("inputs", []).append((frame.t, inputs))
        groups.setdefault("outputs", []).append((frame.t, part.running.series(frame.output)))
    return plot(title, [track for name, rows in groups.items() for track in tracks_of(name, rows)])


def _decided(running: RuntimeMonitor[Any], output: object) -> Mapping[str, Value]:
    """Return the verdicts of a step; a plain package has a runtime of its own, maybe an older."""
    decided: Mapping[str, Value] = getattr(running, "decided", running.series)(output)
    return decided


def _omission(running: RuntimeMonitor[Any]) -> str:
    """Return why there is no verdict, as text for people, where a kind provides it."""
    omission = getattr(running, "omission", None)
    return "" if omission is None else str(omission()[1])


def _reason(output: object) -> str:
    """Return why an output is not to be relied on, in a word; empty when it is."""
    return str(getattr(output, "reason", ""))


def _facts(output: object) -> dict[str, Value]:
    """Return the additional fields of an output about itself."""
    found: dict[str, Value] = {}
    if hasattr(output, "reason"):
        found["reason"] = _reason(output)
    if hasattr(output, "unknown"):
        found["unknown"] = " ".join(output.unknown)
    return found


def _beside(running: RuntimeMonitor[Any], output: object) -> str:
    """Return the reason for people where no input that is waited for has it after its name."""
    reason = _reason(output)
    if not reason or hasattr(running, "omission") or reason == _NO_OTHER:
        return ""
    return f"  {reason}" if getattr(output, "valid", False) else f"  not valid: {reason}"


def _plain(value: object) -> Value:
    """Return a value as JSON has it: NaN is not known, as for the monitor, ``inf`` is a text."""
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return value if value is None or isinstance(value, bool | int | float | str) else repr(value)


def _is_list(value: object) -> bool:
    return isinstance(value, list | tuple)


def _csv_line(cells: Sequence[str]) -> str:
    line = io.StringIO()
    csv.writer(line, lineterminator="").writerow(cells)
    return line.getvalue()


def _cell(value: Value) -> str:
    """Return a value as a recording would have it: an empty cell is unknown."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    return value if isinstance(value, str) else repr(value)


def _shown(value: Value) -> str:
    if value is None:
        return "unknown "
    if isinstance(value, bool):
        return "active  " if value else "inactive"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _blocking(running: RuntimeMonitor[Any]) -> str:
    blocked, faults = running.blocked(), running.faults()
    why = _omission(running)
    reasons = {name: faults.get(name) or why for name in blocked}
    texts = [f"{name} ({reason})" if reason else name for name, reason in reasons.items()]
    return f"  waits for {', '.join(texts)}" if texts else ""

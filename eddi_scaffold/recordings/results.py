"""What is reported of monitors that a recording is played to."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from eddi_runtime import Monitor as RuntimeMonitor
from eddi_runtime.monitor import Value

from eddi_scaffold.diagrams.plot import plot, tracks_of
from eddi_scaffold.recordings.playing import Playback

_ONLY_INPUTS = "unknown inputs"
"""The reason of a result that only lacks inputs: their names are more precise."""


def steps(play: Playback) -> Iterator[dict[str, Any]]:
    """Yield time in seconds, inputs and output as JSON for each step.

    A step without output has the reason, and ``blocked`` is there while it is not empty: input ->
    what is not given because this input is not known. Lists are left out of the inputs. With
    several monitors, each entry has the name of its monitor.
    """
    for monitor, step in play:
        running = monitor.running
        row: dict[str, Any] = {"t": step.t}
        if monitor.name:
            row["monitor"] = monitor.name
        row["inputs"] = {name: _plain(value) for name, value in _single(step.inputs)}
        row["outputs"] = running.as_json(step.output)
        blocked = running.blocked()
        if blocked:
            row["blocked"] = {name: list(outputs) for name, outputs in blocked.items()}
        if row["outputs"] is None and hasattr(running, "status_name"):
            row["status"] = running.status_name()
        if hasattr(running, "beside_json"):
            row.update(running.beside_json())
        yield row


def changes(play: Playback) -> Iterator[str]:
    """Yield a line for the first step of each monitor, and for each with a new verdict.

    A verdict is what the kind calls one, the reason why it is not to be relied on, and which
    inputs keep outputs from being given; not each digit. A line has every value of the step, the
    reasons why these inputs are not known, and what else is wrong.
    """
    last: dict[str, object] = {}
    for monitor, step in play:
        running, output = monitor.running, step.output
        reason, decided = str(getattr(output, "reason", "")), _decided(running, output)
        state = decided, reason, set(running.blocked())
        if last.get(monitor.name) == state:
            continue
        last[monitor.name] = state
        values = {**running.series(output), **decided}
        text = "  ".join(f"{name} {_shown(value)}" for name, value in values.items())
        # Inputs that are waited for have the reason after their names.
        if reason and not hasattr(running, "omission") and reason != _ONLY_INPUTS:
            text += f"  {reason}" if getattr(output, "valid", False) else f"  not valid: {reason}"
        name = f"{monitor.name}: " if monitor.name else ""
        yield f"{step.t:10.3f}  {name}{text}{_blocking(running)}".rstrip()


def table(play: Playback) -> Iterator[str]:
    """Yield the lines of a CSV: time, then every named value of the output in each step.

    Kinds whose results explain why they are not to be relied on have columns at the end:
    ``reason``, and ``unknown`` with the ids of inputs, blanks between them.
    """
    for number, (monitor, step) in enumerate(play):
        values = dict(monitor.running.series(step.output))
        if hasattr(step.output, "reason"):
            values.setdefault("reason", str(step.output.reason))
        if hasattr(step.output, "unknown"):
            values.setdefault("unknown", " ".join(step.output.unknown))
        if number == 0:
            yield _csv_line(["t", *values])
        yield _csv_line([repr(step.t), *(_cell(value) for value in values.values())])


def picture(title: str, play: Playback) -> str:
    """Return an SVG of inputs and outputs over time; of several monitors, of their verdicts."""
    groups: dict[str, list[tuple[float, Mapping[str, object]]]] = {}
    for monitor, step in play:
        running = monitor.running
        rows: dict[str, Mapping[str, object]] = {"inputs": dict(_single(step.inputs))}
        rows["outputs"] = running.series(step.output)
        if monitor.name:
            rows = {monitor.name: _decided(running, step.output)}
        for name, values in rows.items():
            groups.setdefault(name, []).append((step.t, values))
    return plot(title, [track for name, rows in groups.items() for track in tracks_of(name, rows)])


def _decided(running: RuntimeMonitor[Any], output: object) -> Mapping[str, Value]:
    """Return the verdicts of a step; a plain package has a runtime of its own, maybe an older."""
    decided: Mapping[str, Value] = getattr(running, "decided", running.series)(output)
    return decided


def _single(inputs: Mapping[str, object]) -> Iterator[tuple[str, object]]:
    """Yield the inputs that are no lists."""
    return ((name, v) for name, v in inputs.items() if not isinstance(v, list | tuple))


def _plain(value: object) -> Value:
    """Return a value as JSON has it: NaN is not known, as for the monitor, ``inf`` is a text."""
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return value if value is None or isinstance(value, bool | int | float | str) else repr(value)


def _csv_line(cells: Sequence[str]) -> str:
    line = io.StringIO()
    csv.writer(line, lineterminator="").writerow(cells)
    return line.getvalue()


def _cell(value: Value) -> str:
    """Return a value as a recording would have it: an empty cell is unknown."""
    if value is None or isinstance(value, bool):
        return {None: "", True: "true", False: "false"}[value]
    return value if isinstance(value, str) else repr(value)


def _shown(value: Value) -> str:
    if value is None or isinstance(value, bool):
        return {None: "unknown ", True: "active  ", False: "inactive"}[value]
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _blocking(running: RuntimeMonitor[Any]) -> str:
    faults = running.faults()
    omission = str(running.omission()[1]) if hasattr(running, "omission") else ""
    reasons = {name: faults.get(name) or omission for name in running.blocked()}
    texts = [f"{name} ({reason})" if reason else name for name, reason in reasons.items()]
    return f"  waits for {', '.join(texts)}" if texts else ""

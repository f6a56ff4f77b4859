"""A monitor in this process: the same model text and the same runtime as in a package."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from eddi_runtime import Monitor as RuntimeMonitor
from eddi_runtime.model_file import parse_model
from eddi_runtime.monitor import Value, build

from eddi_scaffold.binding import Monitor
from eddi_scaffold.plotting.svg import plot
from eddi_scaffold.plotting.tracks import tracks_of
from eddi_scaffold.recording import Recording, frames, replay


def steps(monitor: Monitor, recording: Recording) -> Iterator[tuple[float, Any]]:
    """Yield (time in seconds, output as JSON) for each row of a recording."""
    running = compiled(monitor)
    return ((t, running.as_json(output)) for t, output in replay(running, recording))


def changes(monitor: Monitor, recording: Recording) -> Iterator[str]:
    """Yield a line for the first step and for each one whose output differs from the last.

    A line says which inputs keep outputs from being given.
    """
    running = compiled(monitor)
    last: object = None
    for t, output in replay(running, recording):
        values = running.series(output)
        shown = "  ".join(f"{name} {_shown(value)}" for name, value in values.items())
        if shown != last:
            yield f"{t:10.3f}  {shown}{_blocking(running)}".rstrip()
        last = shown


def table(monitor: Monitor, recording: Recording) -> Iterator[str]:
    """Yield the lines of a CSV: time, then every named value of the output in each step."""
    running = compiled(monitor)
    for number, (t, output) in enumerate(replay(running, recording)):
        values = running.series(output)
        if number == 0:
            yield _csv_line(["t", *values])
        yield _csv_line([repr(t), *(_cell(value) for value in values.values())])


def picture(monitor: Monitor, recording: Recording) -> str:
    """Return an SVG of inputs and outputs over time."""
    running = compiled(monitor)
    inputs: list[tuple[float, Mapping[str, object]]] = []
    outputs: list[tuple[float, Mapping[str, object]]] = []
    for frame in frames(running, recording):
        inputs.append((frame.t, {k: v for k, v in frame.inputs.items() if not _is_list(v)}))
        outputs.append((frame.t, running.series(frame.output)))
    title = f"{monitor.kind.title} {monitor.model.name}"
    return plot(title, [*tracks_of("inputs", inputs), *tracks_of("outputs", outputs)])


def compiled(monitor: Monitor) -> RuntimeMonitor:
    """Return the monitor as its package would load it; hand-written code is not in it."""
    files = monitor.kind.data_files(monitor.model)
    return build(parse_model(monitor.model_json, monitor.model.name, files))


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


def _blocking(running: RuntimeMonitor) -> str:
    blocked = running.blocked()
    return f"  waits for {', '.join(blocked)}" if blocked else ""

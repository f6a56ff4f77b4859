"""A monitor in this process: the same model text and the same runtime as in a package."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from eddi_runtime import Monitor as RuntimeMonitor
from eddi_runtime.model_file import parse_model
from eddi_runtime.monitor import Value, build

from eddi_scaffold.binding import Monitor
from eddi_scaffold.recording import Recording, replay


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


def compiled(monitor: Monitor) -> RuntimeMonitor:
    """Return the monitor as its package would load it; hand-written code is not in it."""
    files = monitor.kind.data_files(monitor.model)
    return build(parse_model(monitor.model_json, monitor.model.name, files))


def _shown(value: Value) -> str:
    if value is None:
        return "unknown "
    if isinstance(value, bool):
        return "active  " if value else "inactive"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _blocking(running: RuntimeMonitor) -> str:
    blocked = running.blocked()
    return f"  waits for {', '.join(blocked)}" if blocked else ""

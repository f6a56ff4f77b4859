"""A monitor in this process: the same model text and the same runtime as in a package."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from eddi_runtime import Monitor as RuntimeMonitor
from eddi_runtime.model_file import parse_model
from eddi_runtime.monitor import build

from eddi_scaffold.binding import Monitor
from eddi_scaffold.recording import Recording, replay


def steps(monitor: Monitor, recording: Recording) -> Iterator[tuple[float, Any]]:
    """Yield (time in seconds, output) for each row of a recording."""
    return replay(_compiled(monitor), recording)


def changes(monitor: Monitor, recording: Recording) -> Iterator[str]:
    """Yield a line for the first step and for each one whose output differs from the last.

    A line says which inputs keep outputs from being given.
    """
    running = _compiled(monitor)
    last: object = None
    for t, output in replay(running, recording):
        if output != last:
            yield f"{t:10.3f}  {_shown(output)}{_blocking(running)}".rstrip()
        last = output


def _compiled(monitor: Monitor) -> RuntimeMonitor:
    return build(parse_model(monitor.model_json, monitor.model.name))


def _shown(output: Any) -> str:
    if isinstance(output, list) and all(isinstance(o, dict) and "active" in o for o in output):
        return "  ".join(f"{o['id']} {'active  ' if o['active'] else 'inactive'}" for o in output)
    return json.dumps(output, ensure_ascii=False)


def _blocking(running: RuntimeMonitor) -> str:
    blocked = running.blocked()
    return f"  waits for {', '.join(blocked)}" if blocked else ""

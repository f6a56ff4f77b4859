"""Recordings played to one monitor, one step per row."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from eddi_scaffold.monitors.binding import Monitor
from eddi_scaffold.replay.parts import of_values
from eddi_scaffold.replay.playing import Play, play
from eddi_scaffold.replay.recordings import read_recording, tape_of
from eddi_scaffold.replay.steps import ROWS, Rhythm
from eddi_scaffold.source import Source


def played(monitor: Monitor, source: Source, rhythm: Rhythm = ROWS) -> Play:
    """Yield the steps of a monitor on a CSV file."""
    types: Mapping[str, Any] = {one.model.id: one.model.type for one in monitor.inputs}
    recording, problems = read_recording(source, types)
    assert recording is not None, problems
    return play([of_values(monitor, rhythm)], tape_of(recording))

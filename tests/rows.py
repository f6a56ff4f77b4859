"""Recordings played to one monitor, one step per row."""

from __future__ import annotations

from eddi_scaffold.common.files import Source
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.recordings.csv_recording import read_tape
from eddi_scaffold.recordings.parts import columns, of_values
from eddi_scaffold.recordings.playing import ROWS, Playback, StepRule, play


def played(monitor: BoundMonitor, source: Source, rhythm: StepRule = ROWS) -> Playback:
    """Yield the steps of a monitor on a CSV file."""
    tape, _ = read_tape(source, columns([monitor]))
    return play(of_values([monitor], [rhythm]), tape)

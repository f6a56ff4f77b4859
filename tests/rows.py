"""Recordings played to one monitor, one step per row."""

from __future__ import annotations

from eddi_scaffold.common.files import Source
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.recordings.csv_recording import read_recording
from eddi_scaffold.recordings.playing import ROWS, Playback, StepRule, columns, of_values, play


def played(monitor: BoundMonitor, source: Source, rule: StepRule = ROWS) -> Playback:
    """Yield the steps of a monitor on a CSV file."""
    tape, _ = read_recording(source, columns([monitor]))
    return play(of_values([monitor], [rule]), tape)


def changes(out: str) -> list[tuple[str, str]]:
    """Return the time of each line, and 1 for what is active and 0 for what is inactive there."""
    digits = {"active": "1", "inactive": "0"}
    return [
        (line[:10].strip(), "".join(digits.get(word, "") for word in line.split()))
        for line in out.splitlines()
    ]

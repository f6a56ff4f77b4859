"""Recordings played to one monitor, one step per row."""

from __future__ import annotations

from eddi_scaffold.common.files import Source
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.recordings import playing
from eddi_scaffold.recordings.members import Member, read_values
from eddi_scaffold.recordings.playing import ROWS, Playback, StepRule, play


def played(monitor: BoundMonitor, source: Source, rule: StepRule = ROWS) -> Playback:
    """Yield the steps of a monitor on a CSV file."""
    members, recording, _ = read_values(source, [Member(monitor)])
    return play(playing.played(members, rule), recording)


def changes(out: str) -> list[tuple[str, str]]:
    """Return the time of each line, and 1 for what is active and 0 for what is inactive there."""
    digits = {"active": "1", "inactive": "0"}
    return [
        (line[:10].strip(), "".join(digits.get(word, "") for word in line.split()))
        for line in out.splitlines()
    ]

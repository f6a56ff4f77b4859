"""The example: a camera's scope that is the evidence of a ConSert."""

from pathlib import Path

import pytest

from eddi_scaffold.common.files import Source
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.recordings.results import changes
from tests.rows import played

EXAMPLE = Path(__file__).parents[3] / "examples" / "safeml"
"""Seconds from which on the recording is in fog."""


@pytest.fixture(scope="module")
def monitors() -> list[BoundMonitor]:
    configs = [EXAMPLE / "perception_config.yml", EXAMPLE / "landing_config.yml"]
    return monitors_of(EXAMPLE / "landing.yml", configs)[0]


def test_run_says_why_there_is_no_verdict(monitors: list[BoundMonitor]) -> None:
    good = "1 2 3 4 5 6"
    rows = [good, good, '""', "1 nan 3 4 5 6", "1 2 3", good, good, *[""] * 11, good]
    text = "t,frame\n" + "".join(f"{k / 10:g},{row}\n" for k, row in enumerate(rows))
    recording = played(monitors[0], Source("r.csv", text.encode()))
    said = [line for line in changes(recording) if "waits" in line]
    assert [(float(line.split()[0]), line.partition("waits for ")[2]) for line in said] == [
        (0.0, "frame (the window has 1 of 50 samples)"),
        (0.2, "frame (the message is empty)"),
        (0.3, "frame (feature 1 is not a finite number)"),
        (0.4, "frame (3 values, the reference has 6 features)"),
        (0.5, "frame (the window has 3 of 50 samples)"),
        (1.7, "frame (the last sample is older than 1 s)"),
        (1.8, "frame (the window has 1 of 50 samples)"),
    ]

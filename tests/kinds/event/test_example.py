"""The example: an event on the motor that is the evidence of a ConSert."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from eddi_scaffold.common.files import read_source
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.recordings.playing import compiled
from tests.rows import played

EXAMPLE = Path(__file__).parents[3] / "examples" / "motor-watch"


@pytest.fixture(scope="module")
def monitors() -> list[BoundMonitor]:
    configs = [EXAMPLE / "motor_config.yml", EXAMPLE / "drive_config.yml"]
    return monitors_of(EXAMPLE / "drive.yml", configs)[0]


def test_the_guarantee_follows_the_event(monitors: list[BoundMonitor]) -> None:
    motor, drive = monitors
    other = compiled(drive)
    full_speed = {}
    for part, frame in played(motor, read_source(EXAMPLE / "recording.csv")):
        ((_, event),) = part.running.message(frame.output)
        flags = other.execute_step(SimpleNamespace(MotorFit=event["active"]))
        full_speed[frame.t] = {row["id"]: row["active"] for row in flags}["FullSpeed"]
    on = [t for t in full_speed if full_speed[t]]
    assert (on[0], on[-1]) == (1.9, 10.9)
    assert not any(full_speed[t] for t in full_speed if 6.0 <= t < 8.1 or 9.0 <= t < 10.3)

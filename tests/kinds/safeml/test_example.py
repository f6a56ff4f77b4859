"""The example: a camera's scope that is the evidence of a ConSert."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.recordings.playing import compiled
from eddi_scaffold.recordings.results import changes
from tests.rows import played

EXAMPLE = Path(__file__).parents[3] / "examples" / "safeml"
FOG = 11.3
"""Seconds from which on the recording is in fog."""


@pytest.fixture(scope="module")
def monitors() -> list[BoundMonitor]:
    configs = [EXAMPLE / "perception_config.yml", EXAMPLE / "landing_config.yml"]
    return monitors_of(EXAMPLE / "landing.yml", configs)[0]


def test_usual_frames_pass_and_fog_is_seen_within_a_window(monitors: list[BoundMonitor]) -> None:
    scope, landing = monitors
    other = compiled(landing)
    verdicts, precise = {}, {}
    for part, frame in played(scope, read_source(EXAMPLE / "recording.csv")):
        one = part.running
        result = verdicts[frame.t] = frame.output
        # what the node would publish and the ConSert's node receive
        evidence = one.status_message()[1]["in_scope"]
        said = one.message(result)[1]
        assert evidence == (not said["omission"] and not said["odd_violation"])
        flags = other.execute_step(SimpleNamespace(CameraInScope=evidence, MarkerVisible=True))
        precise[frame.t] = {row["id"]: row["active"] for row in flags}["PreciseLanding"]
        assert precise[frame.t] == (not result.omission and not result.odd_violation)
    assert all(verdicts[t].omission for t in verdicts if t < 4.9)
    assert not any(verdicts[t].odd_violation for t in verdicts if t < FOG)
    assert [verdicts[t].reason for t in (11.0, 11.1, 11.2)] == ["empty", "empty", "wrong_length"]
    assert verdicts[FOG + 5.0].odd_violation
    assert min(t for t in verdicts if verdicts[t].odd_violation) < FOG + 2.0
    assert precise[10.9]
    assert not precise[11.0]
    assert not precise[17.2]
    worst = one.explain()[0]
    assert worst.violated
    assert {feature for feature, _ in worst.weights[:2]} & {1, 2}  # contrast and sharpness


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


def test_the_status_message_has_the_evidence_as_a_field(tmp_path: Path) -> None:
    text = (EXAMPLE / "landing_config.yml").read_text("utf-8")
    expression = "expression: NOT scope.omission AND NOT scope.odd_violation"
    assert expression in text
    config = tmp_path / "landing_config.yml"
    config.write_text(
        text.replace(expression, "requires: [scope]\n    field: in_scope")
        .replace("SafeMLOutput", "SafeMLStatus")
        .replace("camera_scope/safeml", "camera_scope/safeml/status")
    )
    (landing,), problems = monitors_of(EXAMPLE / "landing.yml", [config])
    assert problems == []
    assert landing.inputs[0].expression == "given(scope.in_scope, True, (scope.omission, False))"

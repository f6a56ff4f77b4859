"""SafeML on a real ROS 1: every frame counts once, the verdict reaches the ConSert."""

import json
import math
import random
from pathlib import Path
from types import SimpleNamespace

import pytest

from eddi_scaffold.recordings.packaged import load
from tests.e2e.robot import Run
from tests.e2e.workspace import Workspace
from tests.ros1.world import PYTHON, until

pytestmark = [pytest.mark.ros, pytest.mark.slow]
OUTPUT, STATUS = "/camera_scope/safeml", "/camera_scope/safeml/status"
LANDING = "/landing/guarantees"
STREAM = Path(__file__).with_name("safeml_stream.py")


class ScopeRun(Run):
    TOPICS = (OUTPUT, STATUS, LANDING)


@pytest.fixture(scope="module")
def built(generator, folder, home):
    """The workspace of the example, without a hand edit."""
    workspace = Workspace(folder / "scope", home)
    example = generator.path / "examples" / "safeml"
    configs = (example / "perception_config.yml", example / "landing_config.yml")
    generator.generate(workspace.path, example / "landing.yml", *configs)
    workspace.catkin_make()
    return workspace


def recorded(generator):
    """Return the frames of the example's recording: usual ones, then those in fog."""
    lines = (generator.path / "examples" / "safeml" / "recording.csv").read_text().splitlines()
    cells = [line.partition(",")[2] for line in lines[1:]]
    frames = [[float(part) for part in cell.split()] for cell in cells if cell and '"' not in cell]
    whole = [frame for frame in frames if len(frame) == 6]
    return whole[:110], whole[110:]


def spoilt(frames, chance):
    """Put five empty frames and five with NaN among some."""
    frames = list(frames)
    for bad in [[]] * 5 + [[math.nan] * 6] * 5:
        frames.insert(chance.randrange(60, len(frames)), bad)
    return frames


def offline(package, frames):
    """Return (accepted, rejected) -> the result after each frame, without ROS."""
    monitor = load(package).new()[0].monitor
    found = {}
    for frame in frames:
        result = monitor.execute_step(SimpleNamespace(frame=frame), 0)
        found[result.accepted, result.rejected] = result
    return found


def test_from_the_camera_to_the_guarantee(generator, built, roscore, tmp_path):
    usual, fog = recorded(generator)
    frames = [*spoilt(usual, random.Random(4)), *fog]
    (tmp_path / "frames.json").write_text(json.dumps(frames))
    expected = offline(built.packages / "camera_scope", frames)
    with ScopeRun(roscore, built.devel_env(), tmp_path / "run") as run:
        run._start(PYTHON, str(STREAM), str(tmp_path / "frames.json"))
        until(lambda: run.messages(OUTPUT), 30.0, "the first word")
        assert run.messages(OUTPUT)[0]["omission"] is True
        total = (len(frames) - 10, 10)
        until(lambda: total in counted(run), 60.0, "all frames counted")
        until(lambda: precise(run)[-1:] == [False], 10.0, "the end of the guarantee")
        statuses, outputs = run.messages(STATUS), run.messages(OUTPUT)
        assert "died" not in run.launch_text(), run.launch_text()
        assert "Traceback" not in run.launch_text(), run.launch_text()
    check_statuses(statuses, expected)
    check_verdicts(statuses, len(usual))
    assert {frozenset(message) for message in outputs} == {
        frozenset({"omission", "odd_violation", "significance_level"})
    }
    assert outputs[-1]["significance_level"] == pytest.approx(0.01, abs=1e-8)
    assert True in precise(run)


def counted(run):
    return {counts(status) for status in run.messages(STATUS)[-10:]}


def counts(status):
    return status["accepted"], status["rejected"]


def precise(run):
    """Return what each message says of the guarantee that needs the camera."""
    return [
        {item["id"]: item["active"] for item in message["guarantees"]}["PreciseLanding"]
        for message in run.messages(LANDING)
    ]


def check_statuses(statuses, expected):
    """Each verdict is the one that the same frames give without ROS."""
    compared = 0
    for status in statuses:
        if not status["omission"]:
            wanted = expected[counts(status)]
            assert status["statistic"] == pytest.approx(wanted.statistic, rel=1e-9)
            assert status["threshold"] == wanted.threshold
            assert status["component"] == wanted.component
            compared += 1
    assert compared > 30


def check_verdicts(statuses, usual):
    usual_ones = [one for one in statuses if one["accepted"] <= usual]
    assert not any(one["odd_violation"] for one in usual_ones)
    assert any(one["in_scope"] for one in usual_ones)
    # an empty frame and one with NaN are omissions, also where the window is full
    reasons = {one["reason"] for one in usual_ones if one["filled"] == 50}
    assert {"", "empty", "not_finite"} <= reasons
    within = [one for one in statuses if one["accepted"] >= usual + 50 and not one["omission"]]
    assert within
    assert all(one["odd_violation"] for one in within)
    assert statuses[-1]["window_size"] == 50

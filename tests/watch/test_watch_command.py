"""``watch`` on a recording of two robots."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.cli.command import ROOT, run
from tests.diagnosed import assert_reported
from tests.pages import ask
from tests.watch.recorded import bag_of_two

pytest.importorskip("rosbags", reason="the extra `bags` is not installed")


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return bag_of_two(tmp_path_factory.mktemp("fleet") / "fleet.bag")


def test_a_line_for_each_change(bag: Path, tmp_path: Path) -> None:
    result = run("watch", "--text", "--bag", bag, cwd=tmp_path)
    assert (result.status, result.err) == (0, "")
    lines = result.out.splitlines()
    assert "    12.300  /robot1  warehouse  FullSpeed  unknown   PathClear" in lines
    assert "    18.900  /robot1  warehouse  FullSpeed  active" in lines
    held = "/robot1  localisation  PoseIsGood  unknown   it holds, but not for long enough yet"
    assert f"     0.100  {held}" in lines
    assert "     0.100  /robot1  people  in_scope  unknown   the window is not full yet" in lines
    differs = "/robot1  people  in_scope  not active   the samples differ from the reference"
    assert f"    26.600  {differs}" in lines
    gone = "  /robot2  warehouse  StandStill  unknown   no message for more than 3 s"
    assert sum(line.endswith(gone) for line in lines) == 1
    times = [float(line[:10]) for line in lines]
    assert times == sorted(times)


def test_a_bag_of_ros_2_says_the_same(bag: Path, tmp_path: Path) -> None:
    from rosbags.convert.converter import convert

    convert([bag], tmp_path / "ros2", "mcap", 8, None, "file", None, None, (), (), (), ())
    first = run("watch", "--text", "--bag", bag, cwd=tmp_path).out.splitlines()
    second = run("watch", "--text", "--bag", "ros2", cwd=tmp_path).out.splitlines()
    # ROS 2 does not say what was kept: what was said first is believed
    assert set(first[20:]) <= set(second)
    assert len(second) == len(first)


def test_json_of_one_robot(bag: Path, tmp_path: Path) -> None:
    result = run("watch", "--bag", bag, "--robot", "second=/robot2", "--json", cwd=tmp_path)
    rows = [json.loads(line) for line in result.out.splitlines()]
    assert {row["robot"] for row in rows} == {"second"}
    last = rows[-1]
    assert (last["state"], last["before"]) == ("unknown", "active")
    assert last["reasons"] == ["no message for more than 3 s"]


@pytest.mark.slow
def test_the_page_plays_a_recording_to_its_end(bag: Path) -> None:
    env = {**os.environ, "PYTHONPATH": f"{ROOT}:{ROOT / 'runtime_lib' / 'src'}"}
    words = ["watch", "--bag", str(bag), "--speed", "20"]
    command = [sys.executable, "-m", "eddi_scaffold", *words]
    with subprocess.Popen(command, env=env, stderr=subprocess.PIPE, text=True) as running:
        assert running.stderr is not None
        said = running.stderr.readline()
        found = re.search(r"http://127\.0\.0\.1:(\d+)/", said)
        assert found is not None, said
        end = time.monotonic() + 20.0
        text = ""
        while "The recording has ended." not in text and time.monotonic() < end:
            status, _, text = ask(int(found[1]), "/")
            assert status == 200
            time.sleep(0.1)
        assert "The recording has ended." in text
        assert "/robot2 warehouse StandStill is unknown" in text
        running.send_signal(signal.SIGINT)
        assert running.wait(10) == 130


def test_without_rospy_it_says_what_to_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("PYTHONPATH", "")
    monkeypatch.setattr("eddi_scaffold.watch.ros1.SYSTEM_PYTHON", sys.executable)
    result = run("watch", "--text", cwd=tmp_path)
    assert (result.status, result.err.count("source ROS")) == (2, 1)
    assert_reported("I010", result.err)

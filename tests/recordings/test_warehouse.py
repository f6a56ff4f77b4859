"""The robot of the tutorial: five monitors on a bag in which sensors die."""

import importlib.util
import json
from pathlib import Path
from types import ModuleType

import pytest

from tests.cli.command import ROOT, run

pytest.importorskip("rosbags", reason="the extra `bags` is not installed")

ROBOT = ROOT / "examples" / "warehouse-robot"


@pytest.fixture
def script() -> ModuleType:
    spec = importlib.util.spec_from_file_location("shift", ROOT / "script" / "shift.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def played(folder: Path, bag: Path) -> str:
    """Return what is printed; the picture is ``shift.svg`` in the folder."""
    words = ("--bag", bag, "--plot", folder / "shift.svg")
    result = run("-q", "run", ROBOT / "robot.yml", *words, cwd=folder)
    assert (result.status, result.err) == (0, "")
    return result.out


def messages(path: Path) -> list[tuple[str, int, bytes]]:
    from rosbags.rosbag1 import Reader

    with Reader(path) as bag:
        return [(channel.topic, t, bytes(data)) for channel, t, data in bag.messages()]


def test_the_picture_is_of_the_recording(tmp_path: Path) -> None:
    out = played(tmp_path, ROBOT / "shift.bag")
    assert (
        "12.300  lidar: PathClear unknown   <- nearest <- /lidar/nearest: nothing for 0.4 s" in out
    )
    assert (tmp_path / "shift.svg").read_bytes() == (ROOT / "docs/shift.svg").read_bytes()


CHAIN = "PathClear <- nearest <- /lidar/nearest: nothing for 0.8 s, limit 0.3 s"


@pytest.mark.parametrize(
    ("words", "status", "lines"),
    [
        (["--at", "3.5"], 0, ["warehouse: FullSpeed holds"]),
        (["--at", "12.7"], 1, [f"warehouse: FullSpeed <- {CHAIN}", f"  since 11.900  {CHAIN}"]),
    ],
)
def test_a_claim_is_explained_at_a_time(words: list[str], status: int, lines: list[str]) -> None:
    arguments = ("explain", "FullSpeed", "robot.yml", "--bag", "shift.bag", *words)
    done = run(*arguments, cwd=ROBOT)
    assert (done.status, done.out.splitlines()) == (status, lines), done.err
    named = json.loads(
        run("explain", "warehouse.FullSpeed", *arguments[2:], "--json", cwd=ROBOT).out
    )
    assert (named["t"], named["text"]) == (float(words[1]), lines[0].partition(": ")[2] * status)


def test_a_claim_of_nobody_is_said(tmp_path: Path) -> None:
    done = run("explain", "FullSped", "robot.yml", "--bag", "shift.bag", cwd=ROBOT)
    assert (done.status, "did you mean 'FullSpeed'?" in done.err) == (2, True)


def test_the_recording_is_what_the_script_writes(tmp_path: Path, script: ModuleType) -> None:
    script.write_bag(tmp_path / "shift.bag")
    script.write_reference(tmp_path / "reference_sample.csv")
    script.write_faults(tmp_path / "faults.csv")
    assert messages(tmp_path / "shift.bag") == messages(ROBOT / "shift.bag")
    for name in ("reference_sample.csv", "faults.csv"):
        assert (tmp_path / name).read_bytes() == (ROBOT / name).read_bytes()


def test_its_guarantees_are_gone_in_time() -> None:
    words = ("--inputs", "faults.csv", "--phases", "2", "--json")
    done = run("-q", "inject", "robot.yml", *words, cwd=ROBOT)
    assert (done.status, done.err) == (0, "")
    rows = json.loads(done.out)["rows"]
    assert {row["verdict"] for row in rows if row["fault"] != "freeze"} == {"met"}
    (frozen,) = (row for row in rows if row["fault"] == "freeze")
    assert (frozen["verdict"], frozen["accepted"], frozen["measured_s"]) == ("no bound", True, None)
    # no probability lies in the band of the localisation: it is as if there was none
    assert {row["bound_s"] for row in rows if "localisation" in row["topic"]} == {0.7, 0.2, 0.3}


def test_any_source_that_dies_takes_full_speed_away(
    tmp_path: Path, script: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Silence of one topic, through a monitor of each kind, never leaves it active."""
    recorded = [one for one in script.recording() if one[0] < 14.0]
    for topic in sorted({topic for _, topic, _, _ in recorded}):
        left = [one for one in recorded if one[1] != topic or one[0] < 5.0]
        monkeypatch.setattr(script, "recording", lambda left=left: iter(left))
        bag = tmp_path / "silent.bag"
        bag.unlink(missing_ok=True)
        script.write_bag(bag)
        lines = [line.split() for line in played(tmp_path, bag).splitlines()]
        states = [(float(t), words[1]) for t, who, *words in lines if who == "warehouse:"]
        assert "active" in {state for t, state in states if t < 5.0}, topic
        time, state = next(one for one in states if one[0] >= 5.0)
        assert (state, time <= 8.0) == ("unknown", True), topic
        assert {state for t, state in states if t >= 5.0} <= {"inactive", "unknown"}, topic

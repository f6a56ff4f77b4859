"""Events as a kind: a file becomes a monitor, a package, and runs on recorded inputs."""

import json
from pathlib import Path
from types import SimpleNamespace

import pytest

from eddi_scaffold.common.files import read_source
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.recordings.playing import compiled
from tests.cli.command import run
from tests.rows import played

TEXT = """\
VAR temp : NUMBER UNIT degC RANGE -40 .. 200 TIMEOUT 1s
VAR warning : BOOL TIMEOUT 1s
EVENT hot (EVIDENCE) := AVERAGE(temp, 500ms) > 100 degC AND TIME(warning, 500ms)
EVENT cold (HAZARD) := temp < 10
"""
CONFIG = """\
Model: {id: overheat, type: Event, frequency: 10, parameters: [{file: overheat.events}]}
SimulatorOutputs:
  - {id: temp, type: std_msgs.Float32, topic: /temp}
  - {id: warning, type: std_msgs.Bool, topic: /warning}
EDDIInputs:
  - {id: temp, type: float, requires: [temp], field: data, max_age: 1}
  - {id: warning, type: bool, requires: [warning], field: data, max_age: 1}
EDDIOutputs:
  - {id: overheat, topic: /events}
"""
CSV = "t,temp,warning\n" + "".join(f"{k / 10},{120 if k < 8 else 5},true\n" for k in range(14))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "overheat.events").write_text(TEXT)
    (tmp_path / "eddi_config.yml").write_text(CONFIG)
    (tmp_path / "values.csv").write_text(CSV)
    return tmp_path


def test_several_events_on_one_topic_are_no_evidence_for_others(folder: Path) -> None:
    both = run("check", "overheat.events", "eddi_config.yml", cwd=folder)
    told = "warning: 2 events share one topic: the latest message may be from any of them [W005]"
    assert f"overheat.events:4:7: {told}\n    EVENT cold (HAZARD) := temp < 10\n" in both.err
    config = folder / "eddi_config.yml"
    text = config.read_text()
    outputs = "EDDIOutputs:\n  - {id: e, topic: /e, event: %s}\n"
    (first, *_) = [line.split()[1] for line in TEXT.splitlines() if line.startswith("EVENT")]
    config.write_text(text.partition("EDDIOutputs:")[0] + outputs % first)
    apart = run("check", "overheat.events", "eddi_config.yml", cwd=folder)
    assert "W005" not in apart.err
    (folder / "ws" / "src").mkdir(parents=True)
    words = ("generate", "-w", "ws", "-m", "overheat.events", "-c", "eddi_config.yml")
    assert run(*words, cwd=folder).status == 0
    (node,) = (folder / "ws/src").glob("*/*/scripts/RosNode.py")
    assert f"only={first!a}," in node.read_text()
    config.write_text(text.partition("EDDIOutputs:")[0] + outputs % "nothing")
    wrong = run(*words, cwd=folder)
    assert (wrong.status, "[K020]" in wrong.err) == (2, True)
    config.write_text(text)
    (folder / "overheat.events").write_text(TEXT.rpartition("EVENT")[0])
    alone = run("check", "overheat.events", "eddi_config.yml", cwd=folder)
    assert "W005" not in alone.err


def test_run_on_recorded_inputs(folder: Path) -> None:
    words = ("run", "overheat.events", "-c", "eddi_config.yml", "-i", "values.csv", "--json")
    result = run(*words, cwd=folder)
    assert result.status == 0, result.err
    rows = [json.loads(line)["outputs"] for line in result.out.splitlines()]
    assert [row[0]["verdict"] for row in rows] == [None] * 4 + [True] * 4 + [False] * 6
    assert [row[1]["raised"] for row in rows] == [False] * 8 + [True] + [False] * 5
    alone = run("run", "overheat.events", "-i", "values.csv", "--json", cwd=folder)
    assert alone.out == result.out


SCAN = """\
VAR scan.ranges[*] : NUMBER UNIT m TIMEOUT 1s ALLOW INF
EVENT free (EVIDENCE) := MIN(scan.ranges[*], COVERAGE 0.5) > 80 cm
"""
SCAN_CONFIG = """\
Model: {id: scanner, type: Event, frequency: 10, parameters: [{file: scanner.events}]}
SimulatorOutputs:
  - {id: scan, type: sensor_msgs.LaserScan, topic: /scan, max_age: 1}
EDDIInputs:
  - {id: "scan.ranges[*]", type: "float[]", requires: [scan], field: ranges}
EDDIOutputs:
  - {id: scanner, topic: /events}
"""


def test_a_list_is_an_input_of_a_monitor(tmp_path: Path) -> None:
    (tmp_path / "scanner.events").write_text(SCAN)
    (tmp_path / "eddi_config.yml").write_text(SCAN_CONFIG)
    rows = ["0,1 2 nan", "0.1,1 nan nan", "0.2,0.5 2 inf", "0.3,", "0.4,"]
    (tmp_path / "values.csv").write_text("\n".join(["t,scan.ranges[*]", *rows]) + "\n")
    assert run("check", "eddi_config.yml", "scanner.events", cwd=tmp_path).status == 0
    found = run("run", "eddi_config.yml", "--inputs", "values.csv", "--json", cwd=tmp_path)
    verdicts = [json.loads(line)["outputs"][0]["verdict"] for line in found.out.splitlines()]
    assert verdicts == [True, None, False, False, False]
    words = ("generate", "--platform", "plain", "-o", "out", "-m", "scanner.events")
    made = run(*words, "-c", "eddi_config.yml", cwd=tmp_path)
    assert made.status == 0, made.err
    (text,) = [file.read_text() for file in (tmp_path / "out").rglob("scanner/EDDIInput.py")]
    assert "= scan.ranges" in text


def test_the_monitor_says_what_its_text_accepts_while_it_claims(tmp_path: Path) -> None:
    (tmp_path / "scanner.events").write_text(SCAN)
    config = tmp_path / "eddi_config.yml"
    config.write_text(SCAN_CONFIG)
    (made,), _ = monitors_of(None, [config])
    monitor = made.compiled.monitor(made.id)
    (name,) = [spec.attribute for spec in monitor.inputs]

    def said(values: object, second: int) -> tuple[object, object]:
        output = monitor.execute_step(SimpleNamespace(**{name: values}), second * 10**9)
        ((_, fields),) = monitor.message(output)
        assert fields["accepted"] == list(monitor.accepted())
        return fields["active"], fields["accepted"]

    assert said([1.0, 2.0, None], 0) == (True, ["free: COVERAGE 0.5", "free: ALLOW INF"])
    assert said([0.1, 0.2, 0.3], 1) == (False, [])


@pytest.mark.parametrize(
    ("text", "code"), [("x + 1", "E007"), ("EVENT e (HAZARD) := x >", "E001"), ("", "E001")]
)
def test_wrong_files(text: str, code: str, folder: Path) -> None:
    (folder / "overheat.events").write_text(text)
    result = run("check", "overheat.events", cwd=folder)
    assert (result.status, f"[{code}]" in result.err) == (1, True)


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

"""Events as a kind: a file becomes a monitor, a package, and runs on recorded inputs."""

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
from lxml import etree

from eddi_scaffold import api
from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.common.problems import Problem
from eddi_scaffold.kinds import Model, Options
from eddi_scaffold.monitors.binding import BoundMonitor, monitor_of
from eddi_scaffold.monitors.loading import read_models
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
    assert "overheat.events:4:7: warning: 2 events share one topic" in both.err
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


MODELS = Path(__file__).parents[2] / "eddi_xml" / "models"
LANDING = (MODELS / "landing.xml").read_text("utf-8")
EVENTS = """// of the winding
VAR temp : NUMBER UNIT degC RANGE -40 .. 200 TIMEOUT 500ms
EVENT hot (HAZARD) := ONCE(temp > 80 degC, 2s)
EVENT MotorFit (EVIDENCE) := AVERAGE(temp, 2s) < 70 degC AND NOT hot
"""


def models(text: str) -> dict[str, Model]:
    reading = read_models(Source("landing.xml", text.encode()))
    assert [one for one in reading.problems if one.level == "error"] == []
    return {model.name: model for model in reading.models}


def part(model: Model) -> object:
    monitor, problems = monitor_of(replace(model, name="m"), None)
    assert monitor is not None, problems
    lines = monitor.compiled.text.partition("\nclass ")[2].splitlines()
    return [line for line in lines if not line.lstrip().startswith(("digest =", "#"))]


def problems(text: str) -> list[Problem]:
    return list(read_models(Source("landing.xml", text.encode())).problems)


def test_they_are_the_events_of_a_file() -> None:
    found = models(LANDING)["motor_watch"]
    (alone,) = read_models(Source("motor_watch.events", EVENTS.encode())).models
    assert found.export() == {"motor_watch.events": EVENTS}
    assert part(found) == part(alone)


def test_another_tool_may_write_the_file() -> None:
    """As EMF does: other blanks, other prefixes, no comments; the maps with their order stay."""
    tree = etree.fromstring(LANDING.encode(), etree.XMLParser(remove_blank_text=True))
    assert tree.tag.endswith("DDIPackage")
    written = etree.tostring(tree, xml_declaration=True, encoding="ASCII").decode("ascii")
    assert written != LANDING
    one, other = models(LANDING), models(written)
    assert one.keys() == other.keys()
    assert part(one["motor_watch"]) == part(other["motor_watch"])
    assert one["motor_watch"].source.sha256 == other["motor_watch"].source.sha256


def test_the_frequency_counts_without_a_configuration() -> None:
    for text, rate in ((LANDING, 10.0), (LANDING.replace('"10"', '"50"'), 50.0)):
        configured, _ = models(text)["motor_watch"].configure(Options())
        assert configured is not None
        assert f"{rate:g} steps a second" in "".join(configured.readme())


def test_what_only_the_rate_decides_is_told_at_the_value() -> None:
    text = LANDING.replace("ONCE(temp > 80 degC, 2s)", "ONCE(temp > 80 degC, 1ms)")
    (model,) = [one for name, one in models(text).items() if name == "motor_watch"]
    configured, (problem, *_) = model.configure(Options(frequency=10.0))
    assert configured is None
    lines = text.splitlines()
    assert "1ms" in lines[(problem.place.line or 0) - 1]
    column = lines[(problem.place.line or 0) - 1].partition('value="')[2].index("1ms") + 1
    assert problem.message.startswith(f"EVENT, column {column}: ")


def test_an_error_stops_generation(tmp_path: Path) -> None:
    (tmp_path / "landing.xml").write_text(LANDING.replace("ONCE(temp", "ONCE(tmp"), "utf-8")
    refused = run("generate", "--platform", "plain", "-o", "out", "-m", "landing.xml", cwd=tmp_path)
    assert (refused.status, "[E008]" in refused.err) == (2, True)
    assert not (tmp_path / "out").exists()


def test_safeml_settings_are_those_of_a_file(tmp_path: Path) -> None:
    for name in ("scope.xml", "scope.csv"):
        (tmp_path / name).write_bytes((MODELS / name).read_bytes())
    assert run("export", "scope.xml", "-o", "out", cwd=tmp_path).status == 0
    (alone,) = read_models(read_source(tmp_path / "out" / "camera_scope.safeml.yml")).models
    (found,) = read_models(read_source(tmp_path / "scope.xml")).models
    assert part(alone) == part(found)


@pytest.mark.parametrize("name", ["w.events", "w.xml"])
def test_silence_is_a_matter_of_the_configuration(tmp_path: Path, name: str) -> None:
    model, config = tmp_path / name, tmp_path / "c.yml"
    whole = EVENTS if name == "w.events" else LANDING
    model.write_text(whole.replace(" TIMEOUT 500ms", ""), "utf-8")
    entry = "{id: temp, type: float, requires: [t], field: data, max_age: 0.5}"
    text = (
        f"Model: {{id: motor_watch, type: Event, parameters: [{{model: {name}}}]}}\n"
        "SimulatorOutputs: [{id: t, type: std_msgs.Float64, topic: t}]\n"
        f"EDDIInputs: [{entry}]\n"
        "EDDIOutputs: [{id: e, topic: e}]\n"
    )
    config.write_text(text, "utf-8")

    def codes(*files: Path) -> set[str]:
        return {one.code for one in api.check(files)} & {"W003", "K017"}

    assert codes(model) == codes(model, config) == codes(config) == set()
    config.write_text(text.replace(", max_age: 0.5", ""), "utf-8")
    assert codes(model, config) == codes(config) == {"K017"}

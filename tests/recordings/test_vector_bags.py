"""Test vectors as a bag: what a monitor says of each, played as its node would receive it."""

import json
from pathlib import Path

import pytest

from eddi_scaffold.packages.assembly import monitors_of, only
from tests.cli.command import example, run

pytest.importorskip("rosbags", reason="the extra `bags` is not installed")

MODEL = """evidence:
  Near: {is: 0 .. 2.5 m}
  Ready: {is: bool}
  Mode: {is: [auto, manual]}
  Tilt: {is: 0 .. 0.1 rad}
guarantees:
  Drive: {when: (Near AND Ready) OR Mode}
  Turn: {when: Tilt AND Ready}
"""
CONFIG = """MessageTypes:
  my_msgs/State: {header: Header, name: string, level: "float64[3]", ready: bool, mode: string}
Model: {id: rover, type: ConSert, model: rover.yml, frequency: 5}
SimulatorOutputs:
  - {id: scan, type: std_msgs/Float32, topic: scan}
  - {id: state, type: my_msgs/State, topic: /state}
  - {id: imu, type: sensor_msgs/Imu, topic: /imu}
EDDIInputs:
  - {id: Near, from: scan, max_age: 0.5 s, unit: cm}
  - {id: Ready, from: state.ready, max_age: 0.5 s}
  - {id: Mode, from: state.mode, max_age: none}
  - {id: Tilt, from: imu.orientation.x, max_age: 3 s}
"""


def told(folder: Path, config: str, bag: str, seconds: float) -> list[list[bool]]:
    """Return which guarantees are active at the end of each vector, which lasts for seconds."""
    result = run("run", config, "--bag", bag, "--json", cwd=folder)
    assert result.status == 0, result.err
    steps = [json.loads(line) for line in result.out.splitlines()]
    ends: dict[int, list[bool]] = {}
    for step in steps:
        ends[int(step["t"] / seconds)] = [row["active"] for row in step["outputs"]]
    return [*ends.values()]


@pytest.mark.parametrize("bag", ["vectors.bag", "vectors"])
def test_a_bag_has_the_vectors_of_a_consert(tmp_path: Path, bag: str) -> None:
    folder = example(tmp_path)
    config = folder / "consert_a_config.yml"
    named = "type: ConSert\n  model: two_conserts.xml"
    config.write_text(config.read_text().replace("type: ConSert", named, 1))
    result = run("inject", config.name, "--vectors", bag, cwd=folder)
    assert (result.status, result.err) == (0, f"{bag}: 9 vectors\n")
    rows = [line.split() for line in result.out.splitlines()]
    assert [row[2] for row in rows] == "TF TU UF FF FF UU FF TT UU".split()  # noqa: SIM905
    assert [float(row[0]) for row in rows[:3]] == [0.0, 2.2, 4.4]
    expected = [[letter == "T" for letter in row[2]] for row in rows[:-1]]  # the last is silence
    assert run("inject", config.name, "--vectors", bag, cwd=folder).status == 2  # it is kept
    assert told(folder, config.name, bag, 2.2) == expected


def test_fields_of_messages_are_filled_and_the_rest_is_named(tmp_path: Path) -> None:
    model, config = tmp_path / "rover.yml", tmp_path / "robot.yml"
    model.write_text(MODEL)
    config.write_text(CONFIG)
    result = run("inject", "robot.yml", "--vectors", "v.bag", cwd=tmp_path)
    assert (result.status, "v.bag: 15 vectors\n" in result.err) == (0, True), result.err
    left = result.err.splitlines()[-1].removeprefix("these cannot be messages: ").split(", ")
    assert len(left) == 14  # all that would have `Mode` or one field of `state` unknown
    assert {of.split(":")[0] for of in left} == {"unknown", "path_rest_unknown", "cut_rest_unknown"}
    monitor = only(monitors_of(model, [config])[0])
    rows = [row.split() for row in json.loads(monitor.model.vectors(monitor.bound, {}))["vectors"]]
    order = [of.model.id for of in monitor.inputs]
    said = [
        [letter == "T" for letter in verdicts]
        for letters, verdicts, _ in rows
        if letters[order.index("Mode")] != "U" and (letters[order.index("Ready")] != "U")
    ]
    assert told(tmp_path, "robot.yml", "v.bag", 3.4) == said


def test_a_monitor_without_such_vectors_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.events").write_text("VAR x : NUMBER EVENT near := x < 1")
    (tmp_path / "c.yml").write_text(
        "Model: {id: a, type: Event, model: a.events}\n"
        "SimulatorOutputs: [{id: x, type: std_msgs/Float32, topic: /x}]\n"
        "EDDIInputs: [{id: x, from: x, max_age: 1 s}]\n"
    )
    result = run("inject", "c.yml", "--vectors", "v.bag", cwd=tmp_path)
    assert result.status == 2
    assert "v.bag: error: no test vector of this monitor can be messages [G000]" in result.err
    assert not (tmp_path / "v.bag").exists()


TWO = """Model:
  {id: two, type: ConSert, model: two.yml, frequency: 10, filter: {kind: majority, window: 5}}
MessageTypes:
  my_msgs/Status: {status: "my_msgs/Value[]", level: float64}
  my_msgs/Value: {name: string, level: float64, text: string}
SimulatorOutputs: [{id: s, type: my_msgs/Status, topic: /s}]
EDDIInputs:
  - {id: A, from: 's.A', max_age: 2 s}
  - {id: B, from: 's.B', max_age: 2 s}
"""


def two(folder: Path, first: str, second: str, good: str) -> None:
    model = f"evidence: {{A: at least 2 m, B: {good}}}\nguarantees: {{S: A, F: B, Both: A AND B}}\n"
    (folder / "two.yml").write_text(model)
    (folder / "robot.yml").write_text(TWO.replace("s.A", first).replace("s.B", second))


def test_two_inputs_read_no_field_that_needs_two_values(tmp_path: Path) -> None:
    two(tmp_path, "s.level", "s.level", "at least 5 m")
    assert run("inject", "robot.yml", "--vectors", "v.bag", cwd=tmp_path).status == 2


@pytest.mark.parametrize("key", ["a", "b"])
def test_two_inputs_of_elements_with_a_key(tmp_path: Path, key: str) -> None:
    two(tmp_path, 's.status[name="a"].level', f's.status[name="{key}"].text', "[good, fine]")
    result = run("inject", "robot.yml", "--vectors", "v.bag", cwd=tmp_path)
    assert result.status == 0, result.err
    rows = [line.split() for line in result.out.splitlines()]
    said = [[letter == "T" for letter in row[2]] for row in rows]
    heard = told(tmp_path, "robot.yml", "v.bag", float(rows[1][0]))
    assert heard == said[: len(heard)]
    assert len(heard) >= len(said) - 1
    assert "these cannot be messages" in result.err  # only one of both unknown

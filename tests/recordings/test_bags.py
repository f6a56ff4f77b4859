"""A bag gives the verdicts that the node would have published."""

import json
import sqlite3
import sys
from collections.abc import Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from eddi_scaffold.platforms import chosen  # noqa: F401 - loads what commands load
from tests.cli.command import edit, example, run
from tests.data_files import data_text, tabled
from tests.diagnosed import assert_reported
from tests.rows import changes

rosbags = pytest.importorskip("rosbags", reason="the extra `bags` is not installed")

from rosbags.convert.converter import convert  # noqa: E402 - after the check
from rosbags.rosbag1 import Writer  # noqa: E402 - after the check that it is there
from rosbags.typesys import Stores, get_types_from_msg, get_typestore  # noqa: E402 - the same

SECOND = 1_000_000_000
EVIDENCE = "/rte/e0a"
DEMAND = "/consertb/guarantees"
Message = tuple[float, str, str, dict[str, Any]]


DEFINITIONS = {
    "eddi_messages/msg/Guarantee": "string id\nbool active\n",
    "eddi_messages/msg/ConSertOutput": "eddi_messages/Guarantee[] guarantees\n",
}


def written(
    path: Path, messages: Sequence[Message], definitions: Mapping[str, str] = DEFINITIONS
) -> Path:
    """Write a real bag; times are in seconds after an arbitrary start."""
    store = get_typestore(Stores.ROS1_NOETIC)
    for name, text in definitions.items():
        store.register(get_types_from_msg(text, name))
    with Writer(path) as writer:
        connections = {}
        for t, topic, of, fields in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, of, typestore=store)
            values = dict(fields)
            if "guarantees" in fields:
                guarantee = store.types["eddi_messages/msg/Guarantee"]
                values["guarantees"] = [guarantee(*pair) for pair in fields["guarantees"]]
            if "part" in fields:
                values["part"] = store.types["my_msgs/msg/Part"](*fields["part"])
                stamp = store.types["builtin_interfaces/msg/Time"](sec=1, nanosec=2)
                values["header"] = store.types["std_msgs/msg/Header"](1, stamp, "")
            message = store.types[of](**values)
            data = store.serialize_ros1(message, of)
            writer.write(connections[topic], round((100 + t) * SECOND), data)
    return path


def healthy(t: float, value: bool) -> Message:
    return (t, EVIDENCE, "std_msgs/msg/Bool", {"data": value})


def demand(t: float, active: bool) -> Message:
    pairs = [("other", True), ("System_A_G0_c2", active)]
    return (t, DEMAND, "eddi_messages/msg/ConSertOutput", {"guarantees": pairs})


def verdicts(folder: Path, *more: str) -> list[tuple[float, str]]:
    words = ["run", "two_conserts.xml", "-c", "consert_a_config.yml", "--bag", "a.bag", "--json"]
    result = run(*words, *more, cwd=folder)
    assert result.status == 0, result.err
    steps = [json.loads(line) for line in result.out.splitlines()]
    return [(step["t"], "".join("01"[one["active"]] for one in step["outputs"])) for step in steps]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return example(tmp_path)


def as_ros2(bag: Path, place: Path, storage: str, *, definitions: bool) -> None:
    convert([bag], place, storage, 8, None, "file", None, None, (), (), (), ())
    if not definitions:  # as Humble wrote them
        with closing(sqlite3.connect(place / f"{place.name}.db3")) as base, base:
            base.execute("DELETE FROM message_definitions")


@pytest.mark.parametrize(
    ("storage", "definitions"), [("mcap", True), ("sqlite3", True), ("sqlite3", False)]
)
def test_a_bag_of_ros2_gives_the_same_verdicts(
    folder: Path, storage: str, definitions: bool
) -> None:
    config = folder / "consert_a_config.yml"
    own = {
        "my_msgs/msg/Part": "float64 first\nbool ok\n",
        "my_msgs/msg/Whole": "std_msgs/Header header\nmy_msgs/Part part\n",
    }
    types = "MessageTypes:\n  my_msgs/Part: {first: float64, ok: bool}\n"
    types += "  my_msgs/Whole: {header: Header, part: my_msgs/Part}\n"
    text = config.read_text().replace("std_msgs.Bool", "my_msgs.Whole")
    text = text.replace("    max_age: 2.0", "    field: part.ok\n    max_age: 2.0")
    config.write_text(types + text)
    messages = [
        (t, EVIDENCE, "my_msgs/msg/Whole", {"part": (0.5, value)})
        for t, value in ((0, False), (0.25, True), (0.9, False))
    ]
    written(folder / "a.bag", [*messages, demand(0.45, True)], {**DEFINITIONS, **own})
    expected = verdicts(folder)
    assert {said for _, said in expected} == {"00", "10", "11"}
    as_ros2(folder / "a.bag", folder / "ros2", storage, definitions=definitions)
    (folder / "a.bag").unlink()
    assert verdicts(folder, "--bag", "ros2") == expected


def test_inputs_of_hand_written_code_stay_unknown(folder: Path) -> None:
    written(folder / "a.bag", [healthy(0, True), demand(0.0, True), demand(0.2, True)])
    config = folder / "consert_a_config.yml"
    edit(config, "    field: guarantees[System_A_G0_c2].active\n", "")
    words = ("run", "two_conserts.xml", "-c", config.name, "--bag", "a.bag", "--csv")
    result = run(*words, cwd=folder)
    assert_reported("I014", result.err)
    assert result.out.splitlines()[-1] == "0.2,true,false"


def test_without_the_extra_it_says_what_to_install(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written(folder / "a.bag", [healthy(0, True)])
    monkeypatch.setitem(sys.modules, "rosbags.rosbag1", None)
    monkeypatch.delitem(sys.modules, "eddi_scaffold.recordings.bag_files", raising=False)
    result = run("run", *BOTH[:3], "--bag", "a.bag", cwd=folder)
    assert result.status == 2
    assert_reported("I010", result.err)


OLDER = {"robot_msgs/msg/Battery": "float32 volts\nbool charging\nfloat32[] cells\n"}
BATTERY = data_text("recordings/battery_config.yml")


def battery(folder: Path, declared: str, text: str) -> Any:
    """Run a configuration that believes something of a message on a bag that knows it."""
    (folder / "charge.events").write_text("VAR low : BOOL\nEVENT empty (HAZARD) := low\n")
    config = BATTERY.replace("{DECLARED}", f"{{{declared}}}").replace("INPUT", text)
    (folder / "c.yml").write_text(config)
    fields = {"volts": 11.5, "charging": True, "cells": np.zeros(3, np.float32)}
    rows = [(t, "/battery", "robot_msgs/msg/Battery", fields) for t in (0.0, 0.5)]
    written(folder / "a.bag", rows, OLDER)
    return run("run", "c.yml", "--bag", "a.bag", cwd=folder)


@tabled
def test_the_definitions_of_the_bag_are_the_ones_that_count(declared, text, words, tmp_path):
    result = battery(tmp_path, declared, text)
    assert (result.status, result.out) == (2, "")
    assert "c.yml:8:" in result.err
    assert f"{words}, as the bag defines its messages [I012]" in result.err


def test_the_parts_of_a_time_are_called_as_on_the_robot(tmp_path: Path) -> None:
    (tmp_path / "late.events").write_text("VAR s : NUMBER\nEVENT late (HAZARD) := s > 5\n")
    (tmp_path / "c.yml").write_text(
        "Model: {id: Late, type: Event, frequency: 2, parameters: [{model: late.events}]}\n"
        "SimulatorOutputs: [{id: head, type: std_msgs.Header, topic: /head}]\n"
        "EDDIInputs:\n"
        "  - {id: s, type: float, requires: [head], field: stamp.secs, max_age: 1}\n"
        "EDDIOutputs: [{id: late, topic: late}]\n"
    )
    store = get_typestore(Stores.ROS1_NOETIC)
    stamp = store.types["builtin_interfaces/msg/Time"](sec=7, nanosec=0)
    fields = {"seq": 0, "stamp": stamp, "frame_id": "x"}
    written(tmp_path / "a.bag", [(0.0, "/head", "std_msgs/msg/Header", fields)])
    result = run("run", "c.yml", "--bag", "a.bag", cwd=tmp_path)
    assert result.out.splitlines() == ["     0.000  late active    late: true for 0.0 s (s 7)"]


BOTH = ("two_conserts.xml", "-c", "consert_a_config.yml", "-c", "consert_b_config.yml")


def evidence_b(t: float, value: bool) -> Message:
    return (t, "/rte/e0b", "std_msgs/msg/Bool", {"data": value})


@pytest.mark.parametrize("words", [BOTH, tuple(word for word in BOTH if word != "-c")])
def test_a_monitor_receives_what_another_one_publishes(folder: Path, words: Sequence[str]) -> None:
    rows = [healthy(k / 10, True) for k in range(40)]
    rows += [evidence_b(k / 10, True) for k in range(10)]  # then its source falls silent
    written(folder / "a.bag", sorted(rows))
    result = run("run", *words, "--bag", "a.bag", cwd=folder)
    assert result.status == 0, result.err
    names = [line.split()[1] for line in result.out.splitlines()]
    assert names == ["ConSertB:", "ConSertA:"] * 2
    states = [("0.000", "1"), ("0.000", "11"), ("3.000", "?"), ("3.000", "1?")]
    assert changes(result.out) == states


def test_what_a_monitor_here_publishes_is_not_taken_from_the_bag(folder: Path) -> None:
    rows = [healthy(0, True), evidence_b(0, False), demand(0, True), healthy(0.2, True)]
    written(folder / "a.bag", rows)
    result = run("run", *BOTH, "--bag", "a.bag", "--json", "-v", cwd=folder)
    assert_reported("I003", result.err)
    steps = [json.loads(line) for line in result.out.splitlines()]
    assert [(step["t"], step["monitor"]) for step in steps] == [
        (t, name) for t in (0.0, 0.1, 0.2) for name in ("ConSertB", "ConSertA")
    ]
    assert not any(o["active"] for step in steps for o in step["outputs"] if o["id"].endswith("G1"))


def test_each_steps_at_its_own_rhythm_and_at_once_for_what_another_says(folder: Path) -> None:
    a, b = folder / "consert_a_config.yml", folder / "consert_b_config.yml"
    edit(a, "frequency: 10", "frequency: 0.1\n  mode: on_change")
    edit(b, "frequency: 10", "frequency: 2")
    written(folder / "a.bag", [healthy(0.0, True), evidence_b(0.1, True), healthy(1.2, True)])
    result = run("run", *BOTH, "--bag", "a.bag", "--json", cwd=folder)
    steps = [json.loads(line) for line in result.out.splitlines()]
    assert [(step["t"], step["monitor"][-1]) for step in steps] == [
        (0.0, "B"), (0.0, "A"), (0.5, "B"), (0.5, "A"), (1.0, "B"), (1.0, "A"), (1.2, "A"),
        (1.5, "B"),
    ]  # fmt: skip


def test_a_bag_gives_the_age_limits_of_a_draft(folder: Path) -> None:
    written(folder / "a.bag", [healthy(t, True) for t in (0.0, 0.1, 0.2, 0.5)] + [demand(0, True)])
    words = ("connect", "two_conserts.xml", "--name", "ConSertA", "-o", "consert_a_config.yml")
    config = folder / "consert_a_config.yml"
    edit(config, "max_age: 2.0 ", "max_age: TODO ")
    assert run(*words, "--bag", "a.bag", cwd=folder).status == 0
    assert "    max_age: 0.36 s  # 4 messages of a.bag\n" in config.read_text("utf-8")
    before = config.read_bytes()
    (folder / "a.bag").write_bytes(b"#ROSBAG V2.0\nno bag")
    assert run(*words, "--bag", "a.bag", cwd=folder).status == 2
    assert config.read_bytes() == before


def test_the_topics_of_a_bag_are_candidates(tmp_path: Path) -> None:
    (tmp_path / "low.events").write_text(
        "VAR battery_level : NUMBER\nEVENT Low (HAZARD) := battery_level < 0.2\n"
    )
    level = "my_msgs/msg/Charge"
    rows: list[Message] = [(k / 10, "/battery", level, {"level": 0.5}) for k in range(9)]
    definitions = {**DEFINITIONS, level: "float32 level\n"}
    written(tmp_path / "a.bag", [*rows, demand(0, True)], definitions)
    words = ("connect", "low.events", "--bag", "a.bag", "-o", "c.yml")
    assert run(*words, cwd=tmp_path).status == 0
    first = (tmp_path / "c.yml").read_text()
    topic = "  - id: battery\n    type: my_msgs/Charge\n    topic: /battery\nEDDIInputs:\n"
    assert f"SimulatorOutputs:\n{topic}" in first  # and what a monitor said is no topic of a robot
    assert "    from: battery.level\n    max_age: 0.25 s  # 9 messages" in first
    assert run(*words, cwd=tmp_path).status == 0
    assert (tmp_path / "c.yml").read_text() == first

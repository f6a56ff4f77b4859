"""A bag gives the verdicts that the node would have published."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from eddi_scaffold.platforms import chosen  # noqa: F401 - loads what commands load
from tests.cli.command import example, run
from tests.diagnosed import assert_example

rosbags = pytest.importorskip("rosbags", reason="the extra `bags` is not installed")

from rosbags.rosbag1 import Writer  # noqa: E402 - after the check that it is there
from rosbags.typesys import Stores, get_types_from_msg, get_typestore  # noqa: E402 - the same

SECOND = 1_000_000_000
EVIDENCE = "/rte/e0a"
DEMAND = "/consertb/guarantees"
Message = tuple[float, str, str, dict[str, Any]]


def written(path: Path, messages: Sequence[Message]) -> Path:
    """Write a real bag; times are in seconds after an arbitrary start."""
    store = get_typestore(Stores.ROS1_NOETIC)
    for name, text in {
        "eddi_messages/msg/Guarantee": "string id\nbool active\n",
        "eddi_messages/msg/ConSertOutput": "eddi_messages/Guarantee[] guarantees\n",
    }.items():
        store.register(get_types_from_msg(text, name))
    with Writer(path) as writer:
        connections = {}
        for t, topic, of, fields in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, of, typestore=store)
            guarantee = store.types["eddi_messages/msg/Guarantee"]
            pairs = {"guarantees": [guarantee(*pair) for pair in fields.get("guarantees", ())]}
            message = store.types[of](**(pairs if "guarantees" in fields else fields))
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


def test_one_step_per_period(folder: Path) -> None:
    written(
        folder / "a.bag",
        [healthy(0, False), healthy(0.25, True), demand(0.45, True), demand(1.2, False)],
    )
    assert verdicts(folder) == [
        (0.1, "00"), (0.2, "00"), (0.3, "10"), (0.4, "10"), (0.5, "11"), (0.6, "11"), (0.7, "11"),
        (0.8, "11"), (0.9, "11"), (1.0, "10"), (1.1, "10"), (1.2, "10"),
    ]  # fmt: skip


def test_on_change_also_one_step_per_message(folder: Path) -> None:
    config = folder / "consert_a_config.yml"
    config.write_text(
        config.read_text().replace("frequency: 10", "frequency: 2\n  mode: on_change")
    )
    written(
        folder / "a.bag",
        [healthy(0, False), healthy(0.25, True), demand(0.25, True), demand(1.0, False)],
    )
    assert verdicts(folder) == [(0.0, "00"), (0.25, "11"), (0.75, "11"), (1.0, "10")]


def test_a_topic_without_messages_is_said(folder: Path) -> None:
    written(folder / "a.bag", [healthy(0, True), healthy(0.2, True)])
    result = run(
        *("run", "two_conserts.xml", "-c", "consert_a_config.yml", "--bag", "a.bag", "--csv"),
        cwd=folder,
    )
    assert result.status == 0
    assert_example("I013", result.err)
    assert result.out.splitlines()[-1] == "0.2,true,false"


def test_a_topic_of_another_type(folder: Path) -> None:
    written(folder / "a.bag", [healthy(0, True)])
    config = folder / "consert_a_config.yml"
    text = config.read_text().replace("type: std_msgs.Bool", "type: std_msgs.Int8")
    config.write_text(text)
    result = run(
        *("run", "two_conserts.xml", "-c", "consert_a_config.yml", "--bag", "a.bag"), cwd=folder
    )
    assert result.status == 2
    assert_example("I012", result.err)


def test_inputs_of_hand_written_code_stay_unknown(folder: Path) -> None:
    written(folder / "a.bag", [healthy(0, True), demand(0.0, True), demand(0.2, True)])
    config = folder / "consert_a_config.yml"
    config.write_text(
        config.read_text().replace("    field: guarantees[System_A_G0_c2].active\n", "")
    )
    result = run(
        *("run", "two_conserts.xml", "-c", "consert_a_config.yml", "--bag", "a.bag", "--csv"),
        cwd=folder,
    )
    assert_example("I014", result.err)
    assert result.out.splitlines()[-1] == "0.2,true,false"


def test_without_the_extra_it_says_what_to_install(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written(folder / "a.bag", [healthy(0, True)])
    monkeypatch.setitem(__import__("sys").modules, "rosbags.highlevel", None)
    result = run(
        *("run", "two_conserts.xml", "-c", "consert_a_config.yml", "--bag", "a.bag"), cwd=folder
    )
    assert result.status == 2
    assert_example("I010", result.err)

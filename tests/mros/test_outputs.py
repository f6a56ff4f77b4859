"""Systems joined with their models: whole systems of others, and each rule by itself."""

from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.common.identifiers import is_identifier
from eddi_scaffold.common.problems import Place, Problem, has_errors
from eddi_scaffold.mros import load_models, load_system
from eddi_scaffold.mros.topics import (
    Outputs,
    TopicEntry,
    give_ids,
    simulator_outputs,
)
from tests.data_files import data_file, data_text


def outputs_of(system: Path, folder: Path, **options: Any) -> tuple[Outputs, list[Problem]]:
    one, problems = load_system(system, folder)
    models = load_models(folder)
    outputs = simulator_outputs(one, models, **options)
    return outputs, [*problems, *models.problems, *outputs.problems]


def cases() -> list[Any]:
    return list(
        yaml.load(data_file("mros/expected/cases.yml").read_text("utf-8"), yaml.CSafeLoader)
    )


@pytest.mark.parametrize("case", cases(), ids=lambda case: case["name"])
def test_whole_systems(case: dict[str, Any]) -> None:
    system, models, result = (
        data_file(f"mros/expected/{case[key]}") for key in ("system", "models", "result")
    )
    options = {"include": [word for word in case["options"] if word != "--include"]}
    found, problems = outputs_of(system, models, **options)
    wanted = yaml.load(result.read_text("utf-8"), yaml.CSafeLoader)["SimulatorOutputs"]
    rows = [(t.id, t.type, t.topic) for t in found.topics]
    assert rows == [(row["id"], row["type"].replace(".", "/"), row["topic"]) for row in wanted]
    assert sorted((p.level, p.place.file, p.place.line, p.code) for p in problems) == sorted(
        (d["severity"], d["file"], d["line"], d["code"]) for d in case["diagnostics"]
    )
    counts = (found.components, found.publishers, len(found.topics), int(has_errors(problems)))
    keys = ("components", "resolved_publishers", "topics", "exit")
    assert counts == tuple(case[key] for key in keys)


LASERS = data_text("mros/lasers.rossystem")
ARM = data_text("mros/arm.ros2")
NODES = data_text("mros/nodes.ros2")


def laid(folder: Path, **files: str) -> Path:
    for name, text in files.items():
        (folder / name.replace("__", ".")).write_text(text, "utf-8")
    return folder


def rows(outputs: Outputs) -> list[tuple[str, str, str]]:
    return [(topic.id, topic.topic, topic.kind) for topic in outputs.topics]


@pytest.fixture
def lasers(tmp_path: Path) -> Path:
    return laid(tmp_path, robot__rossystem=LASERS, arm__rossystem=ARM, nodes__ros1=NODES)


def test_what_else_can_be_listened_to(lasers: Path) -> None:
    outputs, problems = outputs_of(
        lasers / "robot.rossystem", lasers, include=("actions", "subscribed")
    )
    assert problems == []
    assert rows(outputs)[5:] == [
        ("front_align_feedback", "/front/align/feedback", "action"),
        ("front_align_status", "/front/align/status", "action"),
        ("front_align_result", "/front/align/result", "action"),
        ("rear_align_feedback", "/rear/align/feedback", "action"),
        ("rear_align_status", "/rear/align/status", "action"),
        ("rear_align_result", "/rear/align/result", "action"),
        ("front_stop", "/front/stop", "subscribed"),
        ("time", "/rear/time", "subscribed"),
        ("rear_stop", "/rear/stop", "subscribed"),
    ]
    (lasers / "nodes.ros1").rename(lasers / "nodes.ros2")
    _, problems = outputs_of(lasers / "robot.rossystem", lasers, include=("actions",))
    assert {problem.code for problem in problems} == {"M019"}


def test_names_of_the_models(lasers: Path) -> None:
    outputs, _ = outputs_of(lasers / "robot.rossystem", lasers, names="model")
    topics = [topic.topic for topic in outputs.topics]
    assert topics[:3] == ["/driver/ticks", "/front/cloud", "/front/scan"]


def test_a_system_inside_of_itself(tmp_path: Path) -> None:
    laid(
        tmp_path,
        a__rossystem="a:\n  subSystems:\n    b\n",
        b__rossystem="b:\n  subSystems:\n    a\n    c\n",
    )
    _, problems = outputs_of(tmp_path / "a.rossystem", tmp_path)
    assert [(p.level, p.code, p.place.file, p.place.line) for p in problems] == [
        ("error", "M023", "b.rossystem", 3),
        ("warning", "M023", "b.rossystem", 4),
    ]
    assert "a -> b -> a" in problems[0].message


@pytest.mark.parametrize(
    ("named", "hint"),
    [
        ("lasr.laser", "did you mean 'laser.laser'?"),
        ("laser.lasers", "did you mean 'laser.laser'?"),
        ("arm.driver.drivr", "did you mean 'arm.driver.driver'?"),
        ("camera", None),
        ("camera.usb", None),
    ],
)
def test_a_misspelt_model_is_told_with_the_nearest(
    lasers: Path, named: str, hint: str | None
) -> None:
    system = LASERS.replace("laser.laser", named)
    (lasers / "robot.rossystem").write_text(system, "utf-8")
    _, problems = outputs_of(lasers / "robot.rossystem", lasers)
    found = [p for p in problems if p.code == "M007"]
    assert [(p.level, p.hint) for p in found] == [("warning", hint), ("error", hint)]
    (lasers / "broken.ros1").write_text("laser:\n  artifacts\n", "utf-8")
    _, problems = outputs_of(lasers / "robot.rossystem", lasers)
    wanted = "could not be read: broken.ros1" if hint is None else f"{hint}; could not be read: "
    assert all((p.hint or "").startswith(wanted) for p in problems if p.code == "M007")


def ids(wishes: dict[str, str], *existing: tuple[str, str]) -> tuple[list[str], list[str]]:
    entries = [TopicEntry(name, "", topic, Place("c.yml", 1)) for name, topic in existing]
    given, problems = give_ids(wishes, wishes, entries)
    return [given[topic] for topic in wishes], [problem.code for problem in problems]


def test_ids_that_are_there_stay() -> None:
    wishes = {"/a/scan": "scan", "/b/scan": "scan", "/c": "b_scan"}
    assert ids(wishes) == (["a_scan", "b_scan_2", "b_scan"], [])
    assert ids(wishes, ("laser", "/a/scan")) == (["laser", "b_scan_2", "b_scan"], [])
    assert ids(wishes, ("scan", "/b/scan")) == (["a_scan", "scan", "b_scan"], [])
    assert ids({"/a": "x"}, ("1st", "/a")) == (["x"], ["M020"])
    assert ids({"/a": "x"}, ("y", "/a"), ("y", "/b")) == (["x"], ["M020"])
    assert ids({"/a": "x"}, ("x", "/gone")) == (["x"], ["M020"])


@given(
    st.dictionaries(st.text("ab/1", min_size=1, max_size=4), st.text("ab/?", max_size=3)),
    st.lists(st.tuples(st.text("ab1", max_size=2), st.text("ab/1", max_size=4))),
)
def test_ids_are_unique_names_that_a_second_run_keeps(
    wishes: dict[str, str], existing: list[tuple[str, str]]
) -> None:
    first, _ = ids(wishes, *existing)
    assert len({*first}) == len(first)
    assert all(is_identifier(name) for name in first)
    assert ids(wishes, *zip(first, wishes, strict=True)) == (first, [])

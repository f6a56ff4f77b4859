"""From a robot of other people to a running monitor: only the lines that say TODO are edited."""

import re
from collections.abc import Sequence
from pathlib import Path

import pytest

from eddi_scaffold.yaml_text.nodes import dump_plain
from tests.cli.command import run
from tests.data_files import data_file

ROBOTS = [
    (
        "cob4_ros_tool_test",
        {"RightLaserStandby": None, "BaseSpeed": "m/s", "DistanceAhead": "m"},
        {"DistanceAhead": "MIN(base_laser_front_scan.ranges[*])"},
        4,
    ),
    (
        "MT",
        {"LocalizationUncertainty": "m", "DriveSpeed": "m/s", "LaserB1MinimumDistance": "m"},
        {"LocalizationUncertainty": "SQRT(amcl_pose.pose.covariance[0])"},
        4,
    ),
]


def consert(inputs: dict[str, str | None]) -> str:
    """Return a ConSert that needs all of some evidence: true, or a number below 2."""
    evidence = {name: "bool" if unit is None else f"0 .. 2 {unit}" for name, unit in inputs.items()}
    return dump_plain({"evidence": evidence, "guarantees": {"Fine": " AND ".join(inputs)}})


def decided(text: str, answers: dict[str, str]) -> tuple[str, int]:
    """Return a draft with its TODO lines replaced, and how many there were."""
    input_ = ""
    lines: list[str] = []
    count = 0
    for line in text.splitlines():
        input_ = line.rpartition(" ")[2] if line.lstrip().startswith("- id:") else input_
        key, is_open, _ = line.partition(": TODO")
        count += bool(is_open)
        value = "0.5" if key.strip() == "max_age" else f'"{answers.get(input_, "")}"'
        lines.append(f"{key}: {value}" if is_open else line)
    return "\n".join([*lines, ""]), count


def places(text: str) -> Sequence[int]:
    return [
        int(line)
        for line in re.findall(r"^draft\.yml:(\d+):\d+: error: .*K059", text, re.MULTILINE)
    ]


@pytest.mark.parametrize(("robot", "inputs", "answers", "count"), ROBOTS, ids=str)
def test_a_draft_becomes_a_monitor(
    robot: str,
    inputs: dict[str, str | None],
    answers: dict[str, str],
    count: int,
    tmp_path: Path,
) -> None:
    folder = data_file(f"mros/expected/{robot}.models")
    system = min(folder.rglob(f"{robot}.rossystem"), key=lambda path: len(path.parts))
    (tmp_path / "Model.yml").write_text(consert(inputs), "utf-8")
    words = ("connect", "Model.yml", "--system", system, "--models", folder, "-o", "draft.yml")
    assert run(*words, cwd=tmp_path).status in (0, 1)  # 1: the robot's models have errors
    text = (tmp_path / "draft.yml").read_text("utf-8")
    open_ = [k for k, line in enumerate(text.splitlines(), 1) if ": TODO " in line]
    checked = run("check", "draft.yml", cwd=tmp_path)
    assert (checked.status, places(checked.err)) == (1, open_)
    assert checked.err.count(": error: ") == len(open_)

    whole, todo = decided(text, answers)
    assert todo == count
    (tmp_path / "draft.yml").write_text(whole, "utf-8")
    values = ("true" if unit is None else "1" for unit in inputs.values())
    recording = f"t,{','.join(inputs)}\n0,{','.join(values)}\n"
    (tmp_path / "in.csv").write_text(recording, "utf-8")
    played = run("run", "draft.yml", "--inputs", "in.csv", cwd=tmp_path)
    assert (played.status, played.out.split()[1:3]) == (0, ["Fine", "active"])

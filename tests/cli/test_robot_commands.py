"""The models of a robot on the command line: shown, checked, and beside a configuration."""

import json
import os
import re
import shutil
from pathlib import Path

import pytest

from tests.cli.command import ROOT, edit, run

SYSTEM, NODES, CONFIG, MODEL = "rover.rossystem", "nodes", "eddi_config.yml", "Rover.yml"


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    """Return a folder with the example, whose configuration has the topics of the system."""
    folder = tmp_path / "robot"
    shutil.copytree(ROOT / "examples" / "robot-models", folder)
    assert run("parse-rossystem", "-s", SYSTEM, "-m", NODES, "-c", CONFIG, cwd=folder).status == 0
    return folder


def codes(text: str) -> list[str]:
    return re.findall(r"\[([A-Z]\d+)\]", text)


def test_what_cannot_be_read_is_bad_input(robot: Path) -> None:
    (robot / SYSTEM).write_text("rover", "utf-8")
    shown = run("show", SYSTEM, cwd=robot)
    assert (shown.status, shown.out, codes(shown.err)) == (2, "", ["M001"])
    shown = run("show", SYSTEM, "--json", cwd=robot)
    (problem,) = json.loads(shown.out)["problems"]
    assert (shown.status, problem["code"], problem["file"]) == (2, "M001", SYSTEM)


def test_without_node_models_a_system_is_only_read(robot: Path) -> None:
    edit(robot / SYSTEM, '"laser_driver.laser"', '"lost.laser"')
    assert run("check", SYSTEM, cwd=robot).status == 0
    checked = run("check", SYSTEM, "--models", NODES, cwd=robot)
    assert (checked.status, codes(checked.err)[:1]) == (1, ["M007"])


def test_message_types_of_the_robots_models_stay_known(robot: Path) -> None:
    """Whatever command comes next, and without the models."""
    (robot / "ws/src").mkdir(parents=True)
    sources = ("-w", "ws", "-m", MODEL, "-c", CONFIG)
    assert run("generate", *sources, "--models", NODES, cwd=robot).status == 0
    again = run("generate", *sources, cwd=robot)
    assert (again.status, "nothing to change" in again.err) == (0, True)
    assert run("answers", *sources, "-o", "a.yml", cwd=robot).status == 0
    assert "self.Charge = charge.level" in (robot / "a.yml").read_text("utf-8")
    edit(robot / CONFIG, "  id: Rover", "  id: Rover2")
    renamed = ("generate", *sources, "--name", "Rover", "--rename", "Rover=Rover2")
    assert run(*renamed, cwd=robot).status in {0, 3}
    inputs = robot / "ws/src/eddi_monitor/rover2/src/rover2/EDDIInput.py"
    assert "self.Charge = charge.level" in inputs.read_text("utf-8")


def test_every_command_takes_the_models_of_the_robot(robot: Path) -> None:
    """The configuration as it is shipped has no topics: without the models all of them refuse."""
    (robot / "ws/src").mkdir(parents=True)
    assert run("generate", "-w", "ws", "-m", MODEL, "-c", CONFIG, cwd=robot).status == 0
    shutil.copy(ROOT / "examples" / "robot-models" / CONFIG, robot / CONFIG)
    (robot / "inputs.csv").write_text("t,WayIsClear,ForwardSpeed,Charge\n0,1,0.5,80\n")
    models = ("--system", SYSTEM, "--models", NODES)
    for words in (
        ("check", MODEL, CONFIG),
        ("answers", "-m", MODEL, "-c", CONFIG, "-o", "a.yml"),
        ("upgrade", "-w", "ws", "-m", MODEL, "-c", CONFIG),
        ("run", MODEL, "-c", CONFIG, "-i", "inputs.csv"),
    ):
        refused = run(*words, cwd=robot)
        assert (refused.status in {1, 2}, codes(refused.err)) == (True, ["K007"] * 3), words
        done = run(*words, *models, cwd=robot)
        assert (done.status, codes(done.err)) == (0, []), words
    assert "self.Charge = charge.level" in (robot / "a.yml").read_text("utf-8")


def test_a_configuration_that_is_saved_while_its_block_is_made_stays(
    robot: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    config = robot / CONFIG
    edit(config, "/front/scan", "/rear/scan")
    saved = f"{config.read_text()}# written while the command was running\n"
    real = os.fsync
    monkeypatch.setattr(os, "fsync", lambda handle: (config.write_text(saved), real(handle)))
    words = ("parse-rossystem", "-s", SYSTEM, "-m", NODES, "-c", CONFIG)
    refused = run(*words, cwd=robot)
    assert (refused.status, codes(refused.err)) == (2, ["F013"])
    assert config.read_text() == saved
    assert not list(robot.glob(".eddi-*"))
    monkeypatch.undo()
    assert run(*words, cwd=robot).status == 0
    assert config.read_text().count("# written while") == 1


def test_show_takes_all_monitors_of_a_robot_in_turn() -> None:
    shown = run("show", "robot.yml", cwd=ROOT / "examples" / "warehouse-robot")
    heads = [line for line in shown.out.splitlines() if line and line[0] != " "]
    names = [head.split()[-1] for head in heads]
    assert (shown.status, names) == (0, ["lidar", "localisation", "power", "detector", "warehouse"])

"""Topics of a robot written into a configuration: what stays, what goes, and what is said of it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from eddi_scaffold.connect.robot import read_robot
from eddi_scaffold.connect.rossystem import Filters, Parsed, parse, read_config_text
from tests.cli.command import edit
from tests.data_files import data_text, tabled, write_files

SYSTEM = data_text("robot/robot.rossystem")
MAST = data_text("robot/mast.rossystem")
LASER = data_text("robot/laser.ros2")
OTHERS = data_text("robot/others.ros2")
IDS = ["image", "scan", "ticks", "load"]


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    files = {"robot.rossystem": SYSTEM, "mast.rossystem": MAST}
    files |= {"laser.ros1": LASER, "others.ros1": OTHERS}
    return write_files(tmp_path, files)


def parsed(folder: Path, **options: Any) -> Parsed:
    """Parse, and write the configuration as the command does."""
    robot = read_robot(folder / "robot.rossystem", folder)
    found = parse(robot, read_config_text(folder / "c.yml"), **options)
    if found.is_changed:
        (folder / "c.yml").write_text(found.after, "utf-8")
    return found


def ids(text: str) -> list[str]:
    return re.findall(r"^  - id: (.*)$", text, re.MULTILINE)


def said(found: Parsed, code: str) -> list[str]:
    return [problem.message for problem in found.problems if code in (problem.code, problem.case)]


# what did not resolve


@tabled
def test_what_did_not_resolve_this_time_stays(file, old, new, code, lost, robot):
    whole = parsed(robot)
    assert ids(whole.after) == IDS
    edit(robot / file, old, new)
    broken = parsed(robot)
    assert said(broken, code)
    assert {*ids(broken.after)} >= {*IDS}
    assert ids(broken.after)[-len(lost) :] == lost
    assert {topic.id for topic in broken.outputs.topics}.isdisjoint(lost)
    kept = said(broken, "M026")
    assert [message.split("'")[1] for message in kept] == lost
    assert all("did not resolve this time" in message for message in kept)
    assert parsed(robot).after == broken.after
    edit(robot / file, new, old)
    assert sorted(ids(parsed(robot).after)) == sorted(IDS)


def test_the_id_of_what_did_not_resolve_goes_to_nothing_else(robot: Path) -> None:
    (robot / "c.yml").write_text(
        "SimulatorOutputs:\n  - id: scan\n    type: sensor_msgs.LaserScan\n"
        "    topic: /front/scan\nEDDIInputs:\n  - {id: Near, requires: [scan]}\n"
    )
    edit(robot / "robot.rossystem", "laser.laser", "lasr.laser")
    edit(robot / "others.ros1", "load:", "scan:")
    found = parsed(robot)
    assert ids(found.after)[:4] == ["image", "ticks", "scan_2", "scan"]
    assert "    topic: /front/scan\n" in found.after
    assert said(found, "M020") == []


def test_errors_that_lose_nothing_keep_nothing(robot: Path) -> None:
    parsed(robot)
    edit(robot / "robot.rossystem", '"arm.driver"', '"laser.laser"')
    edit(robot / "others.ros1", "image:", "/front/scan:")
    edit(robot / "robot.rossystem", "driver::ticks", "laser::scan")
    found = parsed(robot)
    assert said(found, "M012")
    assert len(said(found, "M026.dropped")) == 2
    assert not said(found, "M026.needed") + said(found, "M026.stays")


def test_nothing_is_written_when_nothing_resolved(robot: Path) -> None:
    (robot / "mast.rossystem").write_text("mast:\n  node:\n", "utf-8")
    (robot / "laser.ros1").write_text("laser\n", "utf-8")
    (robot / "others.ros1").unlink()
    found = parsed(robot)
    assert (found.is_changed, found.document.is_new) == (False, True)
    assert not (robot / "c.yml").exists()
    text = "SimulatorOutput: # the robot\n- {id: scan, topic: /front/scan}\n"
    (robot / "c.yml").write_text(text, "utf-8")
    found = parsed(robot)
    assert (found.is_changed, found.after) == (False, text)
    assert said(found, "M026.comments") == []


# filters


def test_what_a_filter_leaves_out_is_said_to_be_left_out(robot: Path) -> None:
    parsed(robot)
    edit(robot / "others.ros1", "sensor_msgs/msg/Image", "bond/msg/Status")
    (robot / "c.yml").open("a").write("EDDIInputs:\n  - {id: Near, requires: [scan]}\n")
    filters = Filters(topics=("/[jil]*",), components=("arm", "camera"), no_infrastructure=True)
    found = parsed(robot, filters=filters)
    assert ids(found.after) == ["ticks", "load", "scan"]
    left_out = "is not published by the system, or a filter leaves it out"
    assert said(found, "M026.dropped") == [f"'image' (/image) {left_out}; it is dropped"]
    needed = f"'scan' (/front/scan) {left_out}; it stays, because an input needs it"
    assert said(found, "M026.needed") == [needed]
    found = parsed(robot, filters=Filters(components=("arm",)))
    assert said(found, "M026") == [needed]


def test_a_filter_may_wait_for_what_did_not_resolve(robot: Path) -> None:
    parsed(robot)
    edit(robot / "robot.rossystem", "laser.laser", "lasr.laser")
    found = parsed(robot, filters=Filters(topics=("/front/*", "/joints")))
    assert ids(found.after) == ["ticks", "scan"]
    assert len(said(found, "M026.dropped")) == 2
    found = parsed(robot, filters=Filters(components=("front",)))
    assert (found.is_changed, said(found, "M007") != []) == (False, True)
    found = parsed(robot, filters=Filters(topics=("/rear/*",)))
    assert (found.is_changed, said(found, "M007") != []) == (False, True)

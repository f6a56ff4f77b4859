"""Names and units that are right on one platform, or in one way of writing them."""

import shutil
from pathlib import Path

import pytest

from tests.cli.command import ROOT, Result, run
from tests.data_files import tabled

FIELD = ROOT / "tests" / "data" / "oracles" / "field"


def near(folder: Path, *more: str, old: str = "", new: str = "") -> Result:
    for name in ("near.events", "near.yml"):
        shutil.copy(FIELD / "ros1-digit-topic" / name, folder)
    config = folder / "near.yml"
    config.write_text(config.read_text("utf-8").replace(old, new), "utf-8")
    return run("check", "near.events", "near.yml", *more, cwd=folder)


@pytest.mark.parametrize("topic", ["/entity/1/nearest", "/1/nearest", "entity/1", "~1/2"])
def test_a_part_of_a_name_may_begin_with_a_digit_on_ros1(topic: str, tmp_path: Path) -> None:
    assert near(tmp_path, old="/entity/1/nearest", new=topic).status == 0


@tabled
def test_ros2_says_what_its_rule_is(old: str, new: str, where: str, tmp_path: Path) -> None:
    result = near(tmp_path, "--platform", "ros2", old=old, new=new)
    assert result.status == 1
    assert f"{where}: on ROS 2 no part of a name may begin with a digit [K003]" in result.err


def soc(folder: Path, unit: str, *, field: str = "percentage", declared: str = "") -> Result:
    text = (FIELD / "unit-ratio" / "soc.events").read_text("utf-8")
    (folder / "soc.events").write_text(text.replace("NUMBER", f"NUMBER {declared}"), "utf-8")
    config = (FIELD / "unit-ratio" / "soc.yml").read_text("utf-8")
    config = config.replace("fraction", unit).replace("percentage", field)
    (folder / "soc.yml").write_text(config, "utf-8")
    return run("check", "soc.events", "soc.yml", cwd=folder)


@pytest.mark.parametrize(("unit", "declared"), [("K", "degC"), ("degC", "K")])
def test_temperatures_are_not_converted(unit: str, declared: str, tmp_path: Path) -> None:
    result = soc(tmp_path, unit, field="temperature", declared=f"UNIT {declared}")
    assert "[K022]" in result.err

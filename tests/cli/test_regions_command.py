"""``regions``: which hand-written lines a package has, and which a person should look at."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from eddi_scaffold import api
from tests.cli.command import EXAMPLE, ROOT, edit, example, run

FILE = "src/conserta/EDDIInput.py"
BODY = "        self.RtE_A_E0 = RtE_E0.data\n"


@pytest.fixture
def package(tmp_path: Path) -> Path:
    place = tmp_path / "conserta"
    shutil.copytree(EXAMPLE / "expected" / "src" / "eddi_monitor" / "conserta", place)
    return place


def listed(package: Path) -> dict[str, str]:
    found = json.loads(run("regions", package, "--json", cwd=package).out)["regions"]
    return {one["id"]: one["state"] for one in found if one["id"].startswith("process_")}


def test_an_edited_body_is_not_taken_for_an_untouched_one(package: Path) -> None:
    assert listed(package) == {"process_RtE_A_D0": "untouched", "process_RtE_A_E0": "untouched"}
    edit(package / FILE, BODY, "        self.RtE_A_E0 = not RtE_E0.data\n")
    assert listed(package) == {"process_RtE_A_D0": "untouched", "process_RtE_A_E0": "edited"}
    assert run("regions", "--check", cwd=package).status == 0


DAMAGE: dict[str, Callable[[Path], object]] = {
    "broken": lambda file: edit(
        file, "'''-----Manual edit end-----'''  # region: process_RtE_A_E0\n", "\n"
    ),
    "outside": lambda file: edit(file, "def process_RtE_A_E0", "def process_RtE_A_EO"),
    "missing": lambda file: file.unlink(),
}
"""A marker has gone; a method that would raise in each step; hand edits are gone."""


@pytest.mark.parametrize("state", DAMAGE)
def test_what_is_lost_is_looked_at(state: str, package: Path) -> None:
    assert run("regions", "--check", cwd=package).status == 0
    DAMAGE[state](package / FILE)
    shown = run("regions", "--check", cwd=package)
    assert shown.status == 3
    assert any(line.startswith(state) and FILE in line for line in shown.out.splitlines())


def test_what_is_written_by_hand_is_no_longer_called_for(tmp_path: Path) -> None:
    """Only while nobody has written the region, an input that no field fits is named."""
    example(tmp_path)
    config = tmp_path / "consert_b_config.yml"
    config.write_text(config.read_text("utf-8").replace("std_msgs.Bool", "sensor_msgs.Imu"))
    generate = ["generate", "--platform", "plain", "-o", "out", "-m", "two_conserts.xml", "-c"]
    check = ["check", "two_conserts.xml", config.name]
    calls = [
        ([*generate, config.name], "write this input: "),
        (check, "to be written by hand: RtE_A_E0"),
    ]
    for command, said in calls:
        assert said in run(*command, cwd=tmp_path).err
    files = [tmp_path / "two_conserts.xml", config]
    assert "K050" in {problem.code for problem in api.check(files)}
    file = tmp_path / "out" / "consertb" / "EDDIInput.py"
    text = file.read_text("utf-8")
    file.write_text(text.replace("self.RtE_A_E0 = None", "self.RtE_A_E0 = bool(RtE_E0)"))
    for command, said in calls:
        assert said not in run(*command, cwd=tmp_path).err
    assert "K050" not in {problem.code for problem in api.check(files)}


def test_a_network_that_nothing_feeds_calls_for_its_methods(tmp_path: Path) -> None:
    """Inputs without `discretisation:` reach no node until a person writes how."""
    pedestrian = ROOT / "examples" / "pedestrian"
    shutil.copy(pedestrian / "pedestrian.xml", tmp_path)
    text = (pedestrian / "eddi_config.yml").read_text("utf-8")
    bare = [line for line in text.splitlines() if "bins:" not in line and "discret" not in line]
    (tmp_path / "bare.yml").write_text("\n".join(bare), "utf-8")
    check = ["check", "pedestrian.xml", "bare.yml"]
    said = (
        "warning: to be written by hand: node_AV_Shuttle_Speed, node_Distance_to_Pedestrian [K050]"
    )
    found = run(*check, cwd=tmp_path)
    assert (found.status, said in found.err) == (0, True), found.err
    generate = ["generate", "--platform", "plain", "-o", "out", "-m", "pedestrian.xml", "-c"]
    file = Path("out/pedestrian_prediction_example/bayesian_network_config.py")
    made = run(*generate, "bare.yml", cwd=tmp_path)
    assert made.status == 0, made.err
    assert f"{made.out}{made.err}".count(f"  write this node: {file}:") == 2
    text = (tmp_path / file).read_text("utf-8")
    (tmp_path / file).write_text(text.replace("   pass\n", "   outcome_NotDriving = 1.0\n", 1))
    assert "K050" not in run(*check, cwd=tmp_path).err
    # with a declaration nothing is left to a person
    shutil.copy(pedestrian / "eddi_config.yml", tmp_path)
    assert "K050" not in run("check", "pedestrian.xml", "eddi_config.yml", cwd=tmp_path).err

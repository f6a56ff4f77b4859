"""What people write in a configuration gives the same package as the spelling of D7.2."""

import re
from pathlib import Path

import pytest
import yaml

from eddi_scaffold.packages import assembly
from eddi_scaffold.platforms import chosen
from tests.cli.command import run
from tests.data_files import data_text, tabled, write_files

DATA = Path(__file__).parents[1] / "data" / "users"
SPELLINGS = yaml.load((DATA / "spellings.yml").read_text("utf-8"), yaml.CSafeLoader)["cases"]


def packages(case, spelling, folder):
    """Return package -> the answers and files of which Copier makes it."""
    files = {**case["files"], **case[spelling]}
    write_files(folder, files)
    configs = [folder / name for name in case[spelling] if "Model:" in files[name]]
    monitors, problems = assembly.monitors_of(None, configs)
    plan = assembly.assemble(monitors, chosen(case["platform"]), folder / "none", problems)
    texts = {made.folder: f"{dict(made.answers)} {made.files}" for made in plan.packages}
    if case.get("equal") == "but digests":
        texts = {name: re.sub(r"\b[0-9a-f]{16,64}\b", "", text) for name, text in texts.items()}
    return texts


@pytest.mark.parametrize("case", SPELLINGS, ids=lambda case: case["id"])
def test_both_spellings_give_one_package(case, tmp_path, monkeypatch):
    monkeypatch.setattr(assembly, "cross_checked", lambda monitor, _: monitor)  # takes seconds
    old = packages(case, "old", tmp_path / "old")
    new = packages(case, "new", tmp_path / "new")
    assert sorted(old) == sorted(new)
    assert [name for name in old if old[name] != new[name]] == []


ROBOT = data_text("monitors/robot.yml")
MODELS = {
    "cart.yml": "evidence: {PathIsFree: bool}\nguarantees: {MayDrive: PathIsFree}\n",
    "fleet.yml": "evidence: {CartMoves: bool}\nguarantees: {Serve: CartMoves}\n",
}


def checked(folder, *changes):
    text = ROBOT
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    write_files(folder, {**MODELS, "robot.yml": text})
    return run("check", "robot.yml", cwd=folder)


def test_the_monitors_of_a_robot_stand_in_one_file(tmp_path):
    assert checked(tmp_path).status == 0
    done = run("generate", "-o", "out", "--platform", "plain", "-c", "robot.yml", cwd=tmp_path)
    assert done.status == 0
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"cart", "eddi_runtime", "fleet"}
    words = ("-o", "one", "--platform", "plain", "-c", "robot.yml", "--name", "fleet")
    done = run("generate", *words, cwd=tmp_path)
    assert (done.status, done.err.count("[")) == (0, 0)  # its publisher is in the same file
    assert {path.name for path in (tmp_path / "one").iterdir()} == {"eddi_runtime", "fleet"}
    assert "fleet" in run("generate", *words[:-1], "flet", cwd=tmp_path).err


def test_one_of_several_is_shown_by_the_name_of_its_document(tmp_path):
    (tmp_path / "near.events").write_text("VAR near : NUMBER\nEVENT Clear (EVIDENCE) := near > 1\n")
    checked(
        tmp_path,
        ("id: cart, ", "id: wagon, "),
        ("cart.MayDrive", "wagon.MayDrive"),
        ("topic: battery}", "topic: battery}\n  - {id: scan, type: std_msgs/Float32, topic: scan}"),
    )
    with (tmp_path / "robot.yml").open("a") as robot:
        robot.write("---\nModel: {id: lidar, type: Event, model: near.events}\n")
        robot.write("EDDIInputs: [{id: near, from: scan, max_age: 1 s}]\n")
    for command, name in (("show", "lidar"), ("show", "wagon"), ("diagram", "wagon")):
        done = run(command, "robot.yml", "--name", name, cwd=tmp_path)
        assert (done.status, done.err) == (0, "")  # `near` has an age: no question of a TIMEOUT
    assert run("show", "near.events", cwd=tmp_path).err.count("W003") == 1


@tabled
def test_what_is_wrong_stands_at_its_place(change, place, says, tmp_path):
    done = checked(tmp_path, change)
    assert done.status == 1
    assert f"robot.yml:{place}: error" in done.err
    assert says in done.err
    assert "[D006]" not in done.err  # what is wrong is in this file


def test_the_names_of_d72_are_chosen_once(tmp_path):
    checked(
        tmp_path,
        ("---\nModel: {id: cart", "Package: {wire: d7.2}\n---\nModel: {id: cart"),
        ("cart.MayDrive", "cart.May_drive"),
    )
    (tmp_path / "cart.yml").write_text(MODELS["cart.yml"].replace("MayDrive", "May_drive"))
    words = ("-o", "out", "--platform", "plain", "-c", "robot.yml")
    assert run("generate", *words, cwd=tmp_path).status == 0
    assert "SESAME D7.2 names" in (tmp_path / "out/cart/README.md").read_text("utf-8")
    assert '"MayDrive"' in (tmp_path / "out/cart/compiled.py").read_text("utf-8")
    assert "cart.guarantees, 'MayDrive'" in (tmp_path / "out/fleet/EDDIInput.py").read_text()

"""A plain package runs from its folder and installed, on the oldest Python too; without ROS."""

from __future__ import annotations

import sys
from importlib import metadata
from pathlib import Path

import pytest

from tests.checkouts import HERE, Checkout, run, tree
from tests.interpreters import old_python

pytestmark = pytest.mark.slow

MODEL = HERE / "tests" / "golden" / "models" / "rover.yml"
PROGRAM = """
from types import SimpleNamespace
from rover.EDDIMonitor import EDDIMonitor

def active(**values):
    output = EDDIMonitor().execute_step(SimpleNamespace(**values))
    return [guarantee["id"] for guarantee in output if guarantee["active"]]

good = dict(MapKnown=True, Distance=2.5)
assert active(**good, _2nd_sensor_ok=True) == ["FastDrive", "SlowDrive", "StandStill"], "name"
assert active(**good, **{"2nd sensor-ok": True}) == ["FastDrive", "SlowDrive", "StandStill"], "id"
assert active(**good) == ["StandStill"], "absent"
assert active(**{**good, "Distance": float("nan")}, _2nd_sensor_ok=True) == ["StandStill"], "NaN"
assert active(**{**good, "Distance": None}, _2nd_sensor_ok=True) == ["StandStill"], "None"
assert active(**{"class": True}) == active(class_=True) == ["SlowDrive", "StandStill"], "keyword"
assert active(Mode="no") == ["SlowDrive", "StandStill"], "category"
assert active(Mode=False) == active(Mode="fast") == active(Mode=7) == ["StandStill"], "no category"
"""


@pytest.fixture(scope="module")
def plain(clone: Checkout, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("plain")
    clone.eddi("-q", "generate", "--platform", "plain", "-o", folder, "-m", MODEL)
    return folder


@pytest.mark.parametrize("which", ["this Python", "the oldest Python"])
def test_runs_from_its_folder(plain: Path, which: str, tmp_path: Path) -> None:
    python = sys.executable if which == "this Python" else old_python()
    alone = {"PYTHONDONTWRITEBYTECODE": "1", "PYTHONPATH": ""}
    run([python, "-c", PROGRAM], tmp_path, {**alone, "PYTHONPATH": str(plain)})
    run([python, "-m", "unittest", "discover", "-s", "test"], plain / "rover", alone)


def test_can_be_installed(plain: Path, tmp_path: Path) -> None:
    before = tree(plain / "rover", "build", "rover.egg-info")
    options = [
        "--quiet",
        "--no-deps",
        "--disable-pip-version-check",
        "--target",
        str(tmp_path / "to"),
    ]
    if int(metadata.version("setuptools").partition(".")[0]) >= 71:  # builds wheels by itself
        options.append("--no-build-isolation")
    alone = {"PYTHONPATH": ""}
    run([sys.executable, "-m", "pip", "install", *options, str(plain / "rover")], tmp_path, alone)
    assert tree(plain / "rover", "build", "rover.egg-info") == before
    run([sys.executable, "-c", PROGRAM], tmp_path, {"PYTHONPATH": str(tmp_path / "to")})
    installed = sorted(path.name for path in (tmp_path / "to" / "rover").iterdir())
    assert not {"test", ".eddi", "build"} & set(installed), installed


def test_a_description_of_any_letters_is_valid_toml(clone: Checkout, tmp_path: Path) -> None:
    tomllib = pytest.importorskip("tomllib", reason="Python 3.11 reads TOML")
    description = "\\ \"both\" 'quotes' {{ no }} % <b> & ünï \N{ROBOT FACE}"
    config = tmp_path / "config.yml"
    text = (clone.example / "consert_b_config.yml").read_text("utf-8")
    escaped = description.replace("'", "''")
    config.write_text(f"{text}Package:\n  description: '{escaped}'\n", "utf-8")
    sources = ("-m", clone.example / "two_conserts.xml", "-c", config)
    clone.eddi("-q", "generate", "--platform", "plain", "-o", tmp_path, *sources)
    project = tomllib.loads((tmp_path / "consertb" / "pyproject.toml").read_text("utf-8"))
    assert project["project"]["description"] == description

"""A plain package runs from its folder, on the oldest Python too; without ROS."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from tests.checkouts import HERE, run
from tests.cli.command import EXAMPLE
from tests.cli.command import run as eddi
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
def plain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("plain")
    words = ("generate", "--platform", "plain", "-o", folder, "-m", MODEL)
    assert eddi(*words, cwd=folder).status == 0
    return folder


@pytest.mark.parametrize("which", ["this Python", "the oldest Python"])
def test_runs_from_its_folder(plain: Path, which: str, tmp_path: Path) -> None:
    python = sys.executable if which == "this Python" else old_python()
    alone = {"PYTHONDONTWRITEBYTECODE": "1", "PYTHONPATH": ""}
    run([python, "-c", PROGRAM], tmp_path, {**alone, "PYTHONPATH": str(plain)})
    run([python, "-m", "unittest", "discover", "-s", "test"], plain / "rover", alone)


def test_a_description_of_any_letters_is_valid_toml(tmp_path: Path) -> None:
    tomllib = pytest.importorskip("tomllib", reason="Python 3.11 reads TOML")
    description = "\\ \"both\" 'quotes' {{ no }} % <b> & ünï \N{ROBOT FACE}"
    config = tmp_path / "config.yml"
    text = (EXAMPLE / "consert_b_config.yml").read_text("utf-8")
    escaped = description.replace("'", "''")
    config.write_text(f"{text}Package:\n  description: '{escaped}'\n", "utf-8")
    sources = ("-m", EXAMPLE / "two_conserts.xml", "-c", config)
    words = ("generate", "--platform", "plain", "-o", tmp_path, *sources)
    assert eddi(*words, cwd=tmp_path).status == 0
    project = tomllib.loads((tmp_path / "consertb" / "pyproject.toml").read_text("utf-8"))
    assert project["project"]["description"] == description

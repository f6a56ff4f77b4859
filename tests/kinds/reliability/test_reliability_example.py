"""The drone: a rotor fails, P_fail jumps, the guarantee goes away."""

import ast
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.platforms.plain import PLATFORM
from eddi_scaffold.recordings.playing import compiled
from tests.checkouts import HERE
from tests.cli.command import run
from tests.kinds.reliability.monitors import read_text

EXAMPLE = HERE / "examples" / "drone"


def test_export_writes_what_a_configuration_adds(tmp_path: Path) -> None:
    words = ["drone.xml", "-o", tmp_path, "-c", "reliability_config.yml"]
    done = run("export", *words, cwd=EXAMPLE)
    assert (done.status, done.out) == (0, f"{tmp_path / 'MissionLoss.yml'}\n"), done.err
    configured = monitors_of(EXAMPLE / "drone.xml", [EXAMPLE / "reliability_config.yml"])[0][0]
    written, problems = read_text((tmp_path / "MissionLoss.yml").read_text())
    assert problems == []
    assert written is not None
    assert written.data == replace(configured.model.data, quantum=written.data.quantum)
    assert written.data.thresholds[0].id == "RtE_continue"
    assert [one.id for one in written.inputs()] == ["rotors_ok", "MissionLoss_Link"]
    assert run("export", *words, "--kind", "consert", cwd=EXAMPLE).status == 2


@pytest.mark.parametrize(
    "path", [EXAMPLE / "airframe.yml", HERE / "tests/data/reliability/every_input.yml"]
)
def test_the_example_of_a_package_has_everything_in_order(path: Path) -> None:
    (monitor,), _ = monitors_of(path, [])
    answers = PLATFORM.monitor(monitor)[0].answers
    given = dict(one.split("=", 1) for one in answers["sample_inputs"])
    now = SimpleNamespace(**{name: ast.literal_eval(value) for name, value in given.items()})
    result = compiled(monitor).execute_step(now, 0)
    assert (result.valid, result.unknown) == (True, ())
    assert result.p_fail < 1e-3
    assert all(one["covered"] != "-" for one in answers["inputs"] if one["id"] != "'mission_end'")


def test_a_picture_leaves_out_what_does_not_exist(tmp_path: Path) -> None:
    (tmp_path / "m.yml").write_text("models:\n  a: {type: series, of: [gone]}\n")
    drawn = run("diagram", "m.yml", cwd=tmp_path)
    assert (drawn.status, "gone" in drawn.out) == (0, False)
    assert "warning: model 'a' uses 'gone', which does not exist" in drawn.err

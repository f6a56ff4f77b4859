"""``expression_file:`` from end to end: check, run, generate, upgrade and the package itself."""

import shutil
from pathlib import Path

import pytest

from tests.cli.command import ROOT, files_below, run

pytestmark = pytest.mark.slow

EVENTS = """\
CONST limit = 80
VAR motor.data : NUMBER UNIT degC TIMEOUT 500ms
EVENT hot (HAZARD) := ONCE(motor.data > limit, 200ms)
EVENT cool (EVIDENCE) := NOT hot
"""
SOURCES = ("-m", "Rover.yml", "-c", "eddi_config.yml")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    example = ROOT / "examples" / "rover-events"
    shutil.copy(example / "Rover.yml", tmp_path)
    text = (example / "eddi_config.yml").read_text("utf-8")
    inline = "from: NOT ONCE(motor.data > 80, 2 s)"
    assert inline in text
    text = text.replace(inline, "expression_file: safety.events\n    event: cool")
    text = text.replace("AVERAGE(battery.percentage, 1 s)", "battery.percentage")
    (tmp_path / "eddi_config.yml").write_text(text, "utf-8")
    (tmp_path / "safety.events").write_text(EVENTS, "utf-8")
    return tmp_path


def test_a_package_is_generated_run_and_upgraded(folder: Path) -> None:
    (folder / "r.csv").write_text("t,BatteryIsFine,MotorIsCool\n0,true,true\n", "utf-8")
    played = run("run", "Rover.yml", "-c", "eddi_config.yml", "-i", "r.csv", cwd=folder)
    assert (played.status, played.out) == (0, "     0.000  MayDrive active\n")
    made = run("generate", "--platform", "plain", "-o", "out", *SOURCES, cwd=folder)
    assert made.status == 0, made.err
    source = (folder / "out" / "rover" / "EDDIInput.py").read_text("utf-8")
    assert "# computed: cool of safety.events: (NOT hot)\n" in source

    before = files_below(folder / "out")
    (folder / "safety.events").rename(folder / "gone.events")
    kept = run("upgrade", "out/rover", "-m", "Rover.yml", cwd=folder)
    assert kept.status == 0, kept.err
    assert files_below(folder / "out") == before
    refused = run("upgrade", "out/rover", *SOURCES, cwd=folder)
    assert (refused.status, "[F001]" in refused.err) == (2, True)

    (folder / "safety.events").write_text(EVENTS.replace("200ms", "100ms"), "utf-8")
    newer = run("upgrade", "out/rover", *SOURCES, cwd=folder)
    assert newer.status == 0, newer.err
    compiled = folder / "out" / "rover" / "compiled.py"
    assert "ONCE(motor.data > 80, 0.1 s)" in compiled.read_text("utf-8")

"""``eddi-scaffold event`` as a user meets it."""

import json
import shutil
from pathlib import Path

import pytest

from tests.cli.command import ROOT, files_below, run
from tests.data_files import data_text, tabled

D72 = "AVERAGE(temp, 5s) > 100 AND TIME(warning == TRUE, 5s)"
CSV = "t,temp,warning\n0,120,true\n1,,\n2,130,\n3,nan,\n4,50,false\n"


def test_json(tmp_path: Path) -> None:
    good = json.loads(run("event", D72, "--rate", "10", "--check", "--json", cwd=tmp_path).out)
    assert list(good) == ["ok", "problems", "diagnostics", "canonical", "variables", "files"]
    assert (good["ok"], [v["name"] for v in good["variables"]]) == (True, ["temp", "warning"])
    bad = run("event", "x > 1 > 2", "--json", cwd=tmp_path)
    assert (bad.status, bad.err) == (2, "")
    actual = json.loads(bad.out)
    assert actual["ok"] is False
    assert actual["problems"][0]["col"] == 7
    (diagnostic,) = actual["diagnostics"]
    assert list(diagnostic) == ["code", "severity", "line", "column", "message", "hint"]
    code = json.loads(run("event", "x > 1", "--target", "c", "--json", cwd=tmp_path).out)
    assert sorted(code["files"]) == [
        *("event_event.c", "event_event.h", "event_main.c", "event_vectors.c"),
    ]


def test_recorded_values(tmp_path: Path) -> None:
    (tmp_path / "v.csv").write_text(CSV)
    text = "AVERAGE(temp, 2s) > 100 AND TIME(warning, 2s)"
    result = run("event", text, "--rate", "1", "-i", "v.csv", cwd=tmp_path)
    assert result.status == 0
    assert result.out == (
        "     0.000  event UNKNOWN\n"
        "     1.000  event TRUE\n"
        "     3.000  event UNKNOWN\n"
        "     4.000  event FALSE\n"
    )
    as_json = run("event", text, "--rate", "1", "-i", "v.csv", "--json", cwd=tmp_path)
    rows = [json.loads(line) for line in as_json.out.splitlines()]
    assert [row["verdict"] for row in rows] == [None, True, True, None, False]
    assert rows[1] == {"t": 1.0, "verdict": True, "outputs": [{"id": "event", "verdict": True}]}
    (tmp_path / "n.csv").write_text("t,x\n0,3\n1,nan\n")
    number = run("event", "x * 2", "-i", "n.csv", "--json", cwd=tmp_path).out.splitlines()
    assert [json.loads(line)["value"] for line in number] == [6.0, None]
    wrong = run("event", text, "--rate", "1", "-i", "n.csv", cwd=tmp_path)
    assert (wrong.status, wrong.out) == (2, "")
    assert "n.csv:1:3: error: no input has the id 'x'" in wrong.err


def test_files_are_written_and_edits_kept(tmp_path: Path) -> None:
    first = run("event", "x > 5", "-o", "out", cwd=tmp_path)
    assert (first.status, first.out, first.err) == (0, "out/event_event.py\n", "")
    path = tmp_path / "out" / "event_event.py"
    path.write_text(path.read_text().replace("raise NotImplementedError('x')", "return 7"))
    assert run("event", "x > 6", "-o", "out", cwd=tmp_path).status == 0
    assert "return 7" in path.read_text()
    gone = run("event", "y > 6", "-o", "out", cwd=tmp_path)
    assert gone.status == 3
    assert "event_event.py.kept.txt" in gone.err
    assert "return 7" in (tmp_path / "out" / "event_event.py.kept.txt").read_text()
    c = run("event", "x > 5", "--target", "c", "-o", "c", cwd=tmp_path)
    assert c.out.splitlines() == [
        *("c/event_event.c", "c/event_event.h", "c/event_main.c", "c/event_vectors.c"),
    ]


@tabled
def test_bad_usage(words: list[str], code: str, tmp_path: Path) -> None:
    (tmp_path / "taken").mkdir()
    (tmp_path / "taken" / "event_event.py").write_text("mine = True\n")
    (tmp_path / "latin.events").write_bytes(b"x > 1 // \xe9")
    (tmp_path / "variables.events").write_text("VAR x : BOOL TIMEOUT 1s\n")
    result = run("event", *words, cwd=tmp_path)
    assert (result.status, result.out) == (2, "")
    assert f"[{code}]" in result.err
    assert (tmp_path / "taken" / "event_event.py").read_text() == "mine = True\n"
    assert not (tmp_path / "out").exists()


SLOW = ROOT / "tests" / "data" / "oracles" / "field" / "slash-units" / "slow.events"


def refused(*words: str) -> str:
    result = run("event", *words, "--rate", "10", "--check", cwd=ROOT)
    assert result.status == 2, result.out
    return result.err


def test_a_unit_with_a_slash_in_a_file() -> None:
    err = refused("--file", str(SLOW))
    assert "2:32: error: a unit is one word here, not m/s [E009]" in err
    assert "hint: write 2 mps" in err


@tabled
def test_what_is_written_instead(text: str, hint: str) -> None:
    assert f"hint: write {hint}" in refused(text)


def test_a_declared_unit_of_several_words_is_one_mistake() -> None:
    err = refused("VAR v : NUMBER UNIT m/s TIMEOUT 500ms\nEVENT slow := v < 2 mps")
    assert "hint: write UNIT mps" in err
    assert "1 error\n" in err
    assert "W003" not in err


@tabled
def test_a_division_is_one(text: str) -> None:
    assert run("event", text, "--rate", "10", "--check", cwd=ROOT).status == 0


pytestmark = pytest.mark.slow

EVENTS = data_text("conditions/safety.events")
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
    assert "computed: cool of safety.events: (NOT hot)\n" in source

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
    assert "ONCE(motor.data > limit, 100ms)" in compiled.read_text("utf-8")

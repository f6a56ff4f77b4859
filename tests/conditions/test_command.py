"""``eddi-scaffold event`` as a user meets it."""

import json
from pathlib import Path

import pytest

from tests.cli.command import run

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
    assert sorted(code["files"]) == ["event_event.c", "event_event.h", "event_main.c"]


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
    assert c.out.splitlines() == ["c/event_event.c", "c/event_event.h", "c/event_main.c"]


@pytest.mark.parametrize(
    ("words", "code"),
    [
        ([], "G000"),
        (["x > 1", "--file", "e.events"], "G000"),
        (["x > 1", "--target", "c"], "G000"),
        (["x > 1", "--rate", "0"], "E005"),
        (["nothere.events"], "F001"),
        (["x > 1", "-o", "taken"], "E020"),
        (["x > 1", "-i", "nothere.csv"], "F001"),
        (["latin.events"], "E001"),
        (["variables.events"], "E026"),
        (["variables.events", "--check"], "E026"),
        (["x > 1", "--name", "wächter", "-o", "out"], "G002"),
        (["x > 1", "--name", "int", "-o", "out"], "G002"),
        (["x > 1", "--name", "size", "--target", "c", "-o", "out"], "G002"),
        (["x > 1", "--name", "Demo One", "--check"], "G002"),
    ],
)
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

"""``eddi-scaffold run``: the embedded way, on the example that the README shows."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
EXAMPLE = ROOT / "examples" / "two-conserts"


def run(*arguments: str, folder: Path = EXAMPLE) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "eddi_scaffold", "run", *arguments],
        cwd=folder,
        env={"PYTHONPATH": f"{ROOT}:{ROOT / 'runtime_lib' / 'src'}", "PATH": "/usr/bin:/bin"},
        capture_output=True,
        text=True,
        check=False,
    )


def test_json_prints_one_object_per_step() -> None:
    done = run(
        "two_conserts.xml", "-c", "consert_a_config.yml", "--inputs", "recording.csv", "--json"
    )
    assert done.returncode == 0, done.stderr
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    assert [line["t"] for line in lines] == [0.0, 0.1, 0.2, 0.3, 0.4, 0.9, 1.0]
    active = [[o["id"] for o in line["outputs"] if o["active"]] for line in lines]
    both = ["System_A_G0", "System_A_G1"]
    assert active == [[], ["System_A_G0"], both, [], both, both, ["System_A_G0"]]


def test_a_model_is_chosen_by_name_without_a_configuration(tmp_path: Path) -> None:
    recording = tmp_path / "b.csv"
    recording.write_text("t,RtE_A_E0\n0,\n1,true\n2,false\n")
    done = run("two_conserts.xml", "--name", "ConSertB", "--inputs", str(recording))
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == [
        "     0.000  System_A_G0_c2 inactive  waits for RtE_A_E0",
        "     1.000  System_A_G0_c2 active",
        "     2.000  System_A_G0_c2 inactive",
    ]


def test_a_value_that_cannot_be_used_is_said_beside_the_input(tmp_path: Path) -> None:
    text = "ENUM Mode { AUTO, HAND }\nVAR m : Mode TIMEOUT 1s\nEVENT e (HAZARD) := m == AUTO\n"
    (tmp_path / "mode.events").write_text(text)
    (tmp_path / "r.csv").write_text("t,m\n0,AUTO\n1,MANUAL\n")
    done = run("mode.events", "--inputs", "r.csv", folder=tmp_path)
    assert done.stdout.splitlines()[1].endswith("waits for m (expected AUTO, HAND, got 'MANUAL')")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time,RtE_A_E0\n", ":1:1: error: the header has no column t (time in seconds) [I001]"),
        ("t,RtE_A_E\n0,1\n", ":1:3: error: no input has the id 'RtE_A_E' [I003]"),
        ("t,RtE_A_E0\n0,1\n1e300,1\n", ":3:1: error: the time 1e300 is out of range: at most"),
        ("t,RtE_A_E0\n", ":1:1: error: there are no rows below the header: nothing can be"),
        (
            "t,RtE_A_E0\n0,maybe\n",
            ":2:3: error: cannot read 'maybe': expected true, false, 1, 0, or nan",
        ),
    ],
)
def test_a_bad_recording_is_told_with_its_place(tmp_path: Path, text: str, message: str) -> None:
    recording = tmp_path / "bad.csv"
    recording.write_text(text)
    done = run("two_conserts.xml", "--name", "ConSertB", "--inputs", str(recording))
    assert done.returncode == 2
    assert f"{recording}{message}" in done.stderr
    assert done.stdout == ""


def test_evidence_of_probability_zero_says_so(tmp_path: Path) -> None:
    (tmp_path / "n.xdsl").write_text(
        '<smile version="1.0" id="N"><nodes><cpt id="A"><state id="y"/><state id="n"/>'
        '<probabilities>1 0</probabilities></cpt><cpt id="B"><state id="y"/><state id="n"/>'
        "<parents>A</parents><probabilities>0.5 0.5 0.5 0.5</probabilities></cpt></nodes></smile>"
    )
    (tmp_path / "in.csv").write_text("t,A,B\n0,n,\n1,y,\n")
    result = run("n.xdsl", "--inputs", "in.csv", "--json", folder=tmp_path)
    first, second = (json.loads(line) for line in result.stdout.splitlines())
    assert first == {"t": 0.0, "outputs": None, "status": "inconsistent"}
    assert second["outputs"][0]["output_nodes"][0]["title"] == "B"

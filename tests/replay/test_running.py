"""``eddi-scaffold run``: the embedded way, on the example that the README shows."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
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


SMALL = """
models: {r: {type: markov, initial: ok, fail: dead, arcs: [{from: ok, to: dead, rate: 1 1/h}],
  observe: {ok: ok, dead: not ok}}}
"""


@pytest.mark.parametrize("words", [["c.yml"], ["-c", "c.yml"], ["small.yml", "-c", "c.yml"]])
def test_a_configuration_that_names_its_model_is_enough(tmp_path: Path, words: list[str]) -> None:
    (tmp_path / "small.yml").write_text(f"horizon: 1 h{SMALL}")
    named = (
        "Model: {id: Small, type: Reliability, frequency: 10, parameters: [{config: small.yml}]}"
    )
    (tmp_path / "c.yml").write_text(f"{named}\nEDDIInputs: [{{id: ok, type: bool}}]\n")
    (tmp_path / "r.csv").write_text("t,ok\n0,true\n")
    done = run(*words, "--inputs", "r.csv", "--csv", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[1].startswith("0.0,0.632")


def test_the_reason_of_a_result_that_is_not_valid_is_told(tmp_path: Path) -> None:
    (tmp_path / "small.yml").write_text(f"max_gap: 2 s{SMALL}")
    (tmp_path / "r.csv").write_text("t,ok\n0,true\n1,true\n5,true\n6,true\n7,nan\n10,nan\n")
    done = run("small.yml", "--inputs", "r.csv", folder=tmp_path)
    ends = [line.partition("valid ")[2].split("  ", 1) for line in done.stdout.splitlines()]
    assert [part[-1].strip() for part in ends] == [
        "active",
        "not valid: gap",
        "active",
        "waits for ok",
        "not valid: gap  waits for ok",
    ]
    table = run("small.yml", "--inputs", "r.csv", "--csv", folder=tmp_path).stdout.splitlines()
    assert table[0].endswith(",valid,reason,unknown")
    assert [",".join(line.split(",")[-2:]) for line in table[1:]] == [
        ",", ",", "gap,", ",", "unknown inputs,ok", "gap,ok",
    ]  # fmt: skip


def test_a_configuration_without_its_model_says_what_to_do() -> None:
    done = run("consert_a_config.yml", "--inputs", "recording.csv")
    assert done.returncode == 2
    assert "not a model, and it names none [F008]" in done.stderr
    assert "hint: run MODEL -c consert_a_config.yml, or name it" in done.stderr
    assert "say of what: run MODEL" in run("--inputs", "recording.csv").stderr


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

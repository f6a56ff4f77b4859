"""``eddi-scaffold run``: the embedded way, on the example that the README shows."""

import json
from pathlib import Path

import pytest

from eddi_scaffold.platforms import chosen  # noqa: F401 - loads what commands load
from tests.cli import command
from tests.cli.command import EXAMPLE, ROOT
from tests.data_files import tabled
from tests.rows import changes

pytestmark = pytest.mark.slow


def run(*arguments: str, folder: Path = EXAMPLE) -> command.Result:
    return command.run("run", *arguments, cwd=folder)


def test_a_model_is_chosen_by_name_without_a_configuration(tmp_path: Path) -> None:
    recording = tmp_path / "b.csv"
    recording.write_text("t,RtE_A_E0\n0,\n1,true\n2,false\n")
    words = ("two_conserts.xml", "--name", "ConSertB", "--inputs", str(recording))
    first = json.loads(run(*words, "--json").out.splitlines()[0])
    assert first["inputs"] == {"RtE_A_E0": None}
    never = "RtE_A_E0: no message yet, 0.0 s after the start"
    why = first["why"]["System_A_G0_c2"]
    assert (why["value"], why["text"]) == ("unknown", f"System_A_G0_c2 <- {never}")
    assert why["causes"][0]["path"] == ["RtE_A_E0"]
    done = run(*words)
    assert done.status == 0, done.err
    assert done.out.splitlines() == [
        f"     0.000  System_A_G0_c2 unknown   <- {never}",
        "     1.000  System_A_G0_c2 active",
        "     2.000  System_A_G0_c2 inactive  <- RtE_A_E0: false for 0.0 s",
    ]
    done = run(*words, "--why", "System_A_G0_c2")
    assert done.out.splitlines() == [
        f"     0.000  System_A_G0_c2 <- {never}",
        "     1.000  System_A_G0_c2 holds",
        "     2.000  System_A_G0_c2 <- RtE_A_E0: false for 0.0 s",
    ]
    done = run(*words, "--why", "System_A_G0")
    assert (done.status, "did you mean 'System_A_G0_c2'?" in done.err) == (2, True)


def test_a_hazard_that_is_absent_is_told_so(tmp_path: Path) -> None:
    (tmp_path / "mode.events").write_text("VAR m : BOOL TIMEOUT 1s\nEVENT e (HAZARD) := m\n")
    (tmp_path / "r.csv").write_text("t,m\n0,false\n1,true\n")
    done = run("mode.events", "--inputs", "r.csv", "--why", "e", folder=tmp_path)
    assert done.out.splitlines()[0] == "     0.000  NOT e holds"
    assert done.out.splitlines()[1].startswith("     1.000  e: ")


def test_a_value_that_cannot_be_used_is_said_beside_the_input(tmp_path: Path) -> None:
    text = "ENUM Mode { AUTO, HAND }\nVAR m : Mode TIMEOUT 1s\nEVENT e (HAZARD) := m == AUTO\n"
    (tmp_path / "mode.events").write_text(text)
    (tmp_path / "r.csv").write_text("t,m\n0,AUTO\n1,MANUAL\n")
    done = run("mode.events", "--inputs", "r.csv", folder=tmp_path)
    assert done.out.splitlines()[1].endswith("<- m: expected AUTO, HAND, got 'MANUAL'")


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
    assert done.status == 0, done.err
    assert done.out.splitlines()[1].startswith("0.0,0.632")


def test_what_was_missed_and_still_counts_is_told(tmp_path: Path) -> None:
    (tmp_path / "small.yml").write_text(SMALL.replace(", dead: not ok", ""))
    (tmp_path / "r.csv").write_text("t,ok\n0,true\n1,nan\n2,true\n3,true\n")
    done = run("small.yml", "--inputs", "r.csv", folder=tmp_path)
    assert "leaves out the fail state dead" in done.err
    end = "r: ok was missing 1 s after the start, and no input shows that it has not failed since"
    assert done.out.splitlines()[-1].endswith(f"valid active    {end}")


def test_evidence_of_probability_zero_says_so(tmp_path: Path) -> None:
    (tmp_path / "n.xdsl").write_text(
        '<smile version="1.0" id="N"><nodes><cpt id="A"><state id="y"/><state id="n"/>'
        '<probabilities>1 0</probabilities></cpt><cpt id="B"><state id="y"/><state id="n"/>'
        "<parents>A</parents><probabilities>0.5 0.5 0.5 0.5</probabilities></cpt></nodes></smile>"
    )
    (tmp_path / "in.csv").write_text("t,A,B\n0,n,\n1,y,\n")
    result = run("n.xdsl", "--inputs", "in.csv", "--json", folder=tmp_path)
    first, second = (json.loads(line) for line in result.out.splitlines())
    inputs = {"A": "n", "B": None}
    assert first == {"t": 0.0, "inputs": inputs, "outputs": None, "status": "inconsistent"}
    assert second["outputs"][0]["output_nodes"][0]["title"] == "B"
    words = run("n.xdsl", "--inputs", "in.csv", folder=tmp_path).out.splitlines()
    assert words[0].split("B unknown")[1].split() == ["status", "inconsistent"]
    assert words[1].endswith("B y  status partial")


GAP = "t,RtE_A_D0,RtE_A_E0\n0,true,true\n10,true,true\n"


def configured(folder: Path, old: str, new: str) -> None:
    """Put the example into a folder, its configuration changed."""
    for file in ("two_conserts.xml", "consert_a_config.yml"):
        text = (EXAMPLE / file).read_text().replace(old, new)
        (folder / file).write_text(text)
    (folder / "r.csv").write_text(GAP)


def changes_of(folder: Path, *more: str) -> list[tuple[str, str]]:
    words = ("two_conserts.xml", "-c", "consert_a_config.yml", "--inputs", "r.csv")
    done = run(*words, *more, folder=folder)
    assert done.status == 0, done.err
    return changes(done.out)


@tabled
def test_an_outage_is_seen(model, times, tmp_path):
    """At the next step, or on change when the age ends."""
    configured(tmp_path, "frequency: 10", model)
    wanted = zip(times, ["11", "1?", "??", "11"], strict=True)
    assert changes_of(tmp_path) == list(wanted)


def test_one_step_per_row_shows_no_outage(tmp_path: Path) -> None:
    configured(tmp_path, "", "")
    assert changes_of(tmp_path, "--steps", "rows") == [("0.000", "11")]
    words = ("two_conserts.xml", "-c", "consert_a_config.yml", "--inputs", "r.csv", "--json")
    lines = run(*words, "--steps", "rows", folder=tmp_path).out.splitlines()
    assert [json.loads(line)["t"] for line in lines] == [0.0, 10.0]


def test_digits_alone_are_no_change() -> None:
    """p_fail of the drone rises in every step; a line is printed when something is decided."""
    words = ("drone.xml", "-c", "reliability_config.yml", "--inputs", "recording.csv")
    folder = ROOT / "examples" / "drone"
    lines = run(*words, folder=folder).out.splitlines()
    assert [(line[:10].strip(), line.endswith("RtE_continue active")) for line in lines] == [
        ("0.000", False), ("1.000", True), ("7.000", False),
    ]  # fmt: skip
    table = run(*words, "--csv", folder=folder).out.splitlines()
    assert len({line.split(",")[1] for line in table[1:]}) > 90

"""``explain`` prints the section of a code, in words and for programs."""

import json
from pathlib import Path

from tests.cli.command import run


def test_a_code_for_programs(tmp_path: Path) -> None:
    shown = json.loads(run("explain", "K006", "--json", cwd=tmp_path).out)
    assert list(shown) == ["code", "title", "levels", "why", "fix", "cases"]
    assert (shown["code"], shown["levels"]) == ("K006", ["error", "warning"])
    assert list(shown["cases"][0]) == ["case", "level", "text", "hint"]


def test_a_text_that_is_like_no_code(tmp_path: Path) -> None:
    result = run("explain", "surplus brace", cwd=tmp_path)
    assert (result.status, result.out) == (2, "")
    assert "there is no code 'surplus brace' [G008]\n  hint: a code is like K007" in result.err


def test_a_robot_that_runs_is_not_played(tmp_path: Path) -> None:
    result = run("explain", "Fast", "--domain", 3, "--bag", "x.bag", cwd=tmp_path)
    assert result.status == 2
    assert "--domain and --bag exclude each other [G000]" in result.err


def test_a_claim_is_explained_on_recorded_values(tmp_path: Path) -> None:
    (tmp_path / "cart.yml").write_text("evidence: {Free: bool}\nguarantees: {MayDrive: Free}\n")
    (tmp_path / "cart_config.yml").write_text(
        "Model: {id: cart, type: ConSert, model: cart.yml}\n"
        "SimulatorOutputs: [{id: gap, type: std_msgs/Bool, topic: gap}]\n"
        "EDDIInputs: [{id: Free, from: gap, max_age: 0.5 s}]\n"
    )
    (tmp_path / "drive.csv").write_text("t,Free\n0,true\n1,\n2,true\n")
    words = ("explain", "MayDrive", "cart_config.yml", "--inputs", "drive.csv")
    late = run(*words, "--at", 1.0, cwd=tmp_path)
    silent = "MayDrive <- Free <- /gap: nothing for 1.0 s, limit 0.5 s\n"
    assert (late.status, late.out.startswith(silent)) == (1, True), late.err
    assert run(*words, cwd=tmp_path).status == 0

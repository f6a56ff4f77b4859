"""``explain`` prints the section of a code, in words and for programs."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from eddi_scaffold.common.catalogue import find
from tests.cli.command import Result, run


@pytest.mark.parametrize("code", ["D002", "d002"])
def test_a_code_in_words(code: str, tmp_path: Path) -> None:
    result = run("explain", code, cwd=tmp_path)
    found = find("D002")
    assert found is not None
    assert (result.status, result.err) == (0, "")
    head, why, what_to_do, title, example = result.out.rstrip("\n").split("\n\n")
    assert head == "D002: a hazard where true is good (error)"
    assert why.replace("\n", " ") == found.why
    assert what_to_do.replace("\n", " ") == f"What to do: {found.what_to_do}"
    assert title == "Example:"
    assert "\n".join(line[4:] for line in example.split("\n")) == found.example


def test_a_code_for_programs(tmp_path: Path) -> None:
    result = run("explain", "K006", "--json", cwd=tmp_path)
    found = json.loads(result.out)
    assert list(found) == ["code", "title", "levels", "why", "what_to_do", "example"]
    assert (found["code"], found["levels"]) == ("K006", ["error", "warning"])


@pytest.mark.parametrize(
    ("code", "hint"),
    [
        ("L088", "did you mean L008 or L014"),
        ("surplus brace", "a code is like K007"),
        ("", "a code is"),
    ],
)
def test_an_unknown_code_names_the_nearest(code: str, hint: str, tmp_path: Path) -> None:
    result = run("explain", code, cwd=tmp_path)
    assert (result.status, result.out) == (2, "")
    assert f"error: there is no code {code!r} [G023]\n  hint: {hint}" in result.err


def test_nothing_but_a_code(tmp_path: Path) -> None:
    assert run("explain", cwd=tmp_path).status == 2
    assert run("explain", "K007", "-q", cwd=tmp_path) == Result(
        0, run("explain", "K007", cwd=tmp_path).out, ""
    )

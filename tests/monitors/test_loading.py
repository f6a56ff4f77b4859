"""Files that hold no model: what is wrong with them is said in a word."""

from pathlib import Path

import pytest

from eddi_scaffold.common.files import read_source
from eddi_scaffold.deployments.checking import check_files
from eddi_scaffold.monitors.loading import read_models


@pytest.mark.parametrize(
    ("name", "data", "said"),
    [
        ("m.xml", b" \n", "this file is empty"),
        ("m.yml", b"", "this file is empty"),
        ("m.bin", b"\x00\x01", "this is not text"),
        ("m.png", b"\x89PNG", "this is not text"),
        ("m.txt", b"hello", "this is neither an EDDI XML file nor a model"),
    ],
)
def test_a_file_without_a_model(tmp_path: Path, name: str, data: bytes, said: str) -> None:
    path = tmp_path / name
    path.write_bytes(data)
    (problem,) = read_models(read_source(path)).problems
    assert (problem.code, problem.message.startswith(said)) == ("F003", True)


@pytest.mark.parametrize(
    ("text", "line", "said", "hint"),
    [
        ("robots:\n  - {name: a}\nbindings: []\n", 1, "no section 'robots'", "mean 'Robots', of"),
        ("title: x\nmodel: {id: a}\n", 2, "no section 'model'", "mean 'Model', of a confi"),
        ("version: 3\nnetworks: {}\n", 1, "no file of ours: it has the keys", "`guarantees`, a "),
    ],
)
def test_yaml_that_is_no_consert_gets_one_error(
    text: str, line: int, said: str, hint: str, tmp_path: Path
) -> None:
    file = tmp_path / "deployment.yml"
    file.write_text(text, "utf-8")
    (problem,) = check_files([file])
    assert (problem.code, problem.place.line) == ("F003", line)
    assert said in problem.message
    assert hint in (problem.hint or "")


def test_yaml_with_a_misspelt_key_of_a_consert_is_one(tmp_path: Path) -> None:
    file = tmp_path / "m.yml"
    file.write_text("guarantee: []\n", "utf-8")
    (problem,) = check_files([file])
    assert problem.code == "F003"
    assert "guarantees" in f"{problem.message} {problem.hint}"

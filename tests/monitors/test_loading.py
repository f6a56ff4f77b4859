"""Files that hold no model: what is wrong with them is said in a word."""

from __future__ import annotations

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
        (
            "robots:\n  - {name: a}\nbindings: []\n",
            1,
            "there is no section 'robots', and no other key",
            "did you mean 'Robots', of a deployment file?",
        ),
        (
            "title: x\nmodel: {id: a}\n",
            2,
            "there is no section 'model', and no other key",
            "did you mean 'Model', of a configuration?",
        ),
        (
            "version: 3\nnetworks: {}\n",
            1,
            "this is no file of ours: it has the keys version, networks",
            "a ConSert has `guarantees`, a configuration has `Model`",
        ),
    ],
)
def test_yaml_that_is_no_consert_gets_one_error(
    text: str, line: int, said: str, hint: str, tmp_path: Path
) -> None:
    file = tmp_path / "deployment.yml"
    file.write_text(text, "utf-8")
    (problem,) = check_files([file])
    assert (problem.code, problem.place.line, problem.message.startswith(said)) == (
        "F003",
        line,
        True,
    )
    assert (problem.hint or "").startswith(hint)


def test_yaml_with_a_misspelt_key_of_a_consert_is_one(tmp_path: Path) -> None:
    file = tmp_path / "m.yml"
    file.write_text("guarantee: []\n", "utf-8")
    (problem,) = check_files([file])
    assert problem.code == "F003"
    assert "guarantees" in f"{problem.message} {problem.hint}"

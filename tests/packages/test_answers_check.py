"""Damaged answers of one package: said, whatever the command makes beside it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.cli.command import example, run

ANSWERS = "ws/src/eddi_monitor/consertb/.copier-answers.yml"
GENERATE = ("generate", "-w", "ws", "-m", "two_conserts.xml", "-c")
DAMAGE = {
    "no inputs": (r"^inputs:", "inputz:"),
    "an input without topics": (r"^  sources: .*", "  topics: x"),
    "an unknown kind": (r"^kind: .*", "kind: nonsense"),
    "a list for a text": (r"^  title: .*", "  title: [1]"),
    "a model without id": (r'"id": "ConSertB"', '"name": 3'),
    "a configuration that is none": (r"^config_json: .*(\n  .*)*", "config_json: '3'"),
    "no file of the model": (r"^model_file: .*\n", ""),
}


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = example(tmp_path_factory.mktemp("answers"))
    (folder / "ws/src").mkdir(parents=True)
    configs = ("consert_a_config.yml", "-c", "consert_b_config.yml")
    assert run(*GENERATE, *configs, cwd=folder).status == 0
    return folder


@pytest.mark.parametrize("name", DAMAGE)
def test_damaged_answers_are_bad_input(workspace: Path, name: str) -> None:
    file = workspace / ANSWERS
    sound = file.read_text("utf-8")
    damaged = re.sub(DAMAGE[name][0], DAMAGE[name][1], sound, flags=re.MULTILINE)
    assert damaged != sound
    file.write_text(damaged, "utf-8")
    try:
        beside = run(*GENERATE, "consert_a_config.yml", cwd=workspace)
        upgrade = run("upgrade", "-w", "ws", cwd=workspace)
        for found in (beside, upgrade):
            assert found.status == 2
            assert "[T005]" in found.err
        assert file.read_text("utf-8") == damaged
        assert run(*GENERATE, "consert_b_config.yml", cwd=workspace).status in {0, 3}
        assert run("upgrade", "-w", "ws", cwd=workspace).status == 0
    finally:
        file.write_text(sound, "utf-8")


def test_after_a_merge_that_left_markers(workspace: Path) -> None:
    file = workspace / ANSWERS
    sound = file.read_text("utf-8")
    file.write_text(f"<<<<<<< HEAD\n{sound}=======\n>>>>>>> side\n", "utf-8")
    try:
        found = run(*GENERATE, "consert_b_config.yml", cwd=workspace)
    finally:
        file.write_text(sound, "utf-8")
    assert found.status == 2
    hint = "hint: take one side and generate again: git checkout --ours "
    assert f"{hint}ws/src/eddi_monitor/consertb/.copier-answers.yml" in found.err

"""Damaged answers of one package: said, whatever the command makes beside it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.packages.workspace import check_answers
from tests.cli.command import EXAMPLE, example, run

ANSWERS = "ws/src/eddi_monitor/consertb/.copier-answers.yml"
GENERATE = ("generate", "-w", "ws", "-m", "two_conserts.xml", "-c")
DAMAGE = {
    "no inputs": (r"^inputs:", "inputz:"),
    "an input without topics": (r", sources: ", ", topics: "),
    "an unknown kind": (r"^kind: .*", "kind: nonsense"),
    "a list for a text": (r" title: \w+,", " title: [1],"),
    "a model without id": (r'"id": "ConSertB"', '"name": 3'),
    "a configuration that is none": (r"^config:(\n  .*)*", "config: '3'"),
    "no file of the model": (r"^model_file: .*\n", ""),
}


@pytest.mark.parametrize("name", DAMAGE)
def test_damaged_answers_are_bad_input(name: str) -> None:
    package = EXAMPLE / "expected/src/eddi_monitor/consertb"
    sound = (package / ".copier-answers.yml").read_text("utf-8")
    damaged = re.sub(DAMAGE[name][0], DAMAGE[name][1], sound, flags=re.MULTILINE)
    assert damaged != sound
    check_answers(package, yaml.safe_load(sound))
    with pytest.raises(EddiError) as refused:
        check_answers(package, yaml.safe_load(damaged))
    assert [problem.code for problem in refused.value.problems] == ["T005"]


def test_they_stop_commands_that_do_not_make_the_package_anew(tmp_path: Path) -> None:
    folder = example(tmp_path)
    configs = ("consert_a_config.yml", "-c", "consert_b_config.yml")
    assert run(*GENERATE, *configs, cwd=folder).status == 0
    file = folder / ANSWERS
    sound = file.read_text("utf-8")
    damaged = sound.replace("\ninputs:", "\ninputz:")
    file.write_text(damaged, "utf-8")
    beside = run(*GENERATE, "consert_a_config.yml", cwd=folder)
    upgrade = run("upgrade", "-w", "ws", cwd=folder)
    for result in (beside, upgrade):
        assert result.status == 2
        assert "[T005]" in result.err
    assert file.read_text("utf-8") == damaged
    assert run(*GENERATE, "consert_b_config.yml", cwd=folder).status in {0, 3}
    assert run("upgrade", "-w", "ws", cwd=folder).status == 0

"""What ``generate`` refuses because of its files, ``check`` of the same files refuses as well."""

import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.cli.command import example, run
from tests.cli.test_diagnostics import CASES, Case, lay

MODEL = "two_conserts.xml"
OF_OPTIONS = {"G000", "G006", "G007", "G008", "G015", "G017"}  # and of the destination
OF_PACKAGES_THERE = {"G001", "G027", "H010", "H012"}
NOT_IN_THE_FILES = {
    "G026 a monitor reads what another one wants spelt differently": "about a package there",
    "D003 ConSerts that feed each other in one workspace": "about a package that is there",
    "D003 the same in one workspace": "about a package that is there",
    "K001 a configuration in place of a deployment file": "an option is missing",
    "K001 a model in place of a configuration": "`check` sees that it is a model",
    "K001 the file is XML": "a model in place of a configuration: `check` sees that it is a model",
}
OTHER_CODE = {
    "K001 a list at the top": "C001",
    "K001 nothing in the file": "C001",
}
"""Files of which only `-c` tells that they should be configurations."""


def refused() -> Iterator[Case]:
    """Return the cases in which `generate` refuses files."""
    for case in CASES:
        is_refused = case.commands[-1].startswith("generate ") and case.status == 2
        if is_refused and case.code not in OF_OPTIONS | OF_PACKAGES_THERE:
            yield case


def as_check(command: str) -> list[str]:
    """Return `check` of the same files with the same options."""
    files, options = [], []
    words = iter(shlex.split(command)[1:])
    for word in words:
        if word in {"-m", "-c"}:
            files.append(next(words))
        elif word in {"-w", "-o"}:
            next(words)
        else:
            options.append(word)
    return ["check", *files, *options]


@pytest.mark.parametrize(
    "case",
    [case for case in refused() if case.title not in NOT_IN_THE_FILES],
    ids=lambda case: case.title.replace(" ", "_"),
)
def test_check_refuses_what_generate_refuses(case: Case, tmp_path: Path) -> None:
    lay(case, tmp_path)
    result = run(*as_check(case.commands[-1]), cwd=tmp_path)
    code = OTHER_CODE.get(case.title, case.code)
    assert re.search(rf" error: .*\[{code}\]", f" {result.err}"), result.err
    assert result.status == 1


def test_every_exception_is_a_case() -> None:
    titles = {case.title for case in refused()}
    assert {*NOT_IN_THE_FILES, *OTHER_CODE} - titles == set()


def test_a_platform_asks_whether_monitors_can_be_generated(tmp_path: Path) -> None:
    example(tmp_path)
    assert run("check", MODEL, cwd=tmp_path).status == 0
    assert run("check", MODEL, "--platform", "plain", cwd=tmp_path).status == 0
    asked = run("check", MODEL, "--platform", "ros1", cwd=tmp_path)
    assert (asked.status, asked.err.count("[G001]")) == (1, 1)
    assert run("check", "consert_a_config.yml", cwd=tmp_path).status == 0
    asked = run("check", "consert_a_config.yml", "--platform", "ros1", cwd=tmp_path)
    assert asked.status == 1
    assert "error: the configuration does not name its model [G015]" in asked.err
    assert run("check", MODEL, "--platform", "ros3", cwd=tmp_path).status == 2


def test_the_marks_count_for_a_model_that_a_configuration_names(tmp_path: Path) -> None:
    example(tmp_path)
    (tmp_path / "wait.yml").write_text(
        "guarantees: [{id: Wait, dimensions: [{Binary: {type: Stands}}]}]\n"
        "demands: []\nevidence: []\ngates: []\ntree_propagations: []\n"
        "required_services: []\nprovided_services: []\n"
    )
    config = tmp_path / "wait_config.yml"
    config.write_text(
        "Model: {id: wait, type: ConSert, parameters: [{model: wait.yml}]}\n"
        "EDDIOutputs: [{id: wait, topic: /wait}]\n"
    )
    mark = ("--default-guarantee", "Wait")
    assert run("check", config.name, cwd=tmp_path).status == 1
    assert run("check", config.name, *mark, cwd=tmp_path).status == 0


def test_what_is_left_to_a_person_is_said_in_short_lines(tmp_path: Path) -> None:
    (tmp_path / "cart.yml").write_text("evidence: {Upright: bool}\nguarantees: {Go: Upright}\n")
    (tmp_path / "cart_config.yml").write_text(
        "Model: {id: cart, type: ConSert, model: cart.yml}\n"
        "SimulatorOutputs: [{id: imu, type: sensor_msgs/Imu, topic: imu}]\n"
        "EDDIInputs: [{id: Upright, requires: [imu], max_age: 1 s}]\n"
    )
    plain = ("generate", "--platform", "plain", "-o", "out", "-c", "cart_config.yml")
    assert run(*plain, cwd=tmp_path).status == 0
    text = (tmp_path / "out/cart/EDDIInput.py").read_text()
    assert "# imu has .header, .orientation" in text
    assert max(map(len, text.splitlines())) <= 100

"""A package that a later release made is not taken down by an earlier one without a word."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from eddi_scaffold import __version__
from eddi_scaffold.packages.rendering import is_newer
from tests.cli.command import edit, example, files_below, run
from tests.diagnosed import assert_reported
from tests.package_texts import facts_in

pytestmark = pytest.mark.slow

MODEL, CONFIG = "two_conserts.xml", "consert_b_config.yml"
RECORDS = {".copier-answers.yml", ".eddi/manifest"}
GENERATE = ("generate", "--platform", "plain", "-o", "ws", "-m", MODEL, "-c", CONFIG)


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace that version 9 has made."""
    folder = example(tmp_path_factory.mktemp("made"))
    assert run(*GENERATE, cwd=folder).status == 0
    answers = folder / "ws/consertb/.copier-answers.yml"
    text = answers.read_text()
    answers.write_text(re.sub(r"(?m)^generator_version: .*$", "generator_version: 9.0.0", text))
    assert answers.read_text() != text
    return folder


@pytest.mark.parametrize(
    "words",
    [(*GENERATE, "--dry-run"), ("upgrade", "ws/consertb")],
)
def test_it_is_refused_with_both_versions(folder: Path, words: tuple[str, ...]) -> None:
    before = files_below(folder)
    result = run(*words, cwd=folder)
    assert result.status == 2
    assert_reported("T006", result.err)
    assert files_below(folder) == before


WITH_MODEL = ("upgrade", "-w", "ws", "-m", MODEL)


@pytest.fixture
def older(folder: Path) -> Path:
    """The same, that version 0.0.1 has made."""
    edit(folder / "ws/consertb/.copier-answers.yml", "9.0.0", "0.0.1")
    return folder


def test_a_monitor_is_compiled_of_the_text_in_its_package(older: Path) -> None:
    (older / MODEL).unlink()
    package, before = older / "ws/consertb", files_below(older / "ws/consertb")
    facts, traced = facts_in(package), run("trace", "-w", "ws", cwd=older).out
    result = run("upgrade", "-w", "ws", cwd=older)
    assert result.status == 0, result.err
    after = files_below(package)
    assert {name for name in before if after[name] != before[name]} == {"compiled.py", *RECORDS}
    assert facts_in(package) == facts  # with the places in the EDDI
    assert run("trace", "-w", "ws", cwd=older).out == traced
    assert run("upgrade", "-w", "ws", cwd=older).status == 0
    config = (older / CONFIG).read_text()
    (older / CONFIG).write_text(config.replace("max_age: 2", "max_age: 3"))
    assert run("upgrade", "-w", "ws", "-c", CONFIG, cwd=older).status == 0
    newer = facts_in(package)
    assert newer.inputs[0].max_age == 3.0
    assert replace(newer, inputs=facts.inputs, digest=facts.digest) == facts


@pytest.mark.parametrize(
    "damage", [("SensorHealthy", "Other"), ("evidence:", "evidence"), ("guarantees:", "")]
)
def test_a_text_that_is_not_its_model_is_not_used(older: Path, damage: tuple[str, str]) -> None:
    package = older / "ws/consertb"
    text, compiled = package / "ConSertB.yml", (package / "compiled.py").read_bytes()
    before = text.read_text()
    text.write_text(before.replace(*damage))
    assert text.read_text() != before
    result = run("upgrade", "-w", "ws", cwd=older)
    told = "compiled.py stays as eddi-scaffold 0.0.1 made it; name the model with -m"
    assert (result.status, told in result.out + result.err) == (3, True), result
    assert "ConSertB.yml: edited outside regions" in result.out + result.err
    assert (package / "compiled.py").read_bytes() == compiled
    assert not text.exists()
    run(*WITH_MODEL, cwd=older)
    assert text.read_text() == before


@pytest.mark.parametrize(
    ("version", "newer"),
    [(__version__, False), ("0.0.1", False), ("999.0", True), ("", False), ("unknown", False)],
)
def test_what_is_newer(version: str, newer: bool) -> None:
    assert is_newer(version) is newer

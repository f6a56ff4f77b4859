"""`verify`: what it says of packages, of edited ones, and of many models."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from hypothesis import settings

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.packages.verifying import checked
from tests.cli.command import EXAMPLE, ROOT, Result, run
from tests.data_files import write_files
from tests.frozen import corpus


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Generate both monitors of the example for plain Python."""
    place = tmp_path_factory.mktemp("verify")
    for file in EXAMPLE.iterdir():
        if file.is_file():
            shutil.copy(file, place)
    words = ("--platform", "plain", "-o", "pl", "-m", "two_conserts.xml")
    configs = ("-c", "consert_a_config.yml", "-c", "consert_b_config.yml")
    done = run("generate", *words, *configs, cwd=place)
    assert done.status == 0, done.err
    assert "conserta: 9 vectors; proved" in done.err
    return place


def verify(folder: Path, *words: str) -> Result:
    return run("verify", "pl/conserta", *words, cwd=folder)


def edit(folder: Path, file: str, old: str, new: str) -> None:
    path = folder / "pl" / "conserta" / file
    text = path.read_text("utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), "utf-8")


def test_what_is_proved_tested_trusted(folder: Path) -> None:
    done = run("verify", "pl/conserta", "pl/consertb", cwd=folder)
    assert done.status == 0
    lines = done.out.splitlines()
    assert lines[0] == "conserta: proved equal to two_conserts.xml (sha256 1cb9cca2)"
    assert (
        lines[1]
        == "  proved   System_A_G0, System_A_G1 for all verdicts of 2 inputs; the table of inputs"
    )
    assert lines[2] == "  tested   9 vectors, all passed"
    assert lines[3].startswith("  trusted  Python 3.")
    assert lines[4].startswith("consertb: proved")


def test_a_configuration_is_compared(folder: Path) -> None:
    assert verify(folder, "-c", "consert_a_config.yml").status == 0
    config = folder / "consert_a_config.yml"
    config.write_text(config.read_text("utf-8").replace("max_age: 2.0", "max_age: 3.0"), "utf-8")
    done = verify(folder, "-c", "consert_a_config.yml")
    assert done.status == 1
    assert "differs from" in done.out
    assert "max_age=2.0, requires=('RtE_E0',)), the model says InputSpec('RtE_A_E0'" in done.out


def test_a_hand_edit_is_not_covered_and_changes_nothing_else(folder: Path) -> None:
    before = verify(folder).out
    edit(folder, "EDDIInput.py", "self.RtE_A_E0 = RtE_E0.data", "self.RtE_A_E0 = True")
    done = verify(folder)
    assert done.status == 0
    (line,) = {*done.out.splitlines()} ^ {*before.splitlines()}
    assert line.startswith("  not      process_RtE_A_E0: hand-written (sig ")


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            "            RtE_A_E0 == 2,",
            "            RtE_A_D0 == 2,",
            "RtE_A_D0=U RtE_A_E0=T: System_A_G0 not active, the model says TRUE",
        ),
        ("        return", "        print('x')\n        return", "not proved: compiled.py:5"),
        ("class Monitor", "import os\n\n\nclass Monitor", "not proved: compiled.py:"),
        ("class Monitor", "class Monitor(", "it is no Python"),
    ],
)
def test_another_text_is_not_proved(folder: Path, old: str, new: str, expected: str) -> None:
    edit(folder, "compiled.py", old, new)
    done = verify(folder)
    assert done.status == 1
    assert expected in done.out
    assert "  proved" not in done.out
    assert not json.loads(verify(folder, "--json").out)["packages"][0]["holds"]


def test_vectors_are_those_of_the_model(folder: Path) -> None:
    edit(folder, "test/vectors.json", "TT", "FF")
    done = verify(folder)
    assert done.status == 1
    assert "test/vectors.json is not that of the model" in done.out


@pytest.mark.parametrize(
    "package",
    [
        "two-conserts/expected/src/eddi_monitor/conserta",
        "two-conserts/expected/src/eddi_monitor/consertb",
        "motor-watch/expected/motor_watch",
        "drone/expected/missionloss",
        "safeml/expected/camera_scope",
        "shuttle/expected/shuttle",
    ],
)
def test_packages_of_examples_are_proved(package: str) -> None:
    done = run("verify", ROOT / "examples" / package, cwd=ROOT)
    assert done.status == 0, done.out


LEFT_OUT = {"it is inferred by operations of numpy", "it has independent parts"}


@pytest.mark.slow
@pytest.mark.parametrize("kind", corpus.MAKERS)
def test_every_random_model_is_proved(kind: str, tmp_path: Path) -> None:
    usual = 200 if kind in ("consert", "event") else 40
    count = 1000 if settings.default.max_examples > 1000 else usual
    proved = 0
    for case, files in corpus.random_cases(kind, count):
        folder = write_files(tmp_path / case, files)
        models = [folder / model for model in corpus.models(folder)]
        for config in [None, *corpus.configurations(folder)]:
            for model in models or [None]:  # of the file that the configuration names
                try:
                    monitors, _ = monitors_of(model, [folder / config] if config else [])
                except EddiError:  # a configuration of another model, or a model that is refused
                    continue
                for monitor in monitors:
                    if monitor.model.kind == kind:
                        _, findings = checked(monitor, monitor.compiled.text)
                        told = {of.text for of in findings}
                        left_out = LEFT_OUT if kind == "bayesian_network" else set()
                        if kind == "reliability":
                            left_out = {of for of in told if of.startswith("it has gates")}
                        assert told <= left_out, (case, findings, monitor.compiled.text)
                        proved += not told
    assert proved >= (0.4 if kind == "bayesian_network" else 0.8) * count

"""Answers can be given to Copier directly: none may bring code, markup or a file name of its own.

Real Copier renders packages of which one answer is hostile. It refuses the answer, or what it
writes has the syntax of the sound package, in every language.
"""

import copy
import tempfile
import warnings
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import copier
import pytest
import yaml
from copier.errors import CopierError
from hypothesis import given, settings
from hypothesis import strategies as st

from eddi_scaffold.packages.assembly import assemble, monitors_of
from eddi_scaffold.platforms import platforms
from eddi_scaffold.regions.package import NEW
from tests.cli.command import ROOT, files_below, template
from tests.data_files import data_text
from tests.fuzz.readers import without_cross_check
from tests.fuzz.test_names_are_no_code import FEW, check_texts, shapes
from tests.hostile_texts import HOSTILE

pytestmark = pytest.mark.slow

Answers = dict[str, Any]
PATHS = tuple[str | int, ...]
_STAGE = "rendering"
EXAMPLES = ROOT / "examples"
MODELS = {
    "ros1": (EXAMPLES / "two-conserts/two_conserts.xml", "consert_a_config.yml"),
    "network": (EXAMPLES / "pedestrian/pedestrian.xml", "eddi_config.yml"),
    "plain": (ROOT / "tests/golden/models/rover.yml", None),
}
TEXTS = yaml.safe_load(data_text("fuzz/answers.yml"))


@cache
def sound(which: str) -> dict[str, Answers]:
    """Return the answers of the packages of a workspace, by name."""
    model, config = MODELS[which]
    configs = [model.parent / config] if config else []
    monitors, problems = monitors_of(model, configs)
    # no cross-check: it loads another library for seconds, whenever tests are collected
    monitors = [without_cross_check(one) for one in monitors]
    platform = platforms()["plain" if which == "plain" else "ros1"]
    with tempfile.TemporaryDirectory() as folder:
        packages = assemble(monitors, platform, Path(folder, "src", "x"), problems).packages
    return {package.folder: dict(package.answers) for package in packages}


@cache
def sound_files(which: str, package: str, *, flag: str = "") -> dict[str, bytes]:
    """Return what Copier renders from the sound answers, or from them with one flag set."""
    answers = sound(which)[package]
    files = rendered({**answers, flag: True} if flag else answers)
    assert files is not None
    return files


def rendered(answers: Answers) -> dict[str, bytes] | None:
    """Render a package with Copier, all files in their places; ``None``: it refused."""
    with tempfile.TemporaryDirectory(prefix="eddi-answers-") as folder:
        try:
            copied({**answers, "stage": _STAGE}, Path(folder, "package"))
        except (CopierError, ValueError, OSError):  # OSError: a name that is too long
            return None
        files = files_below(Path(folder, "package"))
        return {path.removeprefix(f"{NEW}/{_STAGE}/"): data for path, data in files.items()}


def copied(answers: Answers, folder: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        copier.run_copy(
            template().location,
            folder,
            data=answers,
            defaults=True,
            quiet=True,
            unsafe=True,
            skip_tasks=True,
        )


def leaves(value: dict[str, Any] | list[Any], path: PATHS = ()) -> Iterator[PATHS]:
    """Yield the place of every text, list and map in some answers."""
    for key, part in value.items() if isinstance(value, dict) else enumerate(value):
        yield (*path, key)
        if isinstance(part, dict | list):
            yield from leaves(part, (*path, key))


def changed(answers: Answers, path: PATHS, value: object) -> Answers:
    new = copy.deepcopy(answers)
    inner: Any = new
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = value
    return new


PLACES = [
    (which, package, path)
    for which in MODELS
    for package, answers in sound(which).items()
    for path in leaves(answers)
]


@settings(max_examples=5 * FEW)
@given(place=st.sampled_from(PLACES), text=st.sampled_from([*HOSTILE, *TEXTS["code"]]))
def test_hostile_answers(place: tuple[str, str, PATHS], text: str) -> None:
    which, package, path = place
    files = rendered(changed(sound(which)[package], path, text))
    if files is not None:
        sound_ones = sound_files(which, package)
        if path == ("single_process",) and shapes(files) != shapes(sound_ones):
            # Copier takes most texts for true, and a true brings a file
            sound_ones = sound_files(which, package, flag="single_process")
        assert shapes(files) == shapes(sound_ones)
        check_texts(files)
        if path != ("package",):
            assert files.keys() <= sound_ones.keys()


@pytest.mark.parametrize(("place", "value"), TEXTS["refused"])
def test_refused(place: str, value: object, tmp_path: Path) -> None:
    question, *rest = (int(word) if word.isdigit() else word for word in place.split())
    answers = sound("network")["pedestrian_prediction_example"]
    hostile = changed({question: None, **answers}, (question, *rest), value)
    with pytest.raises(ValueError, match=f"Validation error for question '{question}'"):
        copied(hostile, tmp_path / "p")


def test_hostile_answers_of_a_package_are_refused(tmp_path: Path) -> None:
    """What somebody wrote into its .copier-answers.yml is not rendered by an update."""
    package = tmp_path / "conserta"
    copied(sound("ros1")["conserta"], package)
    file = package / ".copier-answers.yml"
    text = file.read_text("utf-8")
    assert text.count("self.RtE_A_E0 = RtE_E0.data") == 1
    file.write_text(text.replace("self.RtE_A_E0 = RtE_E0.data", "import os"), "utf-8")
    before = files_below(package)
    with pytest.raises(ValueError, match='Question "inputs" is required'):
        copier.run_recopy(package, defaults=True, overwrite=True, quiet=True, unsafe=True)
    assert files_below(package) == before

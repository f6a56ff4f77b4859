"""Compiled SafeML monitors: the text and its tables."""

import hashlib
import random
import re
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from eddi_runtime import ModelError

from eddi_scaffold.kinds.safeml.compile import compile_safeml
from eddi_scaffold.packages.assembly import assemble, monitors_of
from eddi_scaffold.packages.generation import write_packages
from eddi_scaffold.packages.rendering import own_template
from eddi_scaffold.packages.upgrading import groups, targets
from eddi_scaffold.platforms import platforms
from runtime_lib.tests.safeml.monitors import scope, step
from tests.kinds.safeml.monitors import CONNECTED, lay
from tests.package_texts import facts_in, loaded
from tests.program.formatting import assert_plain_data

ROWS = [[k / 10] for k in range(10)]
WIDE = np.random.RandomState(1).normal(size=(60, 5)).tolist()
PCA = {"components": 2, "residual": True, "halves": True}
CASES = [
    scope(ROWS),
    scope(WIDE, metric="ad", spec=PCA, max_age=1.5),
    scope(np.random.RandomState(2).normal(size=(9, 30)).tolist(), metric="cvm"),
    scope(ROWS, stride=3, array_backend="torch", on_omission="clear"),
]
HOSTILE = '"""\nimport os\n__import__("os")'


@pytest.mark.parametrize("made", CASES)
def test_the_formatter_changes_nothing(made):
    assert_plain_data(made.text())


def test_nothing_of_a_hostile_model_becomes_code():
    keys = {"id": HOSTILE, "attribute": "a b", "accepts": [HOSTILE]}
    made = scope(ROWS, name=HOSTILE, reference=HOSTILE, input_keys=keys)
    assert_plain_data(made.text())
    assert made.monitor().inputs[0].id == HOSTILE


def test_a_reference_in_a_file_is_the_same(tmp_path, monkeypatch):
    made = scope(WIDE, metric="ad", spec=PCA)
    in_text = made.monitor()
    monkeypatch.setattr(f"{compile_safeml.__module__}.MOST_IN_TEXT", 20)
    (tmp_path / "filed_scope.py").write_text(made.text())
    files = made.compiled().tables
    assert "reference.bin" in files
    for name, data in files.items():
        (tmp_path / name).write_bytes(data)
    monkeypatch.syspath_prepend(tmp_path)
    of_file, in_memory = __import__("filed_scope").Monitor(), made.monitor()
    for row in WIDE:
        results = [step(one, row) for one in (of_file, in_memory, in_text)]
        assert results[0] == results[1] == results[2]
    assert not results[0].omission


def test_a_file_that_is_absent_or_another_one_is_refused_at_the_start(tmp_path, monkeypatch):
    monkeypatch.setattr(f"{compile_safeml.__module__}.MOST_IN_TEXT", 20)
    (tmp_path / "lone_scope.py").write_text(scope(WIDE).text())
    monkeypatch.syspath_prepend(tmp_path)
    monitor_class = __import__("lone_scope").Monitor
    with pytest.raises(ModelError, match=r"reference\.bin: cannot read the file: No such .* again"):
        monitor_class()
    (tmp_path / "reference.bin").write_bytes(b"changed")
    with pytest.raises(ModelError, match=r"reference\.bin: the file changed since generation: run"):
        monitor_class()


_CHANCE = random.Random(1)
LINES = [[_CHANCE.gauss(0, 1)] for _ in range(100)]
LARGE = [[_CHANCE.gauss(0, 1)] for _ in range(4010)]
KEYS = {
    "window_size": 10,
    "significance_level": 0.1,
    "distance_metric": "KolmogorovSmirnovDistance",
}


def generated(
    inputs: Path, packages: Path, name: str, rows: Sequence[Sequence[float]] = LINES
) -> Path:
    inputs.mkdir(exist_ok=True)
    lay(inputs, rows, **KEYS)
    config = inputs / "eddi_config.yml"
    config.write_text(CONNECTED.replace("id: scope", f"id: {name}"))
    monitors, problems = monitors_of(None, [config])
    made = assemble(monitors, platforms()["plain"], packages, problems)
    write_packages(packages, made.packages, own_template())
    return config


def levels(packages: Path, model: Path, *configs: Path) -> dict[str, float]:
    (group,) = groups(packages, [])
    found, _ = targets(group, model, configs)
    shown = re.compile(r" tests? .*at ([0-9.]+) each")
    monitors = [one for one in found if "readme" in one.answers]  # the others are the runtime
    lines = {one.folder: " ".join(one.answers["readme"]) for one in monitors}
    return {name: float(shown.search(line)[1]) for name, line in lines.items()}


def test_a_newer_file_reaches_its_package(tmp_path: Path) -> None:
    config = generated(tmp_path / "in", tmp_path / "out", "scope")
    model = lay(tmp_path / "in", LINES[:90], **{**KEYS, "significance_level": 0.2})
    assert levels(tmp_path / "out", model) == {"scope": 0.2}
    assert levels(tmp_path / "out", model, config) == {"scope": 0.2}
    (group,) = groups(tmp_path / "out", [])
    write_packages(group.root, targets(group, model, [])[0], own_template())
    facts = facts_in(tmp_path / "out" / "scope")
    assert facts.file_sha256 == hashlib.sha256(model.read_bytes()).hexdigest()
    (reference,) = facts.elements
    digest = hashlib.sha256((tmp_path / "in" / "reference.csv").read_bytes()).hexdigest()
    assert reference.sha256 == digest
    text = (tmp_path / "out" / "scope" / "compiled.py").read_text("utf-8")
    assert text.count(facts.digest) == 1


def test_a_large_reference_comes_and_goes(tmp_path: Path) -> None:
    folder = tmp_path / "out" / "scope"
    for rows, names in ((LINES, []), (LARGE, ["reference.bin"]), (LINES, [])):
        generated(tmp_path / "in", tmp_path / "out", "scope", rows)
        assert [path.name for path in folder.glob("*.bin")] == names
        monitor = loaded(folder)[0].monitor
        assert monitor.execute_step(SimpleNamespace(sample=[0.5]), 0).accepted == 1


def test_newer_templates_leave_a_large_reference(tmp_path: Path) -> None:
    generated(tmp_path / "in", tmp_path / "out", "scope", LARGE)
    (group,) = groups(tmp_path / "out", [])
    group.present["scope"]["package_version"] = "0.2.0"
    outcome = write_packages(group.root, targets(group, None, [])[0], own_template())
    assert "scope/pyproject.toml" in outcome.changes
    assert [path.name for path in outcome.root.glob("scope/*.bin")] == ["reference.bin"]

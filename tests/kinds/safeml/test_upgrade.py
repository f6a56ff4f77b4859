"""A newer reference or configuration into a package that has its name from a configuration."""

import hashlib
import random
import re
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace

from eddi_scaffold.packages.assembly import assemble, monitors_of
from eddi_scaffold.packages.generation import write_packages
from eddi_scaffold.packages.rendering import own_template
from eddi_scaffold.packages.running import load
from eddi_scaffold.packages.upgrading import groups, targets
from eddi_scaffold.platforms import platforms
from tests.kinds.safeml.monitors import CONNECTED, lay
from tests.package_texts import facts_in

_CHANCE = random.Random(1)
ROWS = [[_CHANCE.gauss(0, 1)] for _ in range(100)]
LARGE = [[_CHANCE.gauss(0, 1)] for _ in range(4010)]
KEYS = {
    "window_size": 10,
    "significance_level": 0.1,
    "distance_metric": "KolmogorovSmirnovDistance",
}


def generated(
    inputs: Path, packages: Path, name: str, rows: Sequence[Sequence[float]] = ROWS
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
    lines = {one.folder: " ".join(one.answers["readme"]) for one in found}
    return {name: float(shown.search(line)[1]) for name, line in lines.items()}


def test_a_newer_file_reaches_its_package(tmp_path: Path) -> None:
    config = generated(tmp_path / "in", tmp_path / "out", "scope")
    model = lay(tmp_path / "in", ROWS[:90], **{**KEYS, "significance_level": 0.2})
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
    for rows, names in ((ROWS, []), (LARGE, ["reference.bin"]), (ROWS, [])):
        generated(tmp_path / "in", tmp_path / "out", "scope", rows)
        assert [path.name for path in folder.glob("*.bin")] == names
        monitor = load(folder).new()[0].monitor
        assert monitor.execute_step(SimpleNamespace(sample=[0.5]), 0).accepted == 1


def test_newer_templates_leave_a_large_reference(tmp_path: Path) -> None:
    generated(tmp_path / "in", tmp_path / "out", "scope", LARGE)
    (group,) = groups(tmp_path / "out", [])
    group.present["scope"]["package_version"] = "0.2.0"
    outcome = write_packages(group.root, targets(group, None, [])[0], own_template())
    assert "scope/pyproject.toml" in outcome.changes
    assert [path.name for path in outcome.root.glob("scope/*.bin")] == ["reference.bin"]

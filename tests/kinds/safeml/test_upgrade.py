"""A newer reference or configuration into a package that has its name from a configuration."""

from __future__ import annotations

import json
import random
from pathlib import Path

import pytest

from eddi_scaffold.packages.assembly import assemble, monitors_of
from eddi_scaffold.packages.generation import write_packages
from eddi_scaffold.packages.rendering import own_template
from eddi_scaffold.packages.upgrading import groups, targets
from eddi_scaffold.platforms import platforms
from eddi_scaffold.problems import EddiError
from tests.kinds.safeml.monitors import CONNECTED, lay

_CHANCE = random.Random(1)
ROWS = [[_CHANCE.gauss(0, 1)] for _ in range(100)]
KEYS = {
    "window_size": 10,
    "significance_level": 0.1,
    "distance_metric": "KolmogorovSmirnovDistance",
}


def generated(inputs: Path, packages: Path, name: str) -> Path:
    """Generate the package of this name and return its configuration."""
    inputs.mkdir()
    lay(inputs, ROWS, **KEYS)
    config = inputs / "eddi_config.yml"
    config.write_text(CONNECTED.replace("id: scope", f"id: {name}"))
    monitors, problems = monitors_of(None, [config])
    made = assemble(monitors, platforms()["plain"], packages, problems)
    write_packages(packages, made.packages, own_template())
    return config


def levels(packages: Path, model: Path, *configs: Path) -> dict[str, float]:
    (group,) = groups(packages, [])
    found, _ = targets(group, model, configs)
    models = {one.folder: json.loads(one.answers["model_json"]) for one in found}
    return {name: model["model"]["significance_level"] for name, model in models.items()}


def test_a_newer_file_reaches_its_package(tmp_path: Path) -> None:
    config = generated(tmp_path / "in", tmp_path / "out", "scope")
    model = lay(tmp_path / "in", ROWS[:90], **{**KEYS, "significance_level": 0.2})
    assert levels(tmp_path / "out", model) == {"scope": 0.2}
    assert levels(tmp_path / "out", model, config) == {"scope": 0.2}
    (group,) = groups(tmp_path / "out", [])
    write_packages(group.root, targets(group, model, [])[0], own_template())
    written = (tmp_path / "out" / "scope" / "reference.csv").read_bytes()
    assert written == (tmp_path / "in" / "reference.csv").read_bytes()


def test_of_two_packages_the_configuration_says_which(tmp_path: Path) -> None:
    config = generated(tmp_path / "a", tmp_path / "out", "camera")
    generated(tmp_path / "b", tmp_path / "out", "lidar")
    model = lay(tmp_path / "a", ROWS, **{**KEYS, "significance_level": 0.2})
    with pytest.raises(EddiError, match="several packages here were made of a file"):
        levels(tmp_path / "out", model)
    assert levels(tmp_path / "out", model, config) == {"camera": 0.2, "lidar": 0.1}

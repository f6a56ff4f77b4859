"""Systems joined with their models: whole systems of others, and each rule by itself."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

from eddi_scaffold.mros.directory import load_models, load_system
from eddi_scaffold.mros.outputs import Outputs, simulator_outputs
from eddi_scaffold.problems import Problem, has_errors
from tests.shared_data import shared


def outputs_of(system: Path, folder: Path, **options: Any) -> tuple[Outputs, list[Problem]]:
    one, problems = load_system(system, folder)
    models = load_models(folder, systems=bool(one.system.subsystems))
    outputs = simulator_outputs(one, models, **options)
    return outputs, [*problems, *models.problems, *outputs.problems]


def cases() -> list[Any]:
    try:
        return list(yaml.safe_load(shared("mros/expected/cases.yml").read_text("utf-8")))
    except pytest.skip.Exception:
        return [{"name": "none"}]


@pytest.mark.parametrize("case", cases(), ids=lambda case: case["name"])
def test_whole_systems(case: dict[str, Any]) -> None:
    folder = shared("mros/expected")
    options = {"include": [word for word in case["options"] if word != "--include"]}
    found, problems = outputs_of(folder / case["system"], folder / case["models"], **options)
    wanted = yaml.safe_load((folder / case["result"]).read_text("utf-8"))["SimulatorOutputs"]
    assert [{"id": t.id, "type": t.type, "topic": t.topic} for t in found.topics] == wanted
    assert sorted((p.level, p.place.file, p.place.line, p.code) for p in problems) == sorted(
        (d["severity"], d["file"], d["line"], d["code"]) for d in case["diagnostics"]
    )
    counts = (found.components, found.publishers, len(found.topics), int(has_errors(problems)))
    keys = ("components", "resolved_publishers", "topics", "exit")
    assert counts == tuple(case[key] for key in keys)

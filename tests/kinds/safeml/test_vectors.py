"""Vectors of SafeML: a monitor passes its own; every mutant is killed, or ``verify`` sees it."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from eddi_runtime.testing import failures

from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.packages.verifying import checked
from eddi_scaffold.recordings.playing import compiled
from tests.checkouts import HERE
from tests.data_files import tabled
from tests.evidence.mutants import Mutated, input_class, mutants
from tests.kinds.safeml.monitors import CONNECTED, LONG_NAMES, joined

EXAMPLES = HERE / "examples" / "safeml"


@tabled
def test_a_monitor_passes_its_vectors(metric: str, keys: dict[str, Any], tmp_path: Path) -> None:
    rows = np.random.default_rng(3).normal(size=(240, 3)).tolist()
    needed = {"window_size": 12, "significance_level": 0.05, "distance_metric": LONG_NAMES[metric]}
    monitor, _ = joined(tmp_path, rows, CONNECTED, **needed, **keys)
    file, class_ = tmp_path / "vectors.json", type(compiled(monitor))
    file.write_text(monitor.model.vectors(monitor.bound, {}))
    assert failures(str(file), class_, input_class(class_)) == []
    results = [step[2] for _, steps in json.loads(file.read_text())["runs"] for step in steps]
    assert {True, False} <= {result.get("odd_violation") for result in results}


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::SyntaxWarning")
def test_each_mutant_is_killed_or_verify_sees_it(
    tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    configs = [EXAMPLES / "perception_config.yml"]
    scope = monitors_of(EXAMPLES / "safeml_config.yml", configs)[0][0]
    mutated, number = Mutated(scope, tmp_path), Counter[str]()
    assert json.loads(mutated.vectors.read_text())["complete"]
    assert checked(scope, f"{mutated.head}\n{mutated.body}")[1] == []
    for text in mutants(mutated.body, mutated.drawn(request, 0.08)):
        how = "vectors kill it" if mutated.killed(text)[0] else "verify sees it"
        number[how] += 1
        if how == "verify sees it":
            assert checked(scope, f"{mutated.head}\n{text}")[1], text
    assert number["vectors kill it"] > number["verify sees it"]  # which are of the table of a law

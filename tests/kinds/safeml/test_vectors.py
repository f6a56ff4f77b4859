"""Vectors of SafeML: a monitor passes its own, and every mutant is killed or equal."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from eddi_runtime.testing import failures

from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.recordings.playing import compiled
from tests.checkouts import HERE
from tests.data_files import tabled
from tests.evidence.mutants import Mutated, input_class
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
def test_each_mutant_is_killed_or_proved_equal(
    tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    configs = [EXAMPLES / "perception_config.yml"]
    mutated = Mutated(monitors_of(EXAMPLES / "safeml_config.yml", configs)[0][0], tmp_path)
    assert json.loads(mutated.vectors.read_text())["complete"]
    original = mutated.original
    points = [value + d for value in original.tail._values for d in (-1e-6, 0.0, 1e-6)]
    values = sorted([*points, *(k / 100 for k in range(2000))])

    def bounds(of: Any) -> list[float]:
        return [min(1.0, 4 * of.tail(value)) for value in values]

    expected, own = bounds(original), original()
    smallest = own._comparison.reference[3].min()  # of what the axes leave out
    for (before, after), mutant in mutated.survivors(mutated.drawn(request, 0.04)):
        # a probability of four tests is at most 1: what is more of one is not seen; and nothing of
        # the reference is as small as what counts as 0
        is_same = bounds(mutant) == pytest.approx(expected, rel=1e-9)
        is_tail = is_same and before.startswith("tail =")
        is_floor = mutant.axes._floor != original.axes._floor and mutant.axes._floor < smallest
        assert is_tail or is_floor, (before, after)

"""Vectors of state machines: a monitor passes its own, and every mutant is killed or equal."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from eddi_runtime.testing import failures

from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import Declaration
from runtime_lib.tests.bound_models import BoundModel
from tests.evidence.mutants import input_class
from tests.kinds.state_machine.test_state_machine_oracle import CASES, configured_case

DIFFERENT = {json.dumps([case["model"], case["config"]]): case for case in CASES}


@pytest.mark.parametrize("case", DIFFERENT.values(), ids=[c["id"] for c in DIFFERENT.values()])
def test_a_monitor_passes_its_vectors(case: dict[str, Any], tmp_path: Path) -> None:
    model, file = configured_case(case), tmp_path / "vectors.json"
    inputs = tuple(
        BoundInput(
            of.id,
            of.id,
            (f"source_{of.id}",),
            "none" if of.every_message else 0.5,
            every_message=of.every_message,
        )
        for of in model.inputs()
    )
    file.write_text(model.vectors(inputs, {}))
    monitor_class = BoundModel(model, Declaration("a", "0" * 64, inputs)).module().Monitor
    assert failures(str(file), monitor_class, input_class(monitor_class)) == []
    assert len(json.loads(file.read_text())["runs"]) > 20

"""Vectors of state machines: a monitor passes them; each mutant fails, or ``verify`` sees it."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from eddi_runtime.testing import failures

from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.packages.verifying import checked
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import Declaration
from runtime_lib.tests.bound_models import BoundModel
from tests.checkouts import HERE
from tests.evidence.mutants import Mutated, input_class, mutants
from tests.kinds.state_machine.test_state_machine_oracle import CASES, configured_case

DIFFERENT = {json.dumps([case["model"], case["config"]]): case for case in CASES}
EXAMPLES = HERE / "examples" / "shuttle"


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


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::SyntaxWarning")
def test_each_mutant_is_killed_or_verify_sees_it(
    tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    configs = [EXAMPLES / "shuttle_config.yml"]
    shuttle = monitors_of(EXAMPLES / "shuttle.xml", configs)[0][0]
    mutated, number = Mutated(shuttle, tmp_path), Counter[str]()
    assert checked(shuttle, f"{mutated.head}\n{mutated.body}")[1] == []
    for text in mutants(mutated.body, mutated.drawn(request, 0.05)):
        how = "vectors kill it" if mutated.killed(text)[0] else "verify sees it"
        number[how] += 1
        if how == "verify sees it":
            assert checked(shuttle, f"{mutated.head}\n{text}")[1], text
    assert number["vectors kill it"] > 2 * number["verify sees it"]

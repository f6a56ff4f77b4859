"""Vectors of state machines: a monitor passes its own, and every mutant is killed or equal."""

from __future__ import annotations

import json
import math
import re
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from eddi_runtime.testing import failures

from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import Declaration
from runtime_lib.tests.bound_models import BoundModel
from tests.checkouts import HERE
from tests.evidence.mutants import Mutated, input_class
from tests.kinds.state_machine.test_state_machine_oracle import CASES, configured_case

DIFFERENT = {json.dumps([case["model"], case["config"]]): case for case in CASES}
EXAMPLES = HERE / "examples" / "shuttle"
GAP = re.compile(r"if 2 \* \(t - last\) > (\d+):")


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


def declared(of: Any) -> list[object]:
    """Return what decides in the tables of a machine.

    Names, texts and places are for people. Of several triggers, needs or states the order does not
    count, that of transitions only in one state, and what is raised is momentary anyway. In the
    state 1 of the shuttle it does not count either: who stops there does so in the state 0, too,
    where the other transition leads.
    """
    triggers = [
        (frozenset(row.needs), row.raised or row.momentary, *row[3:])
        for row in (*of.triggers, of.reset_by)
    ]
    leaving: dict[int, list[object]] = {}
    for row in of.transitions:
        leaving.setdefault(row.source, []).append((row.target, frozenset(row.triggers), row.after))
    leaving[1] = sorted(leaving[1], key=repr)
    evidence = sorted((row.id, sorted(row.states), row.hold) for row in of.evidence)
    return [triggers, leaving, evidence, of.start == "unknown", of.states, of.actions, of.max_gap]


def conditions(of: Any, numbers: set[float]) -> list[object]:
    """Return the truths of the shuttle's conditions for inputs of each order with some numbers."""
    near = {math.nextafter(number, end) for number in numbers for end in (-math.inf, math.inf)}
    between = {(a + b) / 2 for a in numbers for b in numbers}
    values = [*numbers, *near, *between, math.inf, math.nan, None, "1", True]
    truths = (True, False, None, 1, "x")
    monitor, rows = of(), list[object]()
    monitor.w3 = lambda _, __, truth: truth  # what its window sees
    for t, row in enumerate(product(values, values[-1:], truths, truths)):
        for dirt, charge, fault, cleaned in (row, (*row[1::-1], *row[2:])):
            given = {"dirt": dirt, "charge": charge, "drive_fault": fault, "cleaned": cleaned}
            source = SimpleNamespace(**given, released=[], restarted=[])
            rows.append([(int(v) == 2, int(v) == 1) for v in monitor.step(source, 10**9 * t)])
    return rows


def is_proved(before: str, after: str, original: Any, mutant: Any, numbers: set[float]) -> bool:
    """Return whether a changed line is the same for every input, each way by an argument."""
    if "state_machine." in before or before.startswith("start ="):
        return declared(original) == declared(mutant)
    ends = [GAP.fullmatch(line) for line in (before, after)]
    if ends[0] and ends[1]:  # twice a whole number is never odd
        return int(ends[0][1]) // 2 == int(ends[1][1]) // 2
    if after.replace("!=", "is not") == before:  # one for None and types
        return " None " in before or "type(" in before
    if "windows[-1]" in after:  # there is one
        return len(original().windows) == 1
    if "actions=True" in after:  # `EDDIMonitor` of the package gives one
        return True
    return conditions(original, numbers) == conditions(mutant, numbers)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::SyntaxWarning")
def test_each_mutant_is_killed_or_proved_equal(
    tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    configs = [EXAMPLES / "shuttle_config.yml"]
    mutated = Mutated(monitors_of(EXAMPLES / "shuttle.xml", configs)[0][0], tmp_path)
    assert json.loads(mutated.vectors.read_text())["complete"]
    for change, mutant in mutated.survivors(mutated.drawn(request, 0.05)):
        numbers = {float(of) for of in re.findall(r"-?\b[0-9]+\.[0-9]+\b", "".join(change))}
        assert is_proved(*change, mutated.original, mutant, numbers), change

"""What `verify` says of the text of a ConSert: no other function is called proved."""

from __future__ import annotations

import ast
import time
from pathlib import Path
from typing import Any

import pytest

from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.packages.verifying import checked
from tests.evidence.mutants import mutants
from tests.kinds.consert.test_vectors import observed

EXAMPLE = Path(__file__).parents[3] / "examples" / "two-conserts"
CRANE = """\
evidence: {Clear: bool, Light: bool, Wind: 0 .. 10 m/s, Load: [none, low]}
gates: {Calm: Wind AND Load}
guarantees: {Lift: Clear AND (Light OR Calm), Lower: Clear AND Light, Stop: always}
"""


def crane(tmp_path: Path) -> BoundMonitor:
    (tmp_path / "crane.yml").write_text(CRANE, "utf-8")
    (monitor,), _ = monitors_of(tmp_path / "crane.yml", [])
    return monitor


@pytest.mark.slow
def test_a_mutant_that_is_called_proved_is_equal_by_exhaustion() -> None:
    models, configs = EXAMPLE / "two_conserts.xml", [EXAMPLE / "consert_a_config.yml"]
    (monitor,), _ = monitors_of(models, configs)
    text = monitor.compiled.text
    assert checked(monitor, text)[1] == []

    def shown(of: str) -> list[object]:
        scope: dict[str, Any] = {"__name__": "compiled", "__file__": "no file"}
        exec(of, scope)
        made = scope["Monitor"]
        return [made.model_id, made.digest, made.inputs, made.topics, *observed(made)]

    expected, seen = shown(text), 0
    for mutant in mutants(text):
        if checked(monitor, mutant)[1]:
            seen += 1
        elif mutant != ast.unparse(ast.parse(text)):
            assert shown(mutant) == expected, mutant
    assert seen > 150


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("Light if Light > Calm", "Light if Light < Calm", "not active, the model says TRUE"),
        ("Clear if Clear < Light", "Clear if Clear > Light", "active, the model says UNKNOWN"),
        ("0.0 <= Wind <= 10.0", "0.0 <= Wind < 10.0", "it has no known form"),
        ('in {"none", "low"}', 'in {"none"}', "it has no known form"),
        ('paths=(("Clear", "Light"),)', 'paths=(("Clear",),)', "paths=(('Clear',),)"),
        (", source):\n", ", source):\n        self.judge = None\n", "it has no known form"),
        ("self.judge(1, Light)", "self.judge(0, Light)", "it has no known form"),
        ("source.Clear, source.Light", "source.Light, source.Clear", "it is not the input Clear"),
    ],
)
def test_differences_have_a_counterexample(
    old: str, new: str, expected: str, tmp_path: Path
) -> None:
    monitor = crane(tmp_path)
    text = monitor.compiled.text
    assert checked(monitor, text)[0] == [
        "Lift, Lower, Stop for all verdicts of 4 inputs",
        "4 inputs",
    ]
    assert old in text
    finding = checked(monitor, text.replace(old, new, 1))[1][0]
    assert expected in finding.text


def test_three_hundred_gates_take_less_than_two_seconds(tmp_path: Path) -> None:
    gates = [
        f"  G{k}: E{2 * k} {'AND' if k % 2 else 'OR'} E{2 * k + 1}"
        + (f" {'AND' if k % 2 else 'OR'} G{k - 1}" if k else "")
        for k in range(300)
    ]
    evidence = [f"  E{k}: bool" for k in range(600)]
    lines = ["evidence:", *evidence, "gates:", *gates, "guarantees:", "  Go: G299", ""]
    (tmp_path / "large.yml").write_text("\n".join(lines), "utf-8")
    (monitor,), _ = monitors_of(tmp_path / "large.yml", [])
    before = time.process_time()
    assert checked(monitor, monitor.compiled.text)[1] == []
    assert time.process_time() - before < 2

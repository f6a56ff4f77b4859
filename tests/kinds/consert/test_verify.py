"""What `verify` says of the text of a ConSert: no other function is called proved."""

from __future__ import annotations

import ast
import re
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


RETURNED = """\
(
            Lift == 2,  # Lift
            Lower == 2,  # Lower
            2 == 2,  # Stop
        )"""
EXECUTED = """\
Lift, Lower, Stop = self.step(source)
        self.look(t_ns)
        return [{"id": "Lift", "active": Lift}, {"id": "Lower", "active": Lower}"""
LOST = re.sub(r"Lift\b(?!\")|Lower\b(?!\")", "_", EXECUTED)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("Light if Light > Calm", "Light if Light < Calm", "not active, the model says TRUE"),
        ("Clear if Clear < Light", "Clear if Clear > Light", "active, the model says UNKNOWN"),
        ("0.0 <= Wind <= 10.0", "0.0 <= Wind < 10.0", "it is not as the model says"),
        ('in {"none", "low"}', 'in {"none"}', "it is not as the model says"),
        ('paths=(("Clear", "Light"),)', 'paths=(("Clear",),)', "paths=(('Clear',),)"),
        (", source):\n", ", source):\n        self.judge = None\n", "it is not as the model says"),
        ("step(self, source):", "step(self, source) -> print():", "it has no known form"),
        ("consert.Binary(),", '("consert.Binary", (), {}),', "leaves 1 is ('consert.Binary'"),
        (RETURNED, "{Lift == 2, Lower == 2, 2 == 2}", "it has no known form"),
        (EXECUTED, LOST, "a name has two meanings"),
        (EXECUTED, re.sub(r'Lift\b(?!")', "t_ns", EXECUTED), "a name has two meanings"),
        ("Lower == 2,", "Lower,", "it has no known form"),
        ("self.judge(1, Light)", "self.judge(0, Light)", "it is not as the model says"),
        ("source.Clear, source.Light", "source.Light, source.Clear", "it is not as the model says"),
    ],
)
def test_differences_have_a_counterexample(
    old: str, new: str, expected: str, tmp_path: Path
) -> None:
    monitor = crane(tmp_path)
    text = monitor.compiled.text
    assert checked(monitor, text)[0] == [
        "Lift, Lower, Stop for all verdicts of 4 inputs",
        "the table of inputs",
    ]
    assert old in text
    finding = checked(monitor, text.replace(old, new, 1))[1][0]
    assert expected in finding.text


def test_each_statement_is_needed(tmp_path: Path) -> None:
    monitor = crane(tmp_path)
    text = monitor.compiled.text
    places = [
        (number, k)
        for number, node in enumerate(ast.walk(ast.parse(text)))
        for k in range(len(getattr(node, "body", ())) if not isinstance(node, ast.IfExp) else 0)
    ]
    for number, k in places[1:]:  # all but the docstring
        tree = ast.parse(text)
        body = [*ast.walk(tree)][number].body
        body[k : k + 1] = [] if len(body) > 1 else [ast.Pass()]
        assert checked(monitor, ast.unparse(tree))[1] != [], ast.unparse(tree)
    assert len(places) > 30


CONFIG = """\
Model: {id: cart, type: ConSert, frequency: 10}
SimulatorOutputs:
- {id: scan, topic: /scan, type: sensor_msgs/LaserScan}
- {id: odom, topic: /odom, type: nav_msgs/Odometry}
EDDIInputs:
- id: Clear
  expression: NOT ONCE(MIN(scan.ranges[*], SECTOR -30 deg .. 30 deg) < 0.5 m, 1 s)
  max_age: 0.5
- id: Slow
  expression: COUNT(scan.ranges[*] + 1 m < 2 m, LENGTH 3 .. 1000) < 5
    OR odom.twist.twist.linear.x < 1
  max_age: 0.5
"""


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("", ""),
        ("hold.Hold(1000000000, 900000000, 2)", "hold.Hold(1000000000, 900000000, 0)"),
        (".windows[0].push", ".windows[1].push"),
        ("2 * (t - last) > 500000000", "2 * (t - last) > 400000000"),
        ("-0.5235987755982988, ", "0.5235987755982988, "),
        ("(3, 1000)", "(3, 1001)"),
        ("lists.finite(a + r1) for a in", "lists.finite(a - r1) for a in"),
        ("lists.aggregate(min, ", "lists.aggregate(max, "),
        ('("twist", "twist", "linear", "x")', '("twist", "twist", "linear", "y")'),
        (" < 1.0 else 0 if ", " < 1.0 else 1 if "),
        (" < 5.0 else", " <= 5.0 else"),
        ("= expressions.stamp(t, ages.get", "= expressions.stamp(t, messages.get"),
        ('= {"scan": ("message", "scan")', '= {"scan": ("message", "odom")'),
        ('= {"scan": (', '= {**vars(), "scan": ('),
        ("expression=Expression_Slow", "expression=Expression_Clear"),
        ("    type = ", "    hazard = True\n    type = "),
        ("self.last = t\n", ""),
        ("        outputs = (", "        self.since = 0\n        outputs = ("),
    ],
)
def test_expressions_of_inputs(old: str, new: str, tmp_path: Path) -> None:
    guarantees = "evidence: {Clear: bool, Slow: bool}\nguarantees: {Go: Clear AND Slow}\n"
    (tmp_path / "cart.yml").write_text(guarantees, "utf-8")
    (tmp_path / "config.yml").write_text(CONFIG, "utf-8")
    (monitor,), _ = monitors_of(tmp_path / "cart.yml", [tmp_path / "config.yml"])
    text = monitor.compiled.text
    assert old in text
    proved, findings = checked(monitor, text.replace(old, new, 1) if old else text)
    assert bool(findings) == bool(old)
    assert bool(proved) == (not old)


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

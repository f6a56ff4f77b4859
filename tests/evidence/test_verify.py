"""`verify` on packages of each kind: no text that computes something else is called proved."""

from __future__ import annotations

import ast
from pathlib import Path
from random import Random

import pytest

from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.packages.verifying import checked
from tests.evidence.mutants import mutants
from tests.frozen.random_models import MAKERS

ROOT = Path(__file__).parents[2]
PACKAGES = {
    "state_machine": ("examples/shuttle/shuttle.xml", "examples/shuttle/shuttle_config.yml", 571),
    "safeml": ("examples/safeml/safeml_config.yml", "examples/safeml/perception_config.yml", 485),
    "network": ("examples/warehouse-robot/localisation.bif", "", 1081),
    "fault tree": ("examples/drone/drone.xml", "examples/drone/reliability_config.yml", 274),
    "ready-made": ("tests/data/reliability/every_key.yml", "", 2514),
    "mission's end": ("tests/data/reliability/every_input.yml", "", 304),
}
"""Model, configuration, and how many single mutants its text has."""
ARRAYS = 20  # random network of which a part is inferred by operations of numpy
TRIED = 60  # of each, outside of the long profile


@pytest.mark.slow
@pytest.mark.parametrize(("model", "config", "count"), PACKAGES.values(), ids=PACKAGES)
def test_every_mutant_is_seen(
    model: str, config: str, count: int, request: pytest.FixtureRequest
) -> None:
    (monitor,), _ = monitors_of(ROOT / model, [ROOT / config] if config else [])
    tree = ast.parse(monitor.compiled.text)
    assert checked(monitor, monitor.compiled.text)[1] == []
    is_long = request.config.getoption("--hypothesis-profile") == "long"
    draw, seen, about = Random(1), 0, ast.get_docstring(tree)
    for mutant in mutants(ast.unparse(tree), lambda _: is_long or draw.random() < TRIED / count):
        if ast.get_docstring(ast.parse(mutant)) == about:  # else it computes the same
            assert checked(monitor, mutant)[1] != [], mutant
            seen += 1
    assert seen > TRIED / 2


@pytest.mark.slow
@pytest.mark.parametrize("name", [*PACKAGES, "arrays"])
def test_each_statement_is_needed(name: str, tmp_path: Path) -> None:
    (tmp_path / "net.bif").write_text(MAKERS["bayesian_network"](ARRAYS)["network.bif"], "utf-8")
    model, config, _ = PACKAGES.get(name, (str(tmp_path / "net.bif"), "", 0))
    (monitor,), _ = monitors_of(ROOT / model, [ROOT / config] if config else [])
    tree = ast.parse(monitor.compiled.text)
    bodies = [of.body for of in ast.walk(tree) if isinstance(getattr(of, "body", None), list)]
    seen = 0
    for body in bodies:
        for k in range(body is bodies[0], len(body)):  # all but the docstring
            statement = body.pop(k)
            body.extend([] if body else [ast.Pass()])
            _, findings = checked(monitor, ast.unparse(tree))
            assert findings != [], ast.unparse(statement)
            body[:] = [of for of in body if not isinstance(of, ast.Pass)]
            body.insert(k, statement)
            seen += 1
    assert seen > 20
    assert checked(monitor, ast.unparse(tree))[1] == []


@pytest.mark.parametrize(
    ("name", "old", "new", "expected"),
    [
        ("state_machine", "initial=True", "fail=True", "states 1 is state_machine.State"),
        ("state_machine", "hold=2000000000", "hold=2", "evidence 2 is state_machine.Evidence"),
        ("state_machine", "outputs = (r3, r6", "outputs = (r6, r3", "it is not as the model says"),
        ("safeml", "threshold = 6", "threshold = 7", "threshold is 7.87807403"),
        ("safeml", "14.112", "14.113", "axes is safeml.Axes((("),
        ("safeml", '"b08e', '"b08f', "reference is safeml.Table("),
        ("network", "v1_0 * 0.999", "v1_1 * 0.999", "number ("),
        ("network", "(0.9, 0.1)", "(0.8, 0.2)", "its priors are"),
        ("network", "s[0] * 3", "s[0] * 2", "it is another row of t0"),
        ("network", "((0.999, 0.001),)", "None", "known form"),
        ("network", "((0.999, 0.001),)", "((0.999, 0.002),)", "the model says 0.001"),
        ("fault tree", "q1 * n0_0", "q1 + n0_0", "a sum is of events that are not disjoint"),
        ("fault tree", "n1_1 = q4 + w4 * n1_0", "n1_1 = q4", "failure of Tree1 is another"),
        ("fault tree", "q1 * n0_0", "q1 * q1", "events that are not independent"),
        ("fault tree", "-0.0001 * until", "-0.0001 * horizon", "it is not as the model says"),
        ("fault tree", "b1 * 0.009", "b1 * 0.008", "the model says 0.00995016"),
        ("fault tree", "b1 * 50.0", "b1 * b1 * 50.0", "it is no sum over the states"),
        ("ready-made", "(0, 1, 1e-05)", "(0, 1, 2e-05)", "arcs 1 3 is 2e-05"),
        ("mission's end", "steps = 256", "steps = 255", "steps is 255, the model says 256"),
    ],
)
def test_differences_are_told(name: str, old: str, new: str, expected: str) -> None:
    model, config, _ = PACKAGES[name]
    (monitor,), _ = monitors_of(ROOT / model, [ROOT / config] if config else [])
    text = monitor.compiled.text
    assert old in text
    _, findings = checked(monitor, text.replace(old, new, 1))
    assert any(expected in finding.text for finding in findings), findings


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("i0 = s[2] * 1\n", "i0 = s[3] * 1\n", "a step gives other probabilities"),
        ("s[3] * 1 + s[0] * 4", "s[3] * 1.0 + s[0] * 4", "a place is no whole number"),
        ("dot(k11, v12, r10)", "dot(k11, v12, k11)", "it has no known form"),
        ("multiply(e4, v5, r3)  # N0", "multiply(e2, v5, r3)  # N0", "it has no known form"),
        ("(9, 4), (0, 2, 3, 5)", "(9, 2), (0, 2, 3, 5)", "it has no known form"),
        (
            '(9, "multiply", 8, 9, 7)',
            '(27, "multiply", 8, 9, 7)',
            "an operation is of another message",
        ),
        ('(2, "multiply", 1, 2, 0)', '(1, "multiply", 1, 2, 0)', "an operation is of no message"),
        ("answers=(24, 40", "answers=(24, 47", "an answer is another message"),
        ("(7,), (3, 7), (), True),  # 5", "(7,), (3, 7), (), False),  # 5", "are missing"),
        (
            "(0.7, 0.2, 0.1),  # s2\n        ),\n    ),\n}",
            "(0.7, 0.1, 0.2),  # s2\n        ),\n    ),\n}",
            "the table of node 7",
        ),
        ("parts=(part_0, part_1)", "parts=(part_1,)", "a part of the network is missing"),
        ("when_observed=(part_2, ", "when_observed=(", "a part of the network is missing"),
    ],
)
def test_differences_in_operations_of_numpy_are_told(
    old: str, new: str, expected: str, tmp_path: Path
) -> None:
    (tmp_path / "net.bif").write_text(MAKERS["bayesian_network"](ARRAYS)["network.bif"], "utf-8")
    (monitor,), _ = monitors_of(tmp_path / "net.bif", [])
    text = monitor.compiled.text
    assert checked(monitor, text)[1] == []
    assert old in text
    _, findings = checked(monitor, text.replace(old, new, 1))
    assert any(expected in finding.text for finding in findings), findings

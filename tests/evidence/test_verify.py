"""`verify` on packages of each kind: no text that computes something else is called proved."""

from __future__ import annotations

import ast
from pathlib import Path
from random import Random

import pytest

from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.packages.verifying import checked
from eddi_scaffold.program.running import module_of
from tests.evidence.mutants import mutants
from tests.frozen.random_models import MAKERS

ROOT = Path(__file__).parents[2]
PACKAGES = {
    "state_machine": ("examples/shuttle/shuttle.xml", "examples/shuttle/shuttle_config.yml", 571),
    "safeml": ("examples/safeml/safeml_config.yml", "examples/safeml/perception_config.yml", 485),
    "network": ("examples/warehouse-robot/localisation.bif", "", 278),
    "fault tree": ("examples/drone/drone.xml", "examples/drone/reliability_config.yml", 274),
    "ready-made": ("examples/warehouse-robot/power.yml", "", 300),
    "rotors": ("examples/drone/airframe.yml", "", 1200),
    "mission end": ("tests/data/reliability/every_key.yml", "", 2400),
    "not coherent": ("tests/data/reliability/not_coherent.yml", "", 294),
}
"""Model, configuration, and how many single mutants its text has."""
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
@pytest.mark.parametrize("name", PACKAGES)
def test_each_statement_is_needed(name: str) -> None:
    model, config, _ = PACKAGES[name]
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
    assert seen > 15
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
        ("network", "(0.9, 0.1)", "(0.8, 0.2)", "{0: (0.9, 0.1)"),
        ("network", "Table((0, 1)", "Table((1, 0)", "tables.Table((0, 1)"),
        ("network", "(0.999, 0.001)", "('0.999', 0.001)", "it has not (9, 2) numbers"),
        ("network", "(0.999, 0.001)", "(0.999, 0.002)", "the model says 0.001"),
        ("fault tree", "q1 * n3", "q1 + n3", "failure of Tree1 is another function"),
        ("fault tree", "w3 = 1.0 - q3", "w3 = 1.0 - q2", "survival of Tree1 is another function"),
        ("fault tree", "n3 = q2 + w2 * n2", "n3 = q2", "failure of Tree1 is another"),
        ("fault tree", "q1 * n3", "q1 * q1", "failure of Tree1 is another function"),
        ("fault tree", "-0.0001 * until", "-0.0001 * horizon", "it is not as the model says"),
        ("fault tree", "b1 * 0.009", "b1 * 0.008", "the model says 0.00995016"),
        ("fault tree", "b1 * 50.0", "b1 * b1 * 50.0", "it is no sum over the states"),
        ("not coherent", "(4, 1, 0)", "(4, 0, 1)", "nodes of Tree0 are of another function"),
        ("fault tree", "n2 = q3", "n2 = q3 + 1e20 - 1e20", "it has no known form"),
        ("fault tree", "n2 = q3", "n2 = 1.0 - w2 * 1.0", "it has no known form"),
        (
            "fault tree",
            '"Rotors": observed',
            '"Rotors": exec(""), "Rotors": observed',
            "two values",
        ),
        ("fault tree", '"""MissionLoss', '# coding: latin-1\n"""MissionLoss', "the encoding"),
        ("fault tree", "import eddi_runtime\n", "import eddi_runtime\nException = 1\n", "a name"),
        ("not coherent", "grows = False", "grows = True", "grows is True, the model says False"),
        ("ready-made", "(0, 1, 0.001)", "(0, 1, 0.002)", "models is {'battery': battery.Battery("),
        ("ready-made", "999.62512", "999.62513", "mean lives of battery 3 is 999.62513"),
    ],
)
def test_differences_are_told(name: str, old: str, new: str, expected: str) -> None:
    model, config, _ = PACKAGES[name]
    (monitor,), _ = monitors_of(ROOT / model, [ROOT / config] if config else [])
    text = monitor.compiled.text
    assert old in text
    _, findings = checked(monitor, text.replace(old, new, 1))
    assert any(expected in finding.text for finding in findings), findings


def test_inputs_of_motors_in_another_order_are_proved(tmp_path: Path) -> None:
    rates = ", ".join(["1e-5 1/h"] * 4)
    model = f"type: propulsion, configuration: PNPN, rates: [{rates}], positions: [1, 0, 2, 3]"
    (tmp_path / "m.yml").write_text(f"horizon: 1 h\nmodels: {{m: {{{model}}}}}\n", "utf-8")
    (monitor,), _ = monitors_of(tmp_path / "m.yml", [])
    assert checked(monitor, monitor.compiled.text)[1] == []


VOTE = """
models:
  t: {type: fault_tree, approximation: cut_sets, gates: {T: {type: VOTE, k: 2, of: [A, B, c]}},
    events: {A: {p: 0.1}, B: {p: 0.1}, c: {model: c}}}
  c: {type: markov, initial: A, fail: B, arcs: [{from: A, to: B, rate: 1 1/h}]}
"""


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("", "", ["there is no Tree1 that is tree.FaultTree"]),
        ("approximation: cut_sets,", "", []),
        ("rate: 1 1/h", "rate: 1e9 1/h", ["the rates of a chain are too high"]),
    ],
)
def test_what_is_not_proved_is_told(
    old: str, new: str, expected: list[str], tmp_path: Path
) -> None:
    (tmp_path / "vote.yml").write_text(VOTE.replace(old, new, 1), "utf-8")
    (monitor,), _ = monitors_of(tmp_path / "vote.yml", [])
    proved, findings = checked(monitor, monitor.compiled.text)
    assert [(of.text, of.differs) for of in findings] == [(text, False) for text in expected]
    assert bool(proved) is not bool(expected)


@pytest.fixture(params=[26, 1], ids=["messages", "independent parts"])
def network(request: pytest.FixtureRequest, tmp_path: Path) -> BoundMonitor:
    text = MAKERS["bayesian_network"](request.param)["network.bif"]
    (tmp_path / "net.bif").write_text(text, "utf-8")
    return monitors_of(tmp_path / "net.bif", [])[0][0]


@pytest.mark.slow
def test_a_mutant_of_a_network_is_seen_or_infers_the_same(
    network: BoundMonitor, request: pytest.FixtureRequest
) -> None:
    text = ast.unparse(ast.parse(network.compiled.text))
    assert checked(network, text)[1] == []
    is_long = request.config.getoption("--hypothesis-profile") == "long"
    draw, about, expected = Random(1), ast.get_docstring(ast.parse(text)), posteriors(text)
    for mutant in mutants(text, lambda _: is_long or draw.random() < 0.1):
        if ast.get_docstring(ast.parse(mutant)) == about and checked(network, mutant)[1] == []:
            assert posteriors(mutant) == pytest.approx(expected, rel=1e-12), mutant


def posteriors(text: str) -> list[float]:
    """Return what a network infers from drawn states and likelihoods."""
    monitor, draw, found = module_of(text, "net").Monitor(), Random(2), list[float]()
    for _ in range(100):
        cards = monitor.engine.missing
        weights = {k: [draw.random() for _ in range(card)] for k, card in enumerate(cards)}
        weights = {k: of for k, of in weights.items() if draw.random() < 0.3}
        states = [card if k in weights else draw.randint(0, card) for k, card in enumerate(cards)]
        found += [p for row in monitor.engine.infer(states, weights) or [[-1.0]] for p in row]
    return found


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("(0, 1, 3), (0, 1, 3), True", "(0, 3), (0, 1, 3), True", "is no sum over its nodes"),
        ("'product', (0, 1)", "'product', (0, 0)", "message 2 is no sum over its nodes"),
        ("part_0_messages, (22, 27)", "part_0_messages, (27, 22)", "are no posteriors"),
        ("0.3888888888888889, 0.33", "0.3888888888888888, 0.33", "the table of node 0 is"),
    ],
)
@pytest.mark.parametrize("network", [26], indirect=True)
def test_differences_of_messages_are_told(
    network: BoundMonitor, old: str, new: str, expected: str
) -> None:
    text = ast.unparse(ast.parse(network.compiled.text))
    assert old in text
    _, findings = checked(network, text.replace(old, new, 1))
    assert any(expected in finding.text for finding in findings), findings

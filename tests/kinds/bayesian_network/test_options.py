"""What a configuration says of a network: wrong values are problems, never tracebacks."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.kinds import kinds
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.platforms.ros1 import monitor_answers
from eddi_scaffold.platforms.ros_packages import messages_of
from tests.kinds.bayesian_network.networks import joined, read_path, running
from tests.kinds.bayesian_network.test_network import EXAMPLE

KEYS = (
    "input", "bins", "closed", "order", "scale", "offset", "map", "sentinel", "range",
    "out_of_range", "allow_inf", "hysteresis", "missing",
)  # fmt: skip
OPTIONS = (
    "outputs", "observed", "evidence_mode", "on_inconsistent", "explain", "renamed", "evidence",
)  # fmt: skip
STATES = ["range_0_to_1_m", "range_1_to_2_m", "more_than_2_m", "unobserved"]
WORDS = [*STATES, "value", "right", "left", "clamp", "hold", "default", "true", "1", "", "Critical"]
SCALARS = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-3, 3),
    st.floats(),
    st.sampled_from([10**400, -(10**400), 2**63]),
    st.sampled_from(WORDS),
)
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.one_of(
        st.lists(inner, max_size=4), st.dictionaries(st.sampled_from(WORDS[:-1]), inner, max_size=3)
    ),
    max_leaves=6,
)
ENTRY = {"input": "value", "bins": [1.0, 2.0], "sentinel": [[-1, STATES[0]]], "range": [0, 30]}
INPUTS = (
    "SimulatorOutputs: [{id: x, type: std_msgs.Float64, topic: /x}]\n"
    "EDDIInputs: [{id: value, requires: [x], max_age: none}]\n"
)


def config(values: dict[str, object]) -> str:
    model = {"id": "net", "type": "BayesianNetwork", **values}
    return yaml.safe_dump({"Model": model}, width=9999) + INPUTS


@given(
    st.dictionaries(st.sampled_from([*KEYS, "bin"]), VALUES, max_size=3),
    st.sets(st.sampled_from(list(ENTRY)), max_size=2),
    st.dictionaries(st.sampled_from(OPTIONS), VALUES, max_size=1),
)
def test_any_values_give_a_monitor_or_problems(
    changed: dict[str, object], gone: set[str], further: dict[str, object]
) -> None:
    entry = {key: value for key, value in ENTRY.items() if key not in gone} | changed
    text = config({"discretisation": {"Distance_to_Pedestrian": entry}, **further})
    monitor, problems = joined(read_path(EXAMPLE / "pedestrian.xml"), text)
    if monitor is None:
        assert any(problem.level == "error" for problem in problems)
        return
    machine = running(monitor)
    for value in (None, 0.5, -1, float("inf"), 1e308, "more_than_2_m", True):
        machine.execute_step(SimpleNamespace(value=value))


NODE = "Distance_to_Pedestrian"
MISTAKES: list[tuple[object, str]] = [
    ([], "B404.declarations"),
    ({"Distance": ENTRY}, "B303.discretised_node"),
    ({NODE: 3}, "B404.declaration"),
    ({NODE: {"bins": [1, 2]}}, "B404.input"),
    ({NODE: {**ENTRY, "input": "valu"}}, "B404.unknown_input"),
    ({NODE: {**ENTRY, "order": "all"}}, "B404.value"),
    ({NODE: {**ENTRY, "order": [STATES[0]] * 3}}, "B404.order_twice"),
    ({NODE: {**ENTRY, "order": [True, *STATES[1:3]]}}, "B404.value"),
    ({NODE: {"input": "value", "map": {"1": True}}}, "B404.state_name"),
    ({NODE: {**ENTRY, "offset": "1"}}, "B404.value"),
    ({NODE: {**ENTRY, "scale": 0}}, "B404.value"),
    ({NODE: {**ENTRY, "range": [3, 1]}}, "B404.value"),
    ({NODE: {**ENTRY, "allow_inf": 1}}, "B404.value"),
    ({NODE: {"input": "value", "map": {}}}, "B404.value"),
    ({NODE: {**ENTRY, "sentinel": -1}}, "B404.value"),
    ({NODE: {**ENTRY, "sentinel": [[-1]]}}, "B404.value"),
]


@pytest.mark.parametrize(("entry", "case"), MISTAKES)
def test_each_mistake_in_a_discretisation_is_reported(entry: object, case: str) -> None:
    text = config({"discretisation": entry})
    monitor, problems = joined(read_path(EXAMPLE / "pedestrian.xml"), text)
    assert monitor is None
    assert {one.place.line is not None for one in problems if one.case == case} == {True}


@pytest.mark.parametrize(
    ("more", "case"),
    [
        ({"hysteresis": 1}, "B404.wide_hysteresis"),
        ({"scale": -2, "range": [-1.25, 0], "hysteresis": 0.5}, "B404.wide_hysteresis"),
        ({"missing": "default"}, "B404.no_default"),
        ({"hysteresis": 0.9}, None),
    ],
)
def test_what_is_not_meant_so_is_a_warning(more: dict[str, object], case: str | None) -> None:
    text = config({"discretisation": {NODE: {**ENTRY, **more}}})
    monitor, problems = joined(read_path(EXAMPLE / "pedestrian.xml"), text)
    assert monitor is not None
    found = [(one.level, one.case) for one in problems if one.code in ("B404", "D009")]
    assert found == ([("warning", case)] if case else [])


@pytest.mark.parametrize(("type_", "wrong"), [("int", 0), ("str", 0), ("bool", 2)])
def test_keys_of_a_map_are_of_the_type_of_the_input(type_: str, wrong: int) -> None:
    entry = {"input": "value", "map": {"1": STATES[0], "2": STATES[1]}}
    text = config({"discretisation": {NODE: entry}})
    text = text.replace("id: value,", f"id: value, type: {type_},")
    _, problems = joined(read_path(EXAMPLE / "pedestrian.xml"), text)
    assert [problem.case for problem in problems].count("B404.map_type") == wrong


THRESHOLD = {"id": "Low", "node": "Critical", "state": "Yes", "at_most": 0.3, "hold": "1 s"}


@given(
    st.dictionaries(st.sampled_from([*THRESHOLD, "at_least", "release", "topic"]), VALUES),
    st.sets(st.sampled_from(list(THRESHOLD)), max_size=2),
)
def test_any_evidence_gives_a_monitor_or_problems(
    changed: dict[str, object], gone: set[str]
) -> None:
    entry = {key: value for key, value in THRESHOLD.items() if key not in gone} | changed
    text = config({"discretisation": {"Distance_to_Pedestrian": ENTRY}, "evidence": [entry]})
    monitor, problems = joined(read_path(EXAMPLE / "pedestrian.xml"), text)
    if monitor is None:
        assert any(problem.level == "error" for problem in problems)
        return
    machine = running(monitor)
    machine.execute_step(SimpleNamespace(value=0.5), 0)
    (claim,) = machine.claims()
    assert claim.low <= claim.high


LOW = '{id: RiskIsLow, node: Critical, state: "Yes", at_most: 0.3, hold: 1 s, topic: risk_is_low}'
MORE = "{id: Safe, node: Critical, state: ['No'], at_least: 0.8, release: 0.75}"


def pedestrian(folder: Path, evidence: str = "", outputs: str = "") -> BoundMonitor:
    text = (EXAMPLE / "eddi_config.yml").read_text("utf-8")
    section = f"  evidence: [{evidence}]\n" if evidence else ""
    config = folder / "c.yml"
    config.write_text(
        text.replace("SimulatorOutputs:", f"{section}SimulatorOutputs:").rstrip() + outputs, "utf-8"
    )
    (monitor,), problems = monitors_of(EXAMPLE / "pedestrian.xml", [config])
    assert [problem.code for problem in problems] == []
    return monitor


def test_evidence_has_a_topic_and_a_message_of_its_own(tmp_path: Path) -> None:
    package, problems = monitor_answers(pedestrian(tmp_path, f"{LOW}, {MORE}"))
    assert problems == []
    result, companion, alone = package.answers["publications"]
    assert (result["topic"], result["status_topic"]) == (
        "'pedestrian/risk'", "'pedestrian/risk/status'",
    )  # fmt: skip
    assert (companion["topic"], companion["more"].strip()) == (
        "'pedestrian/risk/evidence'", "of='evidence',",
    )  # fmt: skip
    assert companion["type_text"] == "eddi_messages/BayesianNetworkEvidence"
    assert (alone["topic"], alone["type_text"]) == ("'risk_is_low'", "std_msgs/Bool")
    assert "('evidence', ('id', 'RiskIsLow'), 'active',)" in alone["more"]


def test_people_are_told_what_evidence_asks_for(tmp_path: Path) -> None:
    monitor = pedestrian(tmp_path, f"{LOW}, {MORE}")
    texts = [
        "P(Critical = Yes) <= 0.3 for 1 s, gone above 0.3, on risk_is_low",
        "P(Critical = No) >= 0.8, gone below 0.75",
    ]
    lines = monitor.model.outline()
    assert lines[-2:] == [f"evidence RiskIsLow: {texts[0]}", f"evidence Safe: {texts[1]}"]
    readme = monitor.model.readme()
    assert readme[-2:] == [f"| `RiskIsLow` | {texts[0]} |", f"| `Safe` | {texts[1]} |"]
    assert monitor.model.element_keys()["evidence"] == ["RiskIsLow", "Safe"]


def test_every_message_beside_a_result_has_a_method_and_a_definition(tmp_path: Path) -> None:
    monitor = pedestrian(tmp_path, f"{LOW}, {MORE}")
    machine = running(monitor)
    machine.execute_step(SimpleNamespace(), 0)
    texts = messages_of({"net": {"kind": "bayesian_network", "config": None}})
    for name, message in monitor.model.companion_messages().items():
        tree = getattr(machine, f"{name}_message")()
        assert tree[0] == message
        check_fields(tree, texts)


def check_fields(tree: Any, texts: dict[str, str]) -> None:
    name, fields = tree
    lines = [line.split() for line in texts[name].splitlines() if not line.startswith("#")]
    names = [line[1] for line in lines if line and "=" not in line[1]]
    assert sorted(fields) == sorted(set(names) - {"header"})
    for value in fields.values():
        for one in value if isinstance(value, list) else ():
            if isinstance(one, tuple):
                check_fields(one, texts)


def test_two_kinds_have_no_message_of_one_name() -> None:
    names = [name for kind in kinds().values() for name in kind.messages]
    assert len(names) == len(set(names))


def test_the_order_of_discretised_nodes_decides_nothing() -> None:
    """The answers of a package sort them, and `run` makes its monitor of these."""
    speed = "AV_Shuttle_Speed: {input: value, bins: [0.05, 2.0, 4.0]}"
    distance = "Distance_to_Pedestrian: {input: value, bins: [1.0, 2.0]}"
    model = read_path(EXAMPLE / "pedestrian.xml")
    digests = set()
    for first, second in ((speed, distance), (distance, speed)):
        text = f"Model: {{id: net, type: BayesianNetwork, discretisation: {{{first}, {second}}}}}\n"
        monitor, _ = joined(model, text + INPUTS)
        assert monitor is not None
        digests.add(monitor.facts.digest)
    assert len(digests) == 1


def test_methods_may_observe_what_is_named_else_all_that_is_no_output() -> None:
    model = read_path(EXAMPLE / "pedestrian.xml")
    for values, expected in (
        ({}, ("AV_Shuttle_Speed", "Distance_to_Pedestrian")),
        ({"observed": ["AV_Shuttle_Speed"]}, ("AV_Shuttle_Speed",)),
    ):
        monitor, _ = joined(model, config(values))
        assert monitor is not None
        settings = monitor.model.settings  # type: ignore[attr-defined]
        assert (settings.outputs, settings.observable) == (("Critical",), expected)
        assert running(monitor).engine.observable == tuple(range(len(expected)))

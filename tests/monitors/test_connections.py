"""Monitors that feed each other."""

from __future__ import annotations

from pathlib import Path

import pytest

from eddi_scaffold.config.reading import read_config
from eddi_scaffold.deployments.checking import check_files
from eddi_scaffold.monitors.connections import check_neighbours
from eddi_scaffold.source import Source
from tests.checkouts import HERE

PROVIDER = b"""
Model: {id: B, type: ConSert, frequency: 2}
EDDIOutputs: [{id: b, topic: /b/guarantees}]
"""
STATUS = ("ConSertOutput, topic: /b/guarantees", "ConSertStatus, topic: /b/guarantees/status")
CONSUMER = """
Model: {{id: A, type: ConSert}}
SimulatorOutputs: [{{id: b, type: eddi_messages.ConSertOutput, topic: /b/guarantees}}]
EDDIInputs:
- {{id: D, requires: [b], max_age: {max_age}}}
"""


def found(max_age: str, consumer: str = CONSUMER) -> list[str]:
    configs = []
    for name, data in (("b.yml", PROVIDER), ("a.yml", consumer.format(max_age=max_age).encode())):
        config, problems = read_config(Source(name, data))
        assert config is not None, problems
        configs.append(config)
    return [f"{p.place.line}:{p.code}: {p.message}" for p in check_neighbours(configs)]


def test_an_age_below_two_periods_of_the_provider_is_a_warning() -> None:
    assert found("0.5") == [
        "5:K029: input 'D' is unknown after 0.5 s, but B publishes only every 0.5 s"
    ]


def test_the_status_of_a_monitor_comes_as_often_as_its_result() -> None:
    assert found("0.5", CONSUMER.replace(*STATUS)) == found("0.5")
    of_a_sensor = CONSUMER.replace(STATUS[0], "ConSertStatus, topic: /b/guarantees/status")
    assert found("0.5", of_a_sensor.replace("eddi_messages.ConSertStatus", "std_msgs.Bool")) == []


def test_an_age_in_milliseconds_is_a_warning() -> None:
    text = "counts as known for 500 s after its source has died: `max_age` is in seconds"
    assert found("500") == [f"5:K029: 'D' {text}"]
    source = CONSUMER.replace("/b/guarantees}}", "/b/guarantees, max_age: 500}}")
    assert found("5", source) == [f"3:K029: 'b' {text}"]
    assert found("99") == []


@pytest.mark.parametrize("max_age", ["1.0", "none", "null"])
def test_longer_and_absent_ages_are_fine(max_age: str) -> None:
    assert found(max_age) == []


ROVER = HERE / "examples" / "rover-events"
NETWORK = HERE / "examples" / "pedestrian"


TITLE = "risk.output_nodes[Critcal].outcomes[x].outcome_value"
OUTCOME = "risk.output_nodes[Critical].outcomes[hihg].outcome_value"


@pytest.mark.parametrize(
    ("entry", "wanted"),
    [
        (f"expression: {OUTCOME} < 0.1", f"'{OUTCOME}': PedestrianRisk publishes no 'hihg'"),
        (f"expression: {TITLE} < 0.1", f"'{TITLE}': PedestrianRisk publishes no 'Critcal'"),
    ],
)
def test_keys_that_the_network_beside_does_not_have(
    tmp_path: Path, entry: str, wanted: str
) -> None:
    config = tmp_path / "rover.yml"
    config.write_text(
        f"""Model: {{id: Rover, type: ConSert}}
SimulatorOutputs:
  - {{id: risk, type: eddi_messages.BayesianNetworkOutput, topic: /pedestrian/risk, max_age: 1}}
EDDIInputs:
  - id: MotorIsCool
    {entry}
EDDIOutputs: [{{id: rover, topic: /rover/guarantees}}]
""",
        "utf-8",
    )
    network = tmp_path / "network.yml"
    text = (NETWORK / "eddi_config.yml").read_text("utf-8")
    network.write_text(text.replace("pedestrian_prediction_example", "PedestrianRisk"), "utf-8")
    names = (NETWORK / "pedestrian.xml", network, ROVER / "Rover.yml", config)
    problems = check_files(names)
    (problem,) = [one for one in problems if one.code == "K047"]
    assert (problem.message, problem.place.line) == (wanted, 6)


@pytest.mark.parametrize(
    ("field", "hint"),
    [
        ("output_nodes[Criticl].outcomes[Yes].outcome_value", "Critical"),
        ("output_nodes[Critical].outcomes[Yess].outcome_value", "Yes"),
    ],
)
def test_an_output_of_what_the_network_does_not_have(tmp_path: Path, field: str, hint: str) -> None:
    network = tmp_path / "network.yml"
    text = (NETWORK / "eddi_config.yml").read_text("utf-8")
    network.write_text(f"{text}  - {{id: one, topic: one, field: '{field}'}}\n", "utf-8")
    problems = check_files((NETWORK / "pedestrian.xml", network))
    (problem,) = [one for one in problems if one.code == "K047"]
    assert problem.hint == f"did you mean {hint!r}?"
    assert problem.place.line == len(text.splitlines()) + 1

"""What a configuration says of a state machine."""

from typing import Any

import pytest

from eddi_scaffold.common.problems import Problem
from eddi_scaffold.kinds.state_machine.state_machine_model import StateMachineModel
from tests.data_files import tabled
from tests.kinds.state_machine.machines import DATA, machine_of, options_of

INPUTS = {"dirt": "float", "charge": None, "fault": "bool", "order": "bool", "slow": "bool"}


def configured(
    file: str, values: dict[str, Any], inputs: dict[str, Any] = INPUTS
) -> tuple[StateMachineModel | None, list[Problem]]:
    return machine_of(DATA / file).configure(options_of(values, inputs, 10.0))


def how(model: StateMachineModel) -> dict[str, str]:
    pairs = zip(model.data.triggers, model.settings.values, strict=True)
    return {trigger.text: value.how for trigger, value in pairs}


@tabled
def test_what_cannot_be_meant_is_an_error(values: dict[str, Any], case: str) -> None:
    model, problems = configured("shuttle.emf.xml", values)
    assert model is None
    assert case in [problem.case for problem in problems if problem.level == "error"]


def test_the_configuration_goes_before_what_the_file_says() -> None:
    triggers = {"No_flow": "fault", "both pumps confirmed": {"expression": "NOT fault"}}
    model, problems = configured("pumps.emf.xml", {"triggers": triggers})
    assert model is not None
    assert [problem.case for problem in problems] == ["P004.no_return"]
    assert how(model)["No_flow"] == "the condition fault"
    names = ["Plant_PumpA_stopped", "Plant_PumpB_stopped", "fault"]
    assert sorted(one.id for one in model.inputs()) == names


def test_a_text_whose_every_name_is_an_input_is_a_condition() -> None:
    model, _ = configured("gate.emf.xml", {}, {"limit.open": "bool", "motor.overcurrent": "bool"})
    assert model is not None
    assert how(model)["limit.open"] == how(model)["motor.overcurrent"] == "a condition"
    assert how(model)["limit.closed"] == "the input limit_closed"
    assert [one.id for one in model.inputs() if one.every_message] == [
        "open_request",
        "close_request",
    ]


def test_types_follow_from_the_use() -> None:
    triggers = {"Shuttle::Battery.low": "charge < 0.2", "Shuttle::Drive.fault": "fault"}
    model, _ = configured("shuttle.emf.xml", {"triggers": triggers})
    assert model is not None
    assert {one.id: one.type for one in model.inputs()}["charge"] == "float"
    again = {**triggers, "Shuttle::Lidar.dirty": "charge"}  # no number there
    assert configured("shuttle.emf.xml", {"triggers": again})[0] is None


def test_a_transition_without_a_trigger_gets_one() -> None:
    model, _ = configured("gate.emf.xml", {"transitions": {"opens too slowly": "fault"}})
    assert model is not None
    (transition,) = (t for t in model.data.transitions if t.name == "opens too slowly")
    assert [trigger.text for trigger in transition.triggers] == ["transition opens too slowly"]


@pytest.mark.parametrize(
    ("entry", "states", "hold"),
    [
        ({"not_in": "fail_states"}, ("Ready", "Slow"), 0.0),
        ({"in": "Ready", "hold": "2 s"}, ("Ready",), 2.0),
        ({"not_in": ["Ready", "Halted"]}, ("Slow", "Secured"), 0.0),
    ],
)
def test_evidence_is_a_list_of_states(
    entry: dict[str, Any], states: tuple[str, ...], hold: float
) -> None:
    values = {"start": "unknown", "evidence": [{"id": "E", **entry}]}
    model, _ = configured("shuttle.emf.xml", values)
    assert model is not None
    (evidence,) = model.settings.evidence
    assert (evidence.states, evidence.hold) == (states, hold)


def test_an_order_is_read_message_by_message() -> None:
    model, _ = configured("shuttle.emf.xml", {"reset": "order"})
    assert model is not None
    assert {one.id for one in model.inputs() if one.every_message} == {"order", "operator_release"}
    model, _ = configured("shuttle.emf.xml", {"reset": "order AND fault"})
    assert model is not None
    assert {one.id for one in model.inputs() if one.every_message} == {"operator_release"}


def test_what_is_accepted_has_a_place() -> None:
    triggers = {"Shuttle::Drive.fault": {"absent": True}}
    model, _ = configured("shuttle.emf.xml", {"start": "initial", "triggers": triggers})
    assert model is not None
    assert [(one.key, one.path[-1]) for one in model.acceptances((), 10.0)] == [
        ("start: initial", "start"),
        ("absent: true", "Shuttle::Drive.fault"),
    ]

"""What is read of an EDDI: states, transitions, triggers and what they mean, actions."""

from typing import Any

import pytest
import yaml

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import EddiError, Problem
from eddi_scaffold.kinds import Options
from eddi_scaffold.kinds.state_machine import KIND
from eddi_scaffold.kinds.state_machine.machine import Action, StateMachine
from eddi_scaffold.kinds.state_machine.state_machine_model import StateMachineModel
from eddi_scaffold.monitors.compiling import digest_of
from eddi_scaffold.monitors.loading import read_models
from tests.data_files import tabled
from tests.kinds.state_machine.machines import DATA, machine_of

MODELS = {
    model["name"]: model
    for model in yaml.load((DATA / "models.yml").read_text("utf-8"), yaml.CSafeLoader)["models"]
}


def plain_action(action: Action) -> dict[str, Any]:
    row: dict[str, Any] = {"kind": action.kind, "text": action.text, "type": action.type}
    row |= {"source": action.source, "level": action.priority}
    return {key: value for key, value in row.items() if value}


def plain(machine: StateMachine) -> dict[str, Any]:
    """Return a machine as `models.yml` has it."""
    states = []
    for state in machine.states:
        row: dict[str, Any] = {"name": state.name}
        row |= {"initial": state.is_initial, "fail": state.is_fail}
        row |= {
            "entry": [*map(plain_action, state.entry)],
            "exit": [*map(plain_action, state.exit)],
        }
        states.append({key: value for key, value in row.items() if value})
    transitions = []
    for each in machine.transitions:
        row = {"name": each.name, "from": each.source, "to": each.target}
        row |= {"triggers": [trigger.text for trigger in each.triggers]}
        row |= {"priority": each.priority or None, "after": each.after}
        transitions.append({key: value for key, value in row.items() if value is not None})
    triggers = {}
    for trigger in machine.triggers:
        is_raised = trigger.text in machine.raised and trigger.text not in machine.causes
        flags = {"persistent": trigger.is_persistent, "momentary": trigger.is_external}
        flags = {key: True for key, value in {**flags, "raised": is_raised}.items() if value}
        triggers |= {trigger.text: flags} if flags else {}
    return {
        "name": machine.name,
        "states": states,
        "transitions": transitions,
        "triggers": triggers,
    }


@pytest.mark.parametrize("name", MODELS)
def test_it_reads_the_emf_form(name: str) -> None:
    machine, wanted = machine_of(DATA / f"{name}.emf.xml").data, MODELS[name]
    flags = ("persistent", "momentary", "raised")
    triggers = {
        text: {key: value for key, value in of.items() if key in flags}
        for text, of in wanted.get("triggers", {}).items()
    }
    keys = {key: wanted[key] for key in ("name", "states", "transitions")}
    assert plain(machine) == {**keys, "triggers": triggers}


def test_causes_are_those_of_the_fault_tree() -> None:
    machine = machine_of(DATA / "pumps.emf.xml").data
    own = ("Plant::PumpA.stopped", "Plant::PumpB.stopped", "No_flow")
    assert machine.causes == {text: text for text in own}
    gates = {name: [gate.type, list(gate.of)] for name, gate in machine.gates.items()}
    assert gates == MODELS["pumps"]["causes"]
    assert "the warning of" in machine.resolved["No_flow"]
    assert "the cause" in machine.resolved["Plant::PumpB.stopped"]


@pytest.mark.parametrize("name", MODELS)
def test_a_package_keeps_the_same_machine(name: str) -> None:
    model = machine_of(DATA / f"{name}.emf.xml")
    ((file, text),) = model.write().items()
    (again,) = read_models(Source(f"there/{file}", text.encode())).models
    digests = []
    for each in (model, again):
        configured, _ = each.configure(Options())
        digests.append(digest_of("state_machine", configured, ()))
    assert digests[0] == digests[1]


def changed(file: str, *pairs: list[str]) -> tuple[StateMachineModel | None, list[Problem]]:
    text = (DATA / file).read_text("utf-8")
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new, 1)
    reading = read_models(Source(f"a/{file}", text.encode()))
    models = [model for model in reading.models if isinstance(model, StateMachineModel)]
    problems = [problem for model in models for problem in model.check()]
    return models[0] if models else None, [*reading.problems, *problems]


@tabled
def test_what_is_wrong_is_told_at_its_line(
    file: str, old: str, new: str, case: str, line: int
) -> None:
    _, problems = changed(file, [old, new])
    assert (case, line) in [(problem.case, problem.place.line) for problem in problems]


def test_a_text_of_several_conditions_is_several_triggers() -> None:
    text = 'condition="Shuttle::Lidar.dirty"'
    model, _ = changed("shuttle.emf.xml", [text, 'condition="dirty; wet "'])
    assert model is not None
    first = model.data.transitions[0]
    assert [trigger.text for trigger in first.triggers] == ["dirty", "wet", "Shuttle::Battery.low"]


def test_a_gate_that_depends_on_an_order_needs_a_condition() -> None:
    model, _ = changed("pumps.emf.xml", ['gateType="AND"', 'gateType="PAND"'])
    assert model is not None
    assert [problem.case for problem in model.configure(Options())[1]] == ["P003.gate"]
    bound = Options(values={"triggers": {"No_flow": "Plant_PumpA_stopped"}})
    assert model.configure(bound)[1] == []


def test_what_is_not_read_is_told() -> None:
    action = 'function="limit_speed"'
    _, problems = changed("shuttle.emf.xml", [action, f'{action} prerequisites="//@nothing"'])
    told = [problem.message for problem in problems if problem.case == "X014.feature"]
    assert told == ['prerequisites of failureLogic_:FunctionAction "limit_speed" not used']
    other = ["failureLogic_:FunctionAction", "failureLogic_:RosAction"]
    model, problems = changed("shuttle.emf.xml", other)
    assert model is not None
    assert [action.text for action in model.data.state["Slow"].entry] == ["reduced speed"]
    assert "X014.feature" in [problem.case for problem in problems]


def test_a_fleet_shows_what_a_machine_claims() -> None:
    class Row:
        id, active = "NotFailed", True

    class Output:
        id, state, possible, failed = "shuttle", "", ["Ready", "Slow"], 0
        unknown_inputs, reason, evidence, accepted = [], "", [Row], ["x"]

    reading = KIND.verdicts["StateMachineOutput"](Output)
    rows = [(verdict.id, verdict.state, verdict.text) for verdict in reading.verdicts]
    assert rows == [("not failed", "active", "in Ready or Slow"), ("NotFailed", "active", "")]


def test_text_that_is_no_utf_8_is_not_kept() -> None:
    data = (DATA / "shuttle.emf.xml").read_bytes().replace(b"UTF-8", b"ISO-8859-1", 1)
    source = Source("s.xml", data.replace(b'name="Slow"', b'name="Tr\xe4ge"'))
    (model,) = read_models(source).models
    with pytest.raises(EddiError) as refused:
        model.write()
    assert [problem.case for problem in refused.value.problems] == ["X001.encoding"]


def test_json_without_names_is_told_by_ends_and_functions() -> None:
    states = '"states": [{"name": "A", "onentry": [{"function": "go"}]}]'
    transitions = '"transitions": [{"from": "A", "to": "A", "trigger": "again"}]'
    (model,) = read_models(Source("m.json", f"{{{states}, {transitions}}}".encode())).models
    assert {(linked.id, linked.links[0].name) for linked in model.links.values()} == {
        ("A", "go"),
        ("A -> A", "Condition=again (again)"),
    }

"""The monitor of a state machine: what is silent, what is due, why it claims nothing."""

from __future__ import annotations

import json
import logging
import math
from types import SimpleNamespace

import pytest
from eddi_runtime.history import EDDIInputBase
from eddi_runtime.inputs import UNDECIDED, InputState

from .machines import SECOND, models, monitor

DIRTY, LOW = "Shuttle::Lidar.dirty", "Shuttle::Battery.low"
FAULT, CLEANED = "Shuttle::Drive.fault", "Shuttle::Lidar.cleaned"
QUIET = {DIRTY: False, LOW: False, FAULT: False, CLEANED: False}
CONFIG = {
    "period": 1.0,
    "evidence": [
        {"id": "NotFailed", "not_in": ["Halted", "Secured"]},
        {"id": "FullSpeed", "in": ["Ready"], "hold": 2},
    ],
}


class Actions:
    def __init__(self):
        self.calls = []

    def action_limit_speed(self, call):
        self.calls.append((call.moment, call.state, call.function))

    def action_restore_speed(self, call):
        self.calls.append((call.moment, call.state, call.function))
        if len(self.calls) < 3:
            raise ValueError("no motor")


LINE = Actions.action_restore_speed.__code__.co_firstlineno + 3


class Robot:
    """A shuttle whose topics are its inputs; a message is old after 0.5 s."""

    def __init__(self, model="shuttle", actions=None, **config):
        self.monitor = monitor(models()[model], {**CONFIG, **config}, actions, 0.5)
        specs = self.monitor.inputs
        self.monitor.topics = {spec.id: f"/{spec.id.rpartition('.')[2]}" for spec in specs}
        self.source = Inputs(specs)

    def step(self, second, *lists, **values):
        messages = {}
        for given in (*lists, values):
            messages.update((k, SimpleNamespace(data=value)) for k, value in given.items())
        t = round(second * SECOND)
        self.source.processing(messages, t)
        return self.monitor.execute_step(self.source, t)

    def why(self, claim):
        return self.monitor.why()[claim].sentence


class Inputs(EDDIInputBase):
    def __init__(self, specs):
        super().__init__(specs)
        self.specs = specs

    def processing(self, messages, t_ns=None):
        self.begin_processing(t_ns)
        for spec in self.specs:
            update = self.update_each if spec.every_message else self.update
            name = spec.attribute
            update(
                spec.id, lambda one, name=name: setattr(self, name, one.data), messages, [spec.id]
            )
        self.end_step()


def test_nothing_is_claimed_before_all_inputs_have_come():
    robot = Robot()
    output = robot.step(0)
    assert (output.state, output.failed, output.reasons) == ("Ready", 1, ("waiting",))
    assert not any(output.evidence.values())
    assert set(output.in_state.values()) == {1}
    assert FAULT in output.unknown_inputs
    assert robot.why("NotFailed").startswith(f"NotFailed <- {LOW} <- /low: no message yet, 0.0 s")
    output = robot.step(1, {FAULT: True})
    assert (output.state, output.failed, output.reasons) == ("Halted", 2, ("waiting",))
    assert robot.why("failed") == f"failed: in Halted for 0.0 s, because {FAULT}"
    output = robot.step(2, QUIET, reset=True)
    assert (output.state, output.failed, output.evidence["NotFailed"]) == ("Ready", 0, True)


def test_a_silent_input_takes_claims_away_and_nothing_of_itself_brings_them_back():
    robot = Robot()
    for second in range(4):
        output = robot.step(second, QUIET)
    assert output.evidence == {"NotFailed": True, "FullSpeed": True}
    silent = {k: value for k, value in QUIET.items() if k != FAULT}
    output = robot.step(4, silent)
    assert (output.possible, output.failed) == (("Ready", "Halted"), 1)
    assert output.evidence == {"NotFailed": False, "FullSpeed": False}
    assert robot.monitor.series(output)["state"] == "Ready or Halted"
    text = "no message yet, 4.0 s after the start (perhaps in Halted for 0.0 s)"
    assert robot.why("NotFailed") == f"NotFailed <- {FAULT} <- /fault: {text}"
    output = robot.step(5, QUIET)
    assert output.possible == ("Ready", "Halted", "Secured")
    reason = f"perhaps in Halted for 1.0 s, because {FAULT} was not known"
    assert robot.why("NotFailed").startswith(f"NotFailed: {reason}; perhaps in Secured for 0.0 s")
    output = robot.step(6, QUIET, reset=True)
    assert (output.state, output.evidence["NotFailed"]) == ("Ready", True)


@pytest.mark.parametrize(
    ("start", "possible"),
    [("initial", ("Secured",)), ("unknown", ("Ready", "Halted", "Secured"))],
)
def test_a_condition_that_resets_and_has_not_come_is_waited_for(start, possible):
    robot = Robot(level_reset=True, start=start)
    robot.step(0, QUIET, {FAULT: True})
    output = robot.step(1, QUIET)
    assert output.possible == possible
    assert 2 not in output.in_state.values()
    assert robot.step(2, QUIET, reset=True).state == "Ready"


def test_messages_that_grow_old_are_unknown():
    robot = Robot()
    t, messages = 0, {k: SimpleNamespace(data=value) for k, value in QUIET.items()}
    for _ in range(2):
        robot.source.processing(messages, t)
        output = robot.monitor.execute_step(robot.source, t)
        t += SECOND
    assert output.possible == ("Ready", "Slow", "Halted")
    assert "nothing for 1.0 s, limit 0.5 s" in robot.why("NotFailed")


def test_why_a_state_is_not_that_of_a_claim():
    robot = Robot()
    robot.step(0, QUIET)
    assert robot.why("FullSpeed") == "FullSpeed: good for 0.0 s of 2 s"
    robot.step(1, QUIET, {DIRTY: True})
    robot.step(2, QUIET)
    for claim in ("FullSpeed", "Ready"):
        assert robot.why(claim) == f"{claim}: in Slow for 1.0 s, because {DIRTY}"
    assert robot.monitor.why()["FullSpeed"].verdict == 0
    assert robot.why("failed") == robot.why("Slow") == ""
    robot.step(3, QUIET, {FAULT: True})
    assert robot.why("failed") == f"failed: in Halted for 0.0 s, because {FAULT}"


def test_a_timeout_is_a_reason():
    robot = Robot("gate", max_gap=20, evidence=[{"id": "Fine", "not_in": ["Jammed"]}])
    quiet = dict.fromkeys(
        ["limit.open", "limit.closed", "obstacle.seen", "motor.overcurrent"], False
    )
    robot.step(0, quiet)
    robot.step(1, quiet, {"open request": True})
    robot.step(9, quiet)
    assert robot.why("Fine") == "Fine: in Jammed for 0.0 s, because it was 8 s in Opening"


def test_without_a_time_and_where_the_clock_stands_nothing_moves_and_silence_shows():
    robot = Robot()
    robot.step(0, QUIET)
    output = robot.monitor.execute_step(SimpleNamespace(**QUIET), 0.5)
    assert (output.possible, output.failed, output.reasons) == (("Ready",), 1, ("time",))
    output = robot.step(0, QUIET, {DIRTY: True})
    assert (output.state, output.evidence["NotFailed"]) == ("Ready", True)
    output = robot.monitor.execute_step(object(), 0)
    assert (output.reasons, output.evidence["NotFailed"]) == (("clock",), False)
    assert robot.why("NotFailed") == "NotFailed: the clock stands, or went back"
    assert robot.step(1, QUIET, {DIRTY: True}).state == "Slow"


def test_an_event_between_two_steps_of_one_time_is_not_lost():
    robot = Robot()
    for second in (0, 1, 2):
        output = robot.step(second, QUIET, {FAULT: second == 0})
    assert output.state == "Secured"
    release = "operator release"
    assert robot.step(2, QUIET, {release: True}).state == "Secured"
    assert robot.step(3, QUIET).state == "Ready"
    assert f"{release}: max_age: none" in robot.monitor.accepted()
    assert release not in robot.step(4, QUIET).unknown_inputs


def test_events_may_be_lost_in_a_step_that_knows_nothing():
    robot = Robot(start="unknown", evidence=[])
    release = "operator release"
    robot.step(0, QUIET, {FAULT: True, release: False}, reset=True)
    robot.step(1, QUIET)
    assert robot.monitor.execute_step(object(), 2 * SECOND).possible[:2] == ("Ready", "Slow")
    assert release in robot.monitor.execute_step(object(), 3 * SECOND).unknown_inputs


class Hostile:
    def __getattribute__(self, name):
        raise RuntimeError(name)


NO_VALUES = (None, math.nan, object(), [], "x", 1, Hostile())


@pytest.mark.parametrize("number", range(len(NO_VALUES)))
def test_what_is_no_truth_value_is_unknown(number):
    value = NO_VALUES[number]
    made = monitor(models()["shuttle"], CONFIG)
    made.execute_step(SimpleNamespace(**QUIET), 0)
    output = made.execute_step(SimpleNamespace(**{**QUIET, FAULT: value}), SECOND)
    assert output.possible == ("Ready", "Halted")
    for one in (Hostile(), object(), None):
        assert made.execute_step(one, 2 * SECOND).failed == 1
        assert made.message(one)[1]["failed"] == 1
    assert made.output_faults() == ("the output is no result of this monitor",)


def test_functions_are_called_once_and_only_when_they_are_certain(caplog):
    actions = Actions()
    robot = Robot(actions=actions)
    robot.step(0, QUIET)
    robot.step(1, {**QUIET, DIRTY: None})
    assert actions.calls == []
    assert [row.message for row in caplog.records] == [
        "perhaps reduced speed (entry Slow, priority 2)"
    ]
    for second in (2, 3):
        output = robot.step(second, QUIET, {DIRTY: True})
    assert actions.calls == [("entry", "Slow", "limit_speed")]
    assert output.raised == ()
    assert robot.monitor.output_faults() == ()


def test_what_a_function_raises_is_told_until_it_succeeds(caplog):
    robot = Robot(actions=Actions())
    for second, given in enumerate([{}, {DIRTY: True}, {CLEANED: True}]):
        robot.step(second, QUIET, given)
    name = "action_restore_speed"
    reason = f"{name} raised ValueError in {__file__.rpartition('/')[2]} line {LINE}"
    assert robot.monitor.output_faults() == (f"{reason} (1 so far)",)
    (error,) = [row.message for row in caplog.records if row.levelno == logging.ERROR]
    assert error.startswith(f"{name}: {reason}\nTraceback")
    for second, given in enumerate([{DIRTY: True}, {CLEANED: True}], 3):
        robot.step(second, QUIET, given)
    assert robot.monitor.output_faults() == ()


def test_who_publishes_calls_functions_afterwards():
    actions, told = Actions(), []
    robot = Robot(actions=actions)
    robot.monitor.deferred = True
    for second, given in enumerate([{}, {DIRTY: True}, {CLEANED: True}]):
        robot.step(second, QUIET, given)
    assert actions.calls == []
    robot.monitor.published(told.append, lambda *row: told.append(row[:2]))
    assert [state for _, state, _ in actions.calls] == ["Slow", "Slow"]
    assert told[0] == "reduced speed (entry Slow, priority 2)"
    due = ["limit_speed is due (entry Slow)", "restore_speed is due (exit Slow)"]
    assert told[1:3] == due
    assert told[3][0] == "action_restore_speed"


def test_a_function_of_a_target_without_a_method():
    robot = Robot("pumps", actions=object(), evidence=[])
    output = robot.step(0, {"Plant::PumpA.stopped": True})
    (one,) = output.raised
    assert (one.target, one.function, one.certain) == ("Pump B", "take over all flow", True)
    (fault,) = robot.monitor.output_faults()
    assert fault.startswith("action_Pump_B_take_over_all_flow raised AttributeError")


def test_a_trigger_whose_windows_fill_since_the_start_is_not_yet_true():
    made = monitor(models()["shuttle"], CONFIG)
    states = {DIRTY: InputState("invalid", UNDECIDED)}
    source = SimpleNamespace(**{**QUIET, DIRTY: None}, states=states)
    assert made.execute_step(source, 0).reasons == ("waiting",)
    assert made.execute_step(source, SECOND).possible == ("Ready",)
    states.clear()
    assert made.execute_step(SimpleNamespace(**QUIET), 2 * SECOND).reasons == ()
    output = made.execute_step(SimpleNamespace(**{**QUIET, DIRTY: None}), 3 * SECOND)
    assert output.possible == ("Ready", "Slow")  # known once, it is not waited for any more


@pytest.mark.parametrize(("passed", "possible"), [(1, ["Ready"]), (4, ["Ready", "Slow"])])
def test_a_condition_that_fills_anew_after_a_gap_is_unknown(passed, possible):
    made = monitor(models()["shuttle"], {**CONFIG, "max_gap": 2.5, "start": "initial"})
    verdicts = made.step
    made.step = lambda source, t: (*verdicts(source, t)[:3], 1, *verdicts(source, t)[4:])
    assert made.triggers[3].text == DIRTY
    assert made.execute_step(SimpleNamespace(**QUIET), 0).reasons == ("waiting",)
    output = made.execute_step(SimpleNamespace(**QUIET, reset=passed > 2), passed * SECOND)
    assert [*output.possible] == possible


def test_what_is_accepted():
    robot = Robot(absent=[DIRTY])
    orders = ("operator release: max_age: none", "reset: max_age: none")
    robot.step(0, QUIET)
    assert robot.monitor.accepted() == orders
    output = robot.step(1, {**QUIET, DIRTY: None})
    assert output.state == "Ready"
    assert robot.monitor.accepted() == (f"{DIRTY}: absent: true", *orders)
    assert robot.monitor.message(output)[1]["accepted"] == [*robot.monitor.accepted()]


def test_the_message_and_its_like():
    robot = Robot()
    robot.step(0, QUIET)
    output = robot.step(1, QUIET, {DIRTY: True})
    name, fields = robot.monitor.message(output)
    assert name == "StateMachineOutput"
    assert (fields["id"], fields["state"], fields["possible"]) == ("shuttle", "Slow", ["Slow"])
    assert fields["in_state"][1] == ("StateVerdict", {"id": "Slow", "verdict": 2, "active": True})
    assert fields["evidence"][0] == ("StateMachineEvidence", {"id": "NotFailed", "active": True})
    assert fields["raised"][0][1] == {
        "state": "Slow",
        "moment": "entry",
        "kind": "warning",
        "text": "reduced speed",
        "target": "",
        "priority": 2,
        "certain": True,
    }
    assert "reasons" not in fields
    written = json.loads(json.dumps(robot.monitor.as_json(output)))
    assert written["raised"][1]["text"] == "limit_speed"
    series = robot.monitor.series(output)
    assert (series["state"], series["failed"], series["Slow"]) == ("Slow", False, True)
    robot.monitor.reset()
    assert robot.step(9).reasons == ("waiting",)

"""The nodes of an example in time: grace, rates, late and silent sources, restarts, clocks.

Limits are those of the example: the evidence of both ConSerts is current for 2 s, the demand of
ConSertA on ConSertB for 0.5 s. The nodes step eight times per second.
"""

import pytest
from eddi_runtime.inputs import UNKNOWN_AGE
from eddi_runtime.node.health import Health
from eddi_runtime.node.report import ERROR, OK, STALE, WARN
from eddi_runtime.why import read_why

from runtime_lib.tests.node.message_package import STD_MSGS
from runtime_lib.tests.node.robot import BEGIN, Robot

A, B = "/conserta/guarantees", "/consertb/guarantees"
ALONE, BOTH, B_ACTIVE = {"System_A_G0"}, {"System_A_G0", "System_A_G1"}, {"System_A_G0_c2"}
FINE = (OK, "all inputs are up to date")


@pytest.fixture
def robot(monkeypatch):
    return Robot(monkeypatch)


def times(first, last, period=0.125):
    return [first + k * period for k in range(round((last - first) / period) + 1)]


def steps(node):
    return [t - BEGIN for t in node.steps]


def test_an_input_may_wait_until_the_grace_is_over(robot):
    node = robot.start("consertb", STARTUP_GRACE=2.0)
    robot.run(1.875)
    assert node.levels == [(0.0, WARN)]
    assert node.report()[:2] == (
        WARN,
        "RtE_A_E0 waiting: /rte/e0b: no message yet, 1.9 s of 2 s to wait",
    )
    robot.run(2.0)
    assert node.levels[1:] == [(2.0, ERROR)]
    never = "RtE_A_E0 missing: /rte/e0b: no message yet, 2.0 s after the start"
    assert node.report().message == never
    robot.sense("/rte/e0b", 3.0)
    robot.run(3.0)
    assert node.levels[2:] == [(3.0, OK)]
    assert node.report()[:2] == FINE
    slow = robot.start("conserta", STARTUP_GRACE=2.0, FREQUENCY=0.25)
    robot.run(6.0)
    assert "no message yet, 2.0 s of 2 s to wait" in slow.report().message


def test_a_value_that_is_nan_is_not_usable(robot):
    node = robot.start("consertb")
    robot.sense("/rte/e0b", 0.5, value=float("nan"))
    robot.sense("/rte/e0b", 1.5)
    robot.run(1.0)
    assert node.levels[-1] == (0.5, ERROR)
    unusable = "RtE_A_E0 invalid: the value is NaN"
    assert node.report()[:2] == (ERROR, unusable)
    assert robot.active(B) == [(0.0, set())]
    robot.run(2.0)
    assert node.report()[:2] == FINE


def test_a_late_source_is_stale_from_the_first_step_behind_its_limit(robot):
    node = robot.start("consertb")
    robot.sense("/rte/e0b", 1.0)
    robot.run(3.0)
    assert robot.active(B) == [(0.0, set()), (1.0, B_ACTIVE)]  # exactly 2 s are not too old
    robot.run(3.125)
    assert robot.active(B)[2:] == [(3.125, set())]
    assert node.levels[-1] == (3.125, STALE)
    late = "/rte/e0b: nothing for 2.1 s, limit 2 s"
    assert node.report()[:2] == (STALE, f"RtE_A_E0 stale: {late}")
    sentence = f"System_A_G0_c2 <- RtE_A_E0 <- {late}"
    assert node.values()["guarantee.System_A_G0_c2"] == f"inactive: {sentence}"
    robot.sense("/rte/e0b", 4.02)
    robot.run(5.0)
    assert robot.active(B)[3:] == [(4.125, B_ACTIVE)]
    assert node.levels[-1] == (4.125, OK)
    assert node.values()["RtE_A_E0.received"] == "2"


def test_rate_waits_for_the_grid_and_on_change_does_not(robot):
    robot.start("consertb")
    changing = robot.start("conserta", MODE="on_change", FREQUENCY=0.5)
    robot.sense("/rte/e0b", 0.2)
    robot.sense("/rte/e0a", 0.203125)
    robot.run(1.0)
    assert robot.active(B)[1:] == [(0.25, B_ACTIVE)]
    assert robot.active(A)[1:] == [(0.203125, ALONE), (0.25, BOTH)]
    assert steps(changing) == [0.0, 0.0, 0.125, 0.203125, *times(0.25, 1.0)]  # latched at 0.0
    assert changing.schedule.overruns == 0


def test_the_diagnosis_never_contradicts_what_was_published_last(robot):
    """At a low frequency nothing but the message would lead to another look at the reasons."""
    node = robot.start("consertb", MODE="on_change", FREQUENCY=0.01)
    robot.sense("/rte/e0b", 1.0, value=False)
    robot.sense("/rte/e0b", 1.1)
    robot.sense("/rte/e0b", 1.2, value=False)
    for t, expected in ((1.0, "inactive: "), (1.1, "active"), (1.2, "inactive: ")):
        robot.run(t)
        said = node.values()["guarantee.System_A_G0_c2"]
        assert said.partition("System_A_G0_c2")[0] == expected


def test_steps_that_take_too_long_are_left_out_and_told_once(robot):
    node = robot.start("consertb")
    robot.sense("/rte/e0b", *times(0.0, 3.0))
    robot.run(1.0)
    node.busy = 0.3125
    robot.run(1.125)  # one step, until 1.4375
    node.busy = 0.0
    assert node.report(periodic=False)[:2] == (WARN, "2 steps left out")
    assert node.report()[:2] == (WARN, "2 steps left out")
    robot.run(2.0)
    assert node.report()[:2] == FINE
    values = node.values()
    assert (values["overruns"], values["longest_step_ms"]) == ("2", "312.500")
    assert steps(node)[9:12] == [1.125, 1.5, 1.625]


def test_a_node_that_no_longer_steps_is_an_error(robot):
    node = robot.start("consertb", FREQUENCY=1.0)
    robot.sense("/rte/e0b", *times(0.0, 2.0))
    robot.run(2.0)
    robot.now += 3.0
    assert node.report()[:2] == FINE  # three periods may pass
    robot.now += 0.5
    assert node.report()[:2] == (ERROR, "no step for 3.5 s")


def test_a_monitor_that_ends_does_not_leave_its_guarantee_behind(robot):
    source = robot.start("consertb")
    node = robot.start("conserta")
    for topic in ("/rte/e0a", "/rte/e0b"):
        robot.sense(topic, *times(0.0625, 9.0))
    robot.run(2.0)
    assert robot.active(A) == [(0.0, set()), (0.125, BOTH)]
    robot.kill(source)
    robot.run(4.0)
    assert robot.active(A)[2:] == [(2.625, ALONE)]  # its last message is of 2.0
    assert "/consertb/guarantees: nothing for 2.0 s" in node.report().message
    again = robot.start("consertb")
    assert robot.active(B, after=4.0) == [(4.0, set())]
    robot.run(5.0)
    assert robot.active(B, after=4.0)[1:] == [(4.125, B_ACTIVE)]
    assert robot.active(A)[3:] == [(4.25, BOTH)]  # it steps before the other does
    assert again.report()[:2] == node.report()[:2] == FINE


def test_what_is_latched_counts_only_when_its_age_is_known(robot):
    robot.start("consertb", FREQUENCY=0.25)
    robot.sense("/rte/e0b", 3.5)
    robot.sense("/rte/e0a", *times(0.5, 9.0))
    robot.run(5.0)
    node = robot.start("conserta")
    robot.run(5.125)
    assert robot.active(A) == [(5.0, set()), (5.125, ALONE)]
    values = node.values()
    latched = "/consertb/guarantees: latched, its age is not known"
    assert (values["RtE_A_D0"], values["RtE_A_D0.reason"]) == ("stale", latched)
    assert values["RtE_A_D0.age_s"] == ""
    assert values["RtE_A_D0.from"] == "/consertb/guarantees System_A_G0_c2"
    node.receive(B, node.simulator_values["consertb"], 0.25)  # its header has a time
    robot.run(5.25)
    assert node.values()["RtE_A_D0.age_s"] == "0.375"
    robot.run(6.0)
    assert robot.active(A)[2:] == [(5.25, BOTH), (5.5, ALONE)]


def test_an_input_without_limit_takes_what_is_latched_and_says_so(robot):
    node = robot.start("consertb")
    spec = node.core.inputs[0]._replace(max_age="none")
    node.eddi_input.bind([spec])
    node.health._inputs = (spec,)
    node.receive("/rte/e0b", STD_MSGS.Bool(data=True), UNKNOWN_AGE)
    robot.run(0.125)
    assert node.report()[:2] == (WARN, "RtE_A_E0 latched: age unknown")
    assert robot.active(B)[1:] == [(0.125, B_ACTIVE)]
    assert node.values()["RtE_A_E0.max_age"] == "no limit"
    robot.sense("/rte/e0b", 0.25)
    robot.run(0.25)
    assert node.report()[:2] == FINE


def test_ages_and_steps_do_not_depend_on_the_clock_that_is_set_back(robot):
    nodes = [robot.start("consertb"), robot.start("conserta")]
    robot.sense("/rte/e0b", *times(0.0625, 2.0625))
    robot.sense("/rte/e0a", *times(0.0625, 9.0))
    robot.run(1.0)
    robot.set_back = 5000.0
    robot.run(9.0)
    assert robot.active(B) == [(0.0, set()), (0.125, B_ACTIVE), (4.125, set())]
    assert robot.active(A) == [(0.0, set()), (0.125, BOTH), (4.125, ALONE)]
    assert [steps(node) for node in nodes] == [[*times(0.0, 9.0)]] * 2
    assert [node.schedule.overruns for node in nodes] == [0, 0]


def test_a_value_that_cannot_be_used_is_logged_once(robot):
    node = robot.start("consertb")
    robot.sense("/rte/e0b", *times(0.125, 4.0), value="yes")
    robot.run(3.0)
    (error,) = [text for level, text in robot.lines if level == "error"]
    assert error.startswith("input RtE_A_E0: ")
    values = node.values()
    assert values["RtE_A_E0"] == "invalid"
    assert values["RtE_A_E0.errors"] == "24"
    assert node.report().level == ERROR


def test_what_hand_written_lines_raise_is_logged_with_its_trace(robot):
    node = robot.start("consertb")
    robot.sense("/rte/e0b", 0.0625)
    robot.run(0.5)
    robot.publish("/rte/e0b", STD_MSGS.String())
    robot.run(1.0)
    error, lost = [text for level, text in robot.lines if level == "error"]
    assert error.startswith("input RtE_A_E0: AttributeError: ")
    assert "process_RtE_A_E0" in error
    raised = "process_RtE_A_E0 raised AttributeError in EDDIInput.py line "
    assert lost.startswith(f"lost {E0B}: {raised}")
    robot.sense("/rte/e0b", 1.0625)
    robot.run(1.125)
    assert node.report()[:2] == FINE


def test_errors_that_alternate_do_not_fill_the_disk(robot):
    node = robot.start("consertb")
    for t in times(0.0, 10.0):
        robot.now = BEGIN + t
        node.health.log_error("step", f"number {t * 8 % 2:.0f}")
    assert len(robot.lines) == 9  # every 1.125 s another one


def test_a_guarantee_that_flaps_does_not_fill_the_disk(robot):
    robot.start("consertb", MODE="on_change")
    for number, t in enumerate(times(0.5, 1.25, 2**-6)):
        robot.sense("/rte/e0b", t, value=number % 2 == 0)
    robot.sense("/rte/e0b", 3.0, value=False)
    robot.run(4.0)
    lines = [text for _, text in robot.lines]
    assert 2 <= len(lines) <= 3
    assert all(text.startswith("lost System_A_G0_c2 <- ") for text in (lines[0], lines[-1]))
    assert any(text.endswith(" more)") for text in lines)


E0B = "System_A_G0_c2 <- RtE_A_E0 <- /rte/e0b"


def told(robot, topic):
    """Return (time, sentence) of the first claim, for each message of a topic."""
    rows = [(t, read_why(message)) for t, of, message in robot.told if of == f"{topic}/why"]
    return [(t, [row.sentence for row in why.values()][-1]) for t, why in rows]


def test_a_sensor_that_is_late_two_monitors_away_is_named_in_each(robot):
    robot.start("consertb")
    node = robot.start("conserta")
    robot.sense("/rte/e0b", *times(0.0625, 1.0625), *times(8.0625, 12.0))
    robot.sense("/rte/e0a", *times(0.0625, 12.0))
    robot.run(2.0)
    assert told(robot, A)[-1] == (0.125, "")  # when all is well, nothing more is sent
    assert not robot.lines
    robot.run(4.0)
    late = f"System_A_G1 <- RtE_A_D0 <- {E0B}: nothing for 2.2 s, limit 2 s"
    assert robot.lines == [
        ("warn", f"lost {E0B}: nothing for 2.1 s, limit 2 s"),
        ("warn", f"lost {late}"),
    ]
    assert node.report()[0] == WARN
    assert node.values()["guarantee.System_A_G1"].startswith("inactive: System_A_G1 <- RtE_A_D0")
    assert [t for t, _ in told(robot, A) if t > 3.5] == [4.0]  # once a second
    robot.run(9.0)
    again = [text for level, text in robot.lines if level == "info"]
    assert [text.partition(" (")[0] for text in again] == [
        "again System_A_G0_c2 after 5.0 s",
        "again System_A_G1 after 5.0 s",
    ]
    assert node.values()["guarantee.System_A_G1"] == "active"
    assert told(robot, A)[-1][1] == ""


def test_no_reason_of_another_monitor_is_waited_for_longer_than_it_lasts(robot):
    robot.start("consertb")._publish_why.clear()
    robot.start("conserta")
    robot.sense("/rte/e0b", *times(0.0625, 1.0625))
    robot.sense("/rte/e0a", *times(0.0625, 12.0))
    robot.run(6.0)
    untold = "RtE_A_D0 <- System_A_G0_c2: unknown there, its monitor tells no reason"
    assert robot.lines[1:] == [("warn", f"lost System_A_G1 <- {untold}")]


def test_what_is_missing_is_said_once_after_the_grace(robot):
    robot.start("consertb", STARTUP_GRACE=2.0)
    robot.run(9.0)
    missing = f"missing {E0B}: no message yet, 2.0 s after the start (nobody publishes it)"
    assert [text for _, text in robot.lines] == [missing.partition(" (")[0]]


def test_an_output_of_another_shape_ends_no_report(robot):
    node = robot.start("consertb")
    Health(node.core, node.eddi_input, 1.0, 0.0).after_step(None, {}, "", 0.0)
    for output in (None, {"id": "G"}, [1, "text"], [{"id": "G"}], object()):
        node.health.after_step(output, {}, "", 0.0)
    assert node.report()[0] == WARN

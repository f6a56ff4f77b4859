"""An ``EDDIInput`` of the D7.2 tools in the place of the generated file: it runs, silence shows."""

# ruff: noqa: N802, N803 - the names of D7.2
from types import SimpleNamespace

import pytest
from eddi_runtime import InputSpec
from eddi_runtime.history import Messages
from eddi_runtime.node.pasted import PASTED, understood
from eddi_runtime.node.report import ERROR, OK, STALE

from runtime_lib.tests.conserts import give
from runtime_lib.tests.node.message_package import EDDI_MESSAGES
from runtime_lib.tests.node.robot import Robot

A, B = "/conserta/guarantees", "/consertb/guarantees"


class OfB:
    """As in D7.2 Fig 43."""

    def __init__(self):
        self.RtE_A_E0 = False

    def process_RtE_A_E0(self, RtE_E0):
        # TODO
        self.RtE_A_E0 = RtE_E0.data

    def processing(self, simulator_outputs):
        if "RtE_E0" in simulator_outputs:
            self.process_RtE_A_E0(simulator_outputs["RtE_E0"])


class OfA:
    """As in D7.2 Fig 44; of the guarantees the one that is meant."""

    def __init__(self):
        self.RtE_A_D0 = False
        self.RtE_A_E0 = False

    def process_RtE_A_D0(self, consertb):
        # TODO
        self.RtE_A_D0 = consertb.guarantees[0].active

    def process_RtE_A_E0(self, RtE_E0):
        # TODO
        self.RtE_A_E0 = RtE_E0.data

    def processing(self, simulator_outputs):
        if "consertb" in simulator_outputs:
            self.process_RtE_A_D0(simulator_outputs["consertb"])
        if "RtE_E0" in simulator_outputs:
            self.process_RtE_A_E0(simulator_outputs["RtE_E0"])


@pytest.fixture
def robot(monkeypatch):
    return Robot(monkeypatch)


def test_its_guarantee_comes_and_goes_with_the_messages(robot):
    node = robot.start("consertb", OfB)
    robot.sense("/rte/e0b", 0.5)
    robot.sense("/rte/e0b", 1.0, value=False)
    robot.sense("/rte/e0b", 1.5)
    robot.run(6.0)
    active = {"System_A_G0_c2"}
    changes = [(0.0, set()), (0.5, active), (1.0, set()), (1.5, active), (3.625, set())]
    assert robot.active(B) == changes
    assert [level for _, level in node.levels][-2:] == [OK, STALE]


def test_one_warning(robot):
    node = robot.start("consertb", OfB)
    node.log_start()
    robot.run(3.0)
    assert [text for level, text in robot.lines if level == "warn"] == [PASTED]
    robot.start("conserta").log_start()
    assert sum(text == PASTED for _, text in robot.lines) == 1


def test_an_exception_is_told_with_its_line(robot):
    class Broken(OfA):
        def processing(self, simulator_outputs):
            super().processing(simulator_outputs)
            if simulator_outputs:
                self.RtE_A_E0 = simulator_outputs["RtE_E0"].value  # here

    node = robot.start("conserta", Broken)
    message = EDDI_MESSAGES.ConSertOutput(guarantees=[SimpleNamespace(id="G", active=True)])
    robot.sense("/rte/e0a", 0.5)
    robot.publish(B, message)
    robot.run(0.5)
    line = Broken.processing.__code__.co_firstlineno + 3
    values = node.values()
    for name in ("RtE_A_D0", "RtE_A_E0"):
        assert values[name] == "invalid"
        assert f"line {line}" in node.eddi_input.states[name].detail
    assert node.report().level == ERROR
    assert robot.active(A) == [(0.0, set())]


SPECS = (
    InputSpec("a", "a", ("x",), 0.5),
    InputSpec("b", "b", ("x", "y"), 1.0),
    InputSpec("rows", "rows", ("z",), 5.0, every_message=True),
)


class Noting:
    """Sets all, from what there is and what there was."""

    def __init__(self):
        self.a = self.b = self.rows = 9
        self.seen = []

    def processing(self, simulator_outputs):
        self.seen.append(sorted(simulator_outputs))
        self.a, self.b = 1, 2
        if "z" in simulator_outputs:
            self.rows = [1.0]


def test_only_what_is_fresh_is_handed_over():
    given = Noting()
    told = understood(given, SPECS)
    messages = {"x": give(), "y": give(), "other": give()}
    for age, seen, a, b in (
        (0.1, ["other", "x", "y"], 1, 2),
        (0.6, ["other", "x", "y"], None, 2),
        (1.1, ["other"], None, None),
    ):
        told.begin_step({"x": age, "y": 0.0}, t_ns=0)
        told.processing(messages)
        assert (given.seen[-1], told.a, told.b, told.rows) == (seen, a, b, None)
        assert told.states["rows"].state == "missing"
    told.processing({"x": give()}, 5)
    assert (given.seen[-1], told.a, told.b) == (["x"], 1, None)


def test_an_attribute_that_is_not_assigned_is_unknown():
    class Once(Noting):
        def processing(self, simulator_outputs):
            self.seen.append(self.a)
            if len(self.seen) == 1:
                self.a = True

    told = understood(Once(), SPECS)
    told.processing({"x": give()}, 0)
    assert (told.a, told.states["a"].state) == (True, "ok")
    told.processing({"x": give()}, 1)
    assert told.a is None
    assert told.states["a"][:2] == ("invalid", "`processing` did not assign it")


def test_a_sample_is_taken_once():
    told = understood(Noting(), SPECS)
    z = give()
    told.processing({"z": z}, 0)
    assert told.rows == [1.0]
    told.processing({"z": z}, 1)
    assert (told.rows, type(told.rows)) == ([], Messages)
    for new, rows in (([z], [1.0]), ([], [])):
        told.begin_step({"z": 0.0}, {"z": new}, 2)
        told.processing({"z": z})
        assert told.rows == rows

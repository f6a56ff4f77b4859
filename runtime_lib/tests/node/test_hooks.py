"""What a person adds in members of a class: called in its place; what it raises ends nothing."""

import pytest
from eddi_runtime.node.health import Diagnostics
from eddi_runtime.node.report import ERROR, OK
from eddi_runtime.node.start import StartError

from runtime_lib.tests.node.robot import Robot, ToyNode, generated

B, ACTIVE = "/consertb/guarantees", {"System_A_G0_c2"}


@pytest.fixture
def robot(monkeypatch):
    return Robot(monkeypatch)


@pytest.fixture
def eddi_input(monkeypatch):
    return generated("consertb", ToyNode, monkeypatch)["EDDIInput"]


def raising(*_):
    raise ValueError("mine")


def logged(robot, about):
    return [text for level, text in robot.lines if level == "error" and about in text]


def test_a_class_of_the_d72_tools_is_refused(robot):
    with pytest.raises(StartError, match="eddi-scaffold adopt"):
        robot.start("consertb", object)


def test_setup_runs_once_when_the_inputs_have_their_defaults(robot, eddi_input):
    seen = []
    cls = type("EDDIInput", (eddi_input,), {"setup": lambda self: seen.append(self.RtE_A_E0)})
    robot.start("consertb", cls)
    robot.run(1.0)
    assert seen == [False]


def test_processed_sees_all_inputs_and_may_change_one(robot, eddi_input):
    seen = []

    def processed(self, simulator_outputs):
        seen.append((self.RtE_A_E0, sorted(simulator_outputs)))
        self.RtE_A_E0 = None

    robot.start("consertb", type("EDDIInput", (eddi_input,), {"processed": processed}))
    robot.sense("/rte/e0b", 0.5)
    robot.run(1.0)
    assert seen[0] == (False, [])
    assert seen[-1] == (True, ["RtE_E0"])
    assert robot.active(B) == [(0.0, set())]


def test_what_processed_raises_withdraws_the_result_of_its_step(robot, eddi_input):
    failing = []
    method = {"processed": lambda self, _: failing and raising()}
    node = robot.start("consertb", type("EDDIInput", (eddi_input,), method))
    robot.sense("/rte/e0b", 0.5, 1.5)
    robot.run(1.0)
    failing.append(True)
    robot.run(1.25)
    assert node.report().level == ERROR
    assert logged(robot, "mine")
    failing.clear()
    robot.run(2.0)
    assert robot.active(B) == [(0.0, set()), (0.5, ACTIVE), (1.125, set()), (1.375, ACTIVE)]
    assert node.report().level == OK


def test_stepped_gets_each_result_when_it_was_published(robot):
    seen = []

    def stepped(self, result):
        last = [message for _, topic, message in robot.told if topic == B][-1]
        seen.append((result[0]["active"], {one.id for one in last.guarantees if one.active}))

    node = robot.start("consertb", stepped=stepped)
    robot.sense("/rte/e0b", 0.5)
    robot.run(1.0)
    assert len(seen) == len(node.steps)
    assert (seen[3], seen[-1]) == ((False, set()), (True, ACTIVE))


def test_what_stepped_raises_is_said_once_and_ends_nothing(robot):
    node = robot.start("consertb", stepped=raising)
    robot.sense("/rte/e0b", 0.5)
    robot.run(1.0)
    assert robot.active(B) == [(0.0, set()), (0.5, ACTIVE)]
    assert node.report().level == OK
    assert len(logged(robot, "mine")) == 1


def begun(robot, started):
    node = robot.start("consertb", started=started, subscribe=lambda self, source: None)
    robot.told.clear()
    node.begin("consertb", Diagnostics(lambda _: None))
    return node


def test_started_runs_before_the_first_step(robot):
    told = []
    begun(robot, lambda self: told.append((len(robot.told), self.eddi_input.RtE_A_E0)))
    assert told == [(0, False)]
    assert [topic for _, topic, _ in robot.told].count(B) == 1


def test_what_is_due_is_done_once_the_result_is_published(robot):
    seen = []

    def published(warn, error):
        seen.append([topic for _, topic, _ in robot.told].count(B))
        warn("mind the gap")
        error("action_stop", "mine", "")

    node = robot.start("consertb")
    before = len(node.steps)
    node.core.published = published
    robot.run(1.0)
    assert seen == [*range(before + 1, len(node.steps) + 1)]
    assert ("warn", "mind the gap") in robot.lines
    assert len(logged(robot, "action_stop: mine")) == 1
    assert node.core.deferred


@pytest.mark.parametrize("is_logged", [True, False])
def test_claims_that_change_as_a_matter_of_course_are_not_logged(robot, is_logged):
    node = robot.start("consertb")
    if not is_logged:
        node.core.unlogged = frozenset(node.core.guarantee_ids)
    robot.sense("/rte/e0b", 0.5)
    robot.run(14.0)
    assert any(text.startswith("lost ") for _, text in robot.lines) == is_logged
    assert node.core.why().keys() >= ACTIVE

"""Plain Python keeps the ages: a message in another object is new, the same object ages."""

import time
from types import MappingProxyType

import pytest
from eddi_runtime import InputSpec, look_again
from eddi_runtime.event import EventMonitor
from eddi_runtime.expressions.expression import Expression
from eddi_runtime.history import EDDIInputBase, Messages

from runtime_lib.tests.conserts import give, monitor

SECOND = 10**9
LIMITED = {"max_age": 0.5, "requires": ["bumper"]}


class Either(Expression):
    """``a OR b``."""

    type = "bool"
    names = MappingProxyType({"a": ("message", "a"), "b": ("message", "b")})

    def step(self, t, messages, ages):
        values = [messages[one] for one in ("a", "b")]
        return (2 if True in values else 1 if None in values else 0,)


SPECS = (
    InputSpec("clear", "clear", ("bumper",), 0.5),
    InputSpec("both", "both", ("bumper", "imu"), 0.5),
    InputSpec("free", "free", ("bumper",), None),
    InputSpec("each", "each", ("bumper",), 0.5, every_message=True),
    InputSpec("either", "either", ("a", "b"), 0.5, expression=Either),
    InputSpec("held", "held", ("never",), 0.5, default=False),
)


class EDDIInput(EDDIInputBase):
    """As a package has it."""

    def __init__(self):
        super().__init__(SPECS)
        self.clear = self.both = self.free = self.each = self.either = None
        self.held = False

    def process_clear(self, bumper):
        self.clear = getattr(bumper, "data", bumper)

    def process_both(self, bumper, imu):
        self.both = True

    def process_free(self, bumper):
        self.free = True

    def process_each(self, bumper):
        self.each = bumper

    def process_either(self, a, b):
        self.either = self.expression("either")

    def process_held(self, never):
        self.held = True

    def processing(self, simulator_outputs, t_ns=None):
        self.begin_processing(t_ns)
        self.update("clear", self.process_clear, simulator_outputs, ("bumper",))
        self.update("both", self.process_both, simulator_outputs, ("bumper", "imu"))
        self.update("free", self.process_free, simulator_outputs, ("bumper",))
        self.update_each("each", self.process_each, simulator_outputs, ("bumper",))
        self.update_expression("either", self.process_either, simulator_outputs, ("a", "b"))
        self.update("held", self.process_held, simulator_outputs, ("never",))


@pytest.fixture
def told():
    return EDDIInput()


def at(seconds):
    return round(seconds * SECOND)


@pytest.mark.parametrize("message", [give(data=True), True, 3.5, "x", (1,)])
def test_the_same_object_ages(told, message):
    for t in (0.0, 0.3, 0.5):
        told.processing({"bumper": message}, at(t))
        assert (told.clear, told.states["clear"].age) == (getattr(message, "data", message), t)
    told.processing({"bumper": message}, at(0.51))
    assert told.clear is None
    assert told.states["clear"][:2] == (
        "stale",
        "the last message is 0.51 s old, the limit is 0.5 s",
    )
    assert told.free is True


def test_another_object_is_new_although_it_is_equal(told):
    for k in range(20):
        told.processing({"bumper": give(data=True)}, at(k * 0.4))
        assert told.states["clear"][:3] == ("ok", "", 0.0)


def test_new_fields_in_the_same_object_are_no_new_message(told):
    message = give(data=True)
    for k in range(3):
        message.data = k
        told.processing({"bumper": message}, at(k * 0.4))
    assert told.clear is None
    told.received("bumper")
    told.processing({"bumper": message}, at(0.9))
    assert (told.clear, told.states["clear"].age) == (2, 0.0)
    told.processing({"bumper": message}, at(1.4))
    assert told.clear == 2
    told.processing({"bumper": message}, at(1.5))
    assert told.clear is None


def test_a_message_that_is_absent_is_unknown_at_once_and_is_no_new_one_later(told):
    old = give(data=True)
    told.processing({"bumper": old}, 0)
    told.processing({}, at(0.1))
    assert (told.clear, told.held) == (None, False)
    told.processing({"bumper": old}, at(0.3))
    assert (told.clear, told.states["clear"].age) == (True, 0.3)
    told.processing({}, at(0.4))
    told.processing({"bumper": old}, at(0.6))
    assert told.clear is None


def test_a_message_ages_while_another_one_is_awaited(told):
    bumper = give(data=True)
    told.processing({"bumper": bumper}, 0)
    told.processing({"bumper": bumper, "imu": 1}, at(0.6))
    assert (told.both, told.states["both"].state) == (None, "stale")


def test_a_step_looks_at_ages_again(told):
    told.processing({"bumper": give(data=True), "imu": 1, "a": True, "b": False}, at(1))
    assert look_again(told, at(1.5)) == 0.5
    assert (told.clear, told.both, told.either) == (True, True, True)
    assert look_again(told, at(1.6)) == 0.6
    assert (told.clear, told.both, told.each, told.either) == (None, None, None, None)
    assert told.states["clear"].reason == "the last message is 0.6 s old, the limit is 0.5 s"
    assert (told.free, told.held) == (True, False)
    told.processing({"bumper": give(data=True)}, at(1.7))
    assert told.clear is True


def test_an_expression_is_known_by_what_is_fresh(told):
    a = True
    told.processing({"a": a, "b": 0}, 0)
    for k in range(1, 9):
        told.processing({"a": a, "b": 1 - k}, at(k * 0.2))
        look_again(told, at(k * 0.2 + 0.05))
        assert told.either is (True if k <= 2 else None)
    for k in range(3):
        told.processing({"a": a, "b": [True, give(), True][k]}, at(2 + k))
        look_again(told, at(2.4 + k))
        assert told.either is (None if k == 1 else True)


def test_a_message_is_taken_once(told):
    told.processing({"bumper": 7}, 0)
    assert told.each == [7]
    look_again(told, 0)
    look_again(told, at(0.1))  # a loop that steps twice
    assert (told.each, type(told.each)) == ([], Messages)
    told.processing({"bumper": 7}, at(0.2))
    assert told.each == []
    told.received("bumper")
    told.processing({"bumper": 7}, at(0.3))
    assert told.each == [7]


@pytest.mark.parametrize(
    ("processed", "stepped"), [(None, 5), (5, None), (5, 0.1), (0.1, 5), (5, 4), (2**63, 2**63)]
)
def test_two_clocks_do_not_mix(told, processed, stepped):
    told.processing({"bumper": give(data=True)}, processed)
    look_again(told, stepped)
    assert (told.clear, told.states["clear"][:2]) == (None, ("stale", "two clocks"))
    assert told.free is True


def test_a_message_of_one_clock_has_no_age_by_the_other(told):
    old = give(data=True)
    told.processing({"bumper": old}, 5)
    for t_ns in (None, 6):
        told.processing({"bumper": old}, t_ns)
        assert told.states["clear"][:2] == ("stale", "two clocks")
    told.processing({"bumper": give(data=True)}, 7)
    assert told.states["clear"].state == "ok"
    told.processing({"bumper": old}, 8)
    told.processing({"bumper": old}, 7)  # the clock went back
    assert told.states["clear"][:2] == ("stale", "two clocks")


def test_the_clock_of_the_machine(told):
    told.processing({"bumper": give(data=True)})
    assert (look_again(told, None) < 0.5, told.clear) == (True, True)
    time.sleep(0.6)
    assert (look_again(told, None) > 0.5, told.clear) == (True, None)


def test_ages_of_begin_step_win(told):
    old = give(data=True)
    for age in (0.1, 0.1, 0.0, 0.5):
        told.begin_step({"bumper": age})
        told.processing({"bumper": old})
        assert (told.clear, told.states["clear"].age) == (True, age)
    told.begin_step({"bumper": 0.6}, t_ns=0)
    told.processing({"bumper": give(data=True)})
    assert told.clear is None
    told.begin_step({"bumper": 0.4}, t_ns=at(1))
    told.processing({"bumper": give(data=True)})
    look_again(told, at(1.1))
    assert told.clear is True
    look_again(told, at(1.2))
    assert told.clear is None


def test_begin_step_holds_for_one_processing(told):
    old = give(data=True)
    told.begin_step({"bumper": 0.1}, t_ns=0)
    told.processing({"bumper": old})
    for t in (1, 2):
        told.processing({"bumper": old}, at(t))
        look_again(told, at(t + 0.6))
        assert told.clear is None


def test_other_objects_have_no_ages():
    assert look_again(give(clear=True), 5) == look_again(None, 0.1) == 0.0


def test_a_guarantee_goes_with_its_evidence():
    made = monitor(["clear"], guarantees=["Drive"], edges=["clear>Drive"], specs={"clear": LIMITED})
    told = EDDIInput()
    told.processing({"bumper": True}, 0)
    assert made.execute_step(told, at(0.5)) == [{"id": "Drive", "active": True}]
    assert made.execute_step(told, at(6)) == [{"id": "Drive", "active": False}]
    assert made.why()["Drive"].sentence == "Drive <- clear: nothing for 6.0 s, limit 0.5 s"


def test_the_sample_of_an_event_is_as_old_as_its_message(told):
    class Stamped(EventMonitor):
        inputs = (SPECS[2],)
        events = ()

        def step(self, source, t):
            self.raw, self.stamped = self.read(source), self.stamp(t, "free")
            return ()

    made = Stamped()
    told.processing({"bumper": True}, at(1))
    told.processing({"bumper": True}, at(3))
    made.execute_step(told, at(4))
    assert made.stamped == at(1)

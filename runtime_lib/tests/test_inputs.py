"""EDDIInputBase: what cannot be trusted becomes None, with the reason beside it."""

import pytest
from eddi_runtime import InputSpec, by_id, by_name
from eddi_runtime.history import EDDIInputBase, Messages
from eddi_runtime.inputs import UNKNOWN_AGE
from eddi_runtime.plain_values import follow

from runtime_lib.tests.conserts import give


class Input(EDDIInputBase):
    def __init__(self):
        super().__init__()
        self.front = False
        self.bind([InputSpec("front left", "front", ("a", "b"), 0.5), InputSpec("free", "free")])

    def process(self, a, b):
        self.front = a.data and b.data

    def go(self, messages, ages=None, process=None):
        self.begin_step(ages)
        self.update("front left", process or self.process, messages, ("a", "b"))
        return self.front, self.states["front left"].state


BOTH = {"a": give(data=True), "b": give(data=True)}


def test_the_default_holds_before_the_first_messages_only():
    one = Input()
    assert one.go({}) == (False, "missing")
    assert one.go({"a": BOTH["a"], "b": None}) == (False, "missing")
    assert one.states["front left"].reason == "no message of b"
    assert one.go(BOTH) == (True, "ok")
    assert one.go({"a": BOTH["a"]}) == (None, "missing")
    assert one.go({}) == (None, "missing")


def test_any_message_older_than_the_limit_makes_it_stale():
    one = Input()
    assert one.go(BOTH, {"a": 0.5, "b": 0.0}) == (True, "ok")
    assert one.states["front left"].age == 0.5
    assert one.go(BOTH, {"a": 0.0, "b": 0.51}) == (None, "stale")
    assert one.go(BOTH, {"a": float("nan"), "b": 0.0}) == (None, "stale")
    assert one.go(BOTH) == (True, "ok")


def test_a_latched_message_counts_only_without_a_limit():
    one = Input()
    assert one.go(BOTH, {"a": UNKNOWN_AGE, "b": 0.0}) == (None, "stale")
    reason = one.states["front left"].reason
    assert reason == "the last message was latched, its age is not known"
    assert one.go(BOTH, {"a": 0.1, "b": 0.0}) == (True, "ok")
    one.bind([InputSpec("front left", "front", ("a", "b"), "none")])
    assert one.go(BOTH, {"a": UNKNOWN_AGE, "b": 0.0}) == (True, "ok")


def test_a_method_that_raises_makes_it_invalid():
    def broken(a, b):
        raise IndexError("list index\nout of range")

    one = Input()
    one.go(BOTH)
    assert one.go(BOTH, None, broken) == (None, "invalid")
    state = one.states["front left"]
    assert state.reason == "IndexError: list index out of range"
    assert "in broken" in state.detail
    one.go(BOTH, None, broken)
    assert one.states["front left"].detail is state.detail
    assert one.go(BOTH) == (True, "ok")


def test_another_method_makes_no_input_known():
    """A body that was copied and sets the first input as well: silence must not look good."""
    one = Input()
    one.front = None  # the default
    one.bind([InputSpec("front left", "front", ("a", "b"), 0.5), InputSpec("free", "free")])

    def stray():
        one.front = one.free = True

    for messages, ages in (({}, None), (BOTH, None), (BOTH, {"a": 0.6, "b": 0.0}), ({}, None)):
        one.go(messages, ages)
        one.update("free", stray, {}, ())
        one.end_step()
        assert one.front is (True if messages and ages is None else None)
        assert one.free is True


def test_a_value_is_of_this_step():
    """A method that finds nothing in a message leaves no value of an earlier message behind."""
    one = Input()
    assert one.go(BOTH) == (True, "ok")
    assert one.go(BOTH, {"a": 0.1, "b": 0.1}, lambda a, b: None) == (None, "invalid")
    assert one.states["front left"].reason == "its method left it at None"


class Each(EDDIInputBase):
    """An input that takes every message of ``a``, with the latest of ``b``."""

    def __init__(self):
        super().__init__()
        self.sums = None
        self.bind([InputSpec("sums", "sums", ("a", "b"), 0.5, every_message=True)])

    def process(self, a, b):
        if a is not None:
            self.sums = a + b

    def go(self, messages, new=None, ages=None):
        self.begin_step(ages, new)
        self.update_each("sums", self.process, messages, ("a", "b"))
        return self.sums, self.states["sums"].state


def test_every_message_since_the_last_step_has_a_value():
    one = Each()
    assert one.go({}) == (None, "missing")
    assert one.go({"a": 1, "b": 10}) == ([11], "ok")  # nothing else is known to be new
    assert one.go({"a": 3, "b": 20}, {"a": [1, 2, 3], "b": [20]}) == ([21, 22, 23], "ok")
    assert one.go({"a": 3, "b": 20}, {"a": []}) == ([], "ok")
    assert one.go({"a": 3, "b": 20}, {"b": [20]}) == ([], "ok")
    assert type(one.sums) is Messages


def test_a_message_that_cannot_be_used_is_none_among_the_others():
    one = Each()
    assert one.go({"a": 3, "b": 1}, {"a": [1, "two", 3]}) == ([2, None, 4], "invalid")
    assert one.states["sums"].reason.startswith("TypeError: ")
    assert one.go({"a": 3, "b": 1}, {"a": [1, None, 3]}) == ([2, None, 4], "ok")


def test_what_comes_too_late_is_none_as_a_whole():
    one = Each()
    assert one.go({"a": 1, "b": 1}, {"a": [1]}, {"a": 0.6, "b": 0.0}) == (None, "stale")
    assert one.go({"a": 1, "b": 1}, {"a": [1]}, {"a": 0.0, "b": 0.0}) == ([2], "ok")
    assert one.go({"a": 1}, {"a": [1]}) == (None, "missing")


@pytest.mark.parametrize("update", ["update", "update_each", "update_expression"])
def test_a_call_with_no_messages_at_all_raises_nothing(update):
    """``processing`` may be edited: what it hands over can be anything."""
    one = Each()
    one.sums = [1]
    one.begin_step()
    getattr(one, update)("sums", one.process, None, ("a", "b"))
    assert (one.sums, one.states["sums"].state) == (None, "invalid")


def test_an_exception_without_a_printable_trace():
    def broken(a, b):
        raise SyntaxError("odd", ("file", 1, 2, 3))  # its text is no text

    one = Input()
    assert one.go(BOTH, None, broken) == (None, "invalid")
    state = one.states["front left"]
    assert (state.reason.startswith("SyntaxError: odd"), state.detail) == (True, "")


def test_an_element_that_is_there_twice_is_none_of_them():
    items = [give(id="a", active=False), give(id="a", active=True)]
    with pytest.raises(LookupError, match="2 elements have the id 'a'; there: a, a"):
        by_id(items, "a")


def test_by_name():
    assert by_name([1.0, 2.0], ["left", "right"], "right") == 2.0
    for values, names, reason in (
        ([1.0], ["left"], "no element has the name 'right'; there: left"),
        ([1.0, 2.0], ["right", "right"], "2 elements have the name 'right'"),
        ([], ["right"], "0 values have 1 names"),
    ):
        with pytest.raises(LookupError, match=reason):
            by_name(values, names, "right")


def test_paths_as_data():
    message = give(nodes=[give(title="a", value=[1.0, 2.0])], x=[3.0], name=["left"])
    assert follow(message, ["nodes", ["title", "a"], "value", 1]) == 2.0
    assert follow(message, [["x", "name", "left"]]) == 3.0


def test_an_input_without_an_expression_has_no_value_of_one():
    one = Input()
    one.update_expression("free", lambda: setattr(one, "free", one.expression("free")), {}, ())
    assert (one.free, one.states["free"].state) == (None, "invalid")
    assert one.states["free"].reason == "not known yet"

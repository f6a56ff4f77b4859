"""From the value of an input to the state of a node."""

import math

import numpy as np
from eddi_runtime.bayesian_network.direct import DirectReader
from eddi_runtime.inputs import InputSpec

from .networks import discretiser

STATES = ("low", "mid", "high")


def spec(default=None, max_age=None):
    return InputSpec("x", "x", (), max_age, None, default, every_message=False)


def reader(states=STATES, default=None, max_age=None, **declared):
    return discretiser(dict(declared, input="x"), states, spec(default, max_age))


def names(one, values, states=STATES):
    known = (*states, None)
    return [known[one.read(value, 0)] for value in values]


def test_hysteresis():
    one = reader(bins=[1.0, 2.0], hysteresis=0.25)
    values = [0.5, 1.25, 1.2500000000000002, 0.75, 0.7499999999999999, 2.25, 2.5, 1.75, 1.5]
    want = ["low", "low", "mid", "mid", "low", "high", "high", "high", "mid"]
    assert names(one, values) == want
    assert names(one, [math.nan, 2.1, 1.9]) == [None, "high", "high"]
    one.reset()
    assert names(one, [1.9]) == ["mid"]
    assert names(one, [2.1, math.inf, 1.9]) == ["mid", None, "mid"]


def test_missing_default_and_hold():
    default = reader(bins=[1.0, 2.0], missing="default", default=1.5)
    assert names(default, [None, 0.5, math.nan]) == ["mid", "low", "mid"]
    hold = reader(bins=[1.0, 2.0], missing="hold", max_age=2.0)
    assert hold.timed
    second = 10**9
    assert hold.read(None, 0) == 3
    assert hold.read(0.5, second) == 0
    assert [hold.read(None, k * second) for k in (2, 3, 4)] == [0, 0, 3]
    assert hold.read(0.5, 5 * second) == 0
    hold.reset()
    assert hold.read(None, 5 * second) == 3
    unlimited = reader(bins=[1.0, 2.0], missing="hold")
    assert [unlimited.read(0.5, 0), unlimited.read(None, 1)] == [0, 3]


def test_faults_are_said_and_missing_is_none():
    one = reader(bins=[1.0, 2.0], range=[0, 9], sentinel=[[99, "unobserved"]])
    assert [one.fault(value) for value in (None, math.nan, 1.5, 99)] == [None] * 4
    assert one.fault("far") == "expected a number, got 'far'"
    assert one.fault(10.0) == "the value 10.0 is not finite or outside the range"
    assert reader(map={"car": "low"}).fault("bus") == "no state is declared for 'bus'"


def direct(virtual=True):
    return DirectReader(STATES, virtual=virtual)


def test_direct_inputs():
    one = direct()
    assert [one.read(value, 0) for value in ("low", "high", [0, 2, 0], (0, 0, 1.0))] == [0, 2, 1, 2]
    assert one.read([1.0, 2.0, 0.0], 0) == [0.5, 1.0, 0.0]
    for value in (
        "hot",
        "",
        [],
        None,
        math.nan,
        1.0,
        True,
        object(),
        [1.0],
        [0, 0, 0],
        {},
        [math.nan] * 3,
    ):
        assert one.read(value, 0) == 3
    assert direct(virtual=False).read([1.0, 2.0, 0.0], 0) == 3
    assert one.absent(0) == 3
    one.reset()


def test_direct_inputs_of_numpy():
    one = direct()
    assert one.read(np.array([0.0, 1.0, 0.0]), 0) == 1
    assert one.read(np.array([1, 2, 0], dtype="float32"), 0) == [0.5, 1.0, 0.0]
    assert one.read(np.array(3.0), 0) == 3
    assert one.read(np.array([]), 0) == 3
    assert one.read(np.array([[1.0, 0.0, 0.0]]), 0) == 3
    assert one.read(np.str_("mid"), 0) == 1

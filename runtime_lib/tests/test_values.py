"""The table of what counts as TRUE, FALSE, UNKNOWN and as a fault."""

import enum
import math
import sys

import numpy as np
import pytest

from runtime_lib.tests.conserts import binary, categorical, give, numeric, one_leaf

T, F, U, X = ("TRUE", False), ("FALSE", False), ("UNKNOWN", False), ("UNKNOWN", True)
KINDS = {
    "binary": binary(),
    "categorical": categorical("ok", "1"),
    "numeric": numeric("[0, 5]"),
    "open": numeric("[0, inf]"),
}


class Number(float):
    def __le__(self, other):
        return True

    __ge__ = __lt__ = __gt__ = __eq__ = __le__
    __hash__ = float.__hash__


class Text(str):
    __slots__ = ()

    def __eq__(self, other):
        return True

    def __hash__(self):
        return hash("ok")


class Level(enum.IntEnum):
    LOW = 3


class Hostile:
    def __getattribute__(self, name):
        raise RuntimeError(name)

    def __eq__(self, other):
        return True

    __hash__ = None

    def __bool__(self):
        return True

    def __float__(self):
        return 1.0

    __lt__ = __le__ = __gt__ = __ge__ = __eq__


class Pretender:
    @property
    def __class__(self):
        return bool


TABLE = [
    # value, binary, categorical, numeric
    (None, U, U, U),
    (True, T, X, X),
    (False, F, X, X),
    ("ok", X, T, X),
    ("bad", X, F, X),
    ("False", X, F, X),
    ("", X, F, X),
    (1, X, X, T),
    (0, X, X, T),
    (6, X, X, F),
    (-1, X, X, F),
    (10**400, X, X, F),
    (5.0, X, X, T),
    (math.nextafter(5.0, 6.0) if sys.version_info >= (3, 9) else 5.000000000000001, X, X, F),
    (-0.0, X, X, T),
    (float("nan"), U, U, U),
    (float("inf"), X, X, F),
    (float("-inf"), X, X, F),
    (b"ok", X, X, X),
    ([True], X, X, X),
    ({}, X, X, X),
    (1 + 0j, X, X, X),
    (object(), X, X, X),
    (Number(9.0), X, X, F),
    (Number("nan"), U, U, U),
    (Text("bad"), X, F, X),
    (Level.LOW, X, X, T),
    (Hostile(), X, X, X),
    (Pretender(), X, X, X),
    (bool, X, X, X),
    # those of numpy count by their plain value
    (np.bool_(True), T, X, X),
    (np.bool_(False), F, X, X),
    (np.int8(3), X, X, T),
    (np.uint64(2**63), X, X, F),
    (np.float32(5), X, X, T),
    (np.float64(5.5), X, X, F),
    (np.float16("nan"), U, U, U),
    (np.longdouble(2), X, X, T),
    (np.str_("ok"), X, T, X),
    (np.timedelta64(3, "s"), X, X, X),
    (np.timedelta64(3, "ns"), X, X, X),
    (np.datetime64("2020-01-01"), X, X, X),
    (np.complex64(1), X, X, X),
    (np.array(True), X, X, X),
    (np.array([1.0]), X, X, X),
]


def outcome(monitor, value):
    rows = monitor.execute_step(give(x=value))
    verdict = monitor.input_verdicts()["x"]
    assert rows == [{"id": "G", "active": verdict == "TRUE"}]
    faulty = "x" in monitor.faults()
    return verdict, faulty


@pytest.mark.parametrize("row", range(len(TABLE)))
def test_table(row):
    value, *wanted = TABLE[row]
    found = [outcome(one_leaf(KINDS[kind]), value) for kind in ("binary", "categorical", "numeric")]
    assert found == wanted


def test_infinity_is_compared_like_a_number():
    assert outcome(one_leaf(KINDS["open"]), math.inf) == T
    assert outcome(one_leaf(numeric("[0, inf)")), math.inf) == F
    assert outcome(one_leaf(numeric("[-inf, 3)")), -math.inf) == T


def test_more_ranges_than_are_written_out():
    monitor = one_leaf(numeric(*(f"[{10 * k}, {10 * k + 1})" for k in range(20))))
    assert outcome(monitor, 190.5) == T
    assert outcome(monitor, 191.0) == F


def test_reasons_name_value_and_range():
    def text(dimension, value, **spec):
        monitor = one_leaf(dimension, **spec)
        monitor.execute_step(give(x=value))
        ((cause,),) = (why.causes for why in monitor.why().values())
        return f"{cause.state}: {cause.said}"

    assert text(binary(), False) == "false: false for 0.0 s"
    assert text(binary(), None) == "invalid: no value"
    assert text(binary(), "no") == "invalid: expected True or False, got 'no'"
    assert text(numeric("[0, 5)"), 7.5) == "false: 7.5 m for 0.0 s, needs 0 ..< 5 m"
    ranges = numeric("[0, 1]", "[2, inf)", uom=None)
    assert text(ranges, 1.5) == "false: 1.5 for 0.0 s, needs 0 .. 1 or at least 2"
    assert text(numeric("[0, 1]"), float("nan")) == "invalid: NaN"
    hidden = text(numeric("[0, 1]"), Hostile())
    assert hidden == "invalid: expected a number, got an object of type Hostile"
    assert text(categorical("a", "b"), "c") == "false: c for 0.0 s, needs a or b"
    km = text(numeric("[0, 5]"), 1, factor=[1000, 1])
    assert km == "false: 1000 m for 0.0 s, needs 0 .. 5 m"
    degrees = text(numeric("[0, 5]"), 300, factor=[10133099161583616, 580583098310656000])
    assert degrees == "false: 5.24 m for 0.0 s, needs 0 .. 5 m"
    assert text(numeric("[0, 5]"), 10**400).startswith("false: a number that is too large")

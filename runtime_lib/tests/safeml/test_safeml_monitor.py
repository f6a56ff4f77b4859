"""The monitor: window, omission, holding, age, explanation, messages."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from eddi_runtime.history import Messages
from eddi_runtime.safeml.arrays import take
from hypothesis import given
from hypothesis import strategies as st

from runtime_lib.tests.safeml.monitors import monitor, step

ROWS = [[k / 10] for k in range(10)]
NAN = float("nan")


def filled(**more):
    one = monitor(ROWS, **more)
    for value in (0.05, 0.45, 0.75, 0.35):
        step(one, [value])
    return one


def violated(**more):
    one = filled(**more)
    for value in (5.0, 6.0, 7.0, 8.0):
        result = step(one, [value])
    assert result.odd_violation
    return one


def test_no_verdict_before_the_window_is_full():
    one = monitor(ROWS)
    for count in range(3):
        result = step(one, [0.5])
        assert (result.omission, result.odd_violation, result.reason) == (True, False, "filling")
        assert result.component == -1
        assert math.isnan(result.statistic)
        assert result.accepted == count + 1
    assert not step(one, [0.5]).omission


@pytest.mark.parametrize(
    ("bad", "reason"),
    [([], "empty"), ([NAN], "not_finite"), ([1.0, 2.0], "wrong_length"), ("x", "wrong_length")],
)
def test_what_is_no_sample_is_an_omission_and_changes_nothing(bad, reason):
    one = filled()
    before = step(one, [0.2])
    result = step(one, bad)
    assert (result.omission, result.reason, result.rejected) == (True, reason, 1)
    assert one.faults()["sample"]
    again = step(one, Messages())
    assert again == result  # nothing new: nothing changes
    after = step(one, [0.2])
    assert not after.omission
    assert after.accepted == before.accepted + 1
    assert one.faults() == {}


def test_an_omission_is_explained_in_words():
    one = monitor(ROWS, max_age=2.0)
    assert one.omission() == ("filling", "the window has 0 of 4 samples")
    one = filled(max_age=2.0)
    assert one.omission() == ("", "")
    step(one, [1.0, 2.0])
    assert one.omission() == ("wrong_length", "2 values, the reference has 1 feature")
    step(one, Messages())
    assert one.omission()[0] == "wrong_length"
    step(one, "x")
    assert one.omission() == ("wrong_length", "numbers are expected, not str")
    step(one, None)
    assert one.omission() == ("stale", "the last sample is older than 2 s")


def test_the_status_says_whether_a_verdict_is_held():
    one = monitor(ROWS)
    assert one.status_message()[1]["held"] is False
    one = filled()
    assert one.status_message()[1]["held"] is False
    step(one, [])
    assert one.status_message()[1]["held"] is True  # of no violation
    one = filled(on_omission="clear")
    step(one, [])
    assert one.status_message()[1]["held"] is False


def test_age_empties_the_window():
    one = violated(max_age=1.0)
    assert step(one, Messages(), 1.0).reason == ""
    stale = step(one, Messages(), 1.1)
    assert (stale.omission, stale.odd_violation, stale.reason) == (True, True, "stale")
    assert one.status_message()[1]["filled"] == 0
    assert one.status_message()[1]["held"] is True
    assert step(one, Messages(), 1.2).reason == "stale"
    assert step(one, [0.5], 1.3).reason == "filling"


def test_a_sample_after_a_long_gap_begins_a_new_window():
    one = filled(max_age=1.0)
    result = step(one, [0.5], 60.0)
    assert (result.omission, result.reason) == (True, "filling")
    assert one.status_message()[1]["filled"] == 1


def test_stride_takes_every_third_sample():
    one = monitor(ROWS, stride=3)
    values = [k / 13 for k in range(12)]
    for value in values:
        result = step(one, [value])
    other = monitor(ROWS)
    for value in values[::3]:
        expected = step(other, [value])
    assert result.statistic == expected.statistic
    assert result.accepted == 12
    assert step(monitor(ROWS, stride=3), [[v] for v in values]).statistic == expected.statistic


def test_reset_forgets_all():
    one = violated()
    one.reset()
    assert step(one, None) == step(monitor(ROWS), None)


def test_messages():
    one = filled()
    result = step(one, [0.2])
    fields = {"omission": False, "odd_violation": False, "significance_level": 0.1}
    assert one.message(result) == ("SafeMLOutput", fields)
    name, status = one.status_message()
    assert name == "SafeMLStatus"
    assert status["in_scope"] is True
    assert (status["filled"], status["window_size"]) == (4, 4)
    assert one.message("spoilt")[1]["omission"] is True
    assert one.output_faults()
    assert one.message(result)[1]["omission"] is False
    assert one.output_faults() == ()


def test_the_scope_says_what_it_lacks():
    one = filled()
    step(one, [0.5])
    assert one.why()["in_scope"].sentence == ""
    said = violated().why()["in_scope"].sentence
    assert said == "in_scope: statistic 1 for 0.0 s, limit 0.7"
    fresh = monitor(ROWS)
    step(fresh, [0.5])
    assert fresh.why()["in_scope"].sentence == "in_scope: window has 1 of 4 samples"


def multi_array(data, *sizes, offset=0):
    dim = [SimpleNamespace(size=size, stride=0, label="") for size in sizes]
    return SimpleNamespace(layout=SimpleNamespace(dim=dim, data_offset=offset), data=data)


def rows_of(value, features=2, *, single=False):
    taken = take(value, features, single=single)
    return [row.tolist() for row in taken.rows], taken.bad


@pytest.mark.parametrize(
    ("value", "rows", "bad"),
    [
        ([1, 2.5], [[1.0, 2.5]], []),
        ((1, 2), [[1.0, 2.0]], []),
        (np.array([1, 2], dtype=np.int8), [[1.0, 2.0]], []),
        ([[1, 2], [3, 4]], [[1.0, 2.0], [3.0, 4.0]], []),
        (np.array([[1.0, 2.0], [3.0, 4.0]]), [[1.0, 2.0], [3.0, 4.0]], []),
        (np.array([[1.0], [2.0]]), [[1.0, 2.0]], []),
        (b"\x01\x02", [[1.0, 2.0]], []),
        (multi_array((1.0, 2.0)), [[1.0, 2.0]], []),
        (multi_array((9.0, 1.0, 2.0), offset=1), [[1.0, 2.0]], []),
        (multi_array((1.0, 2.0, 3.0, 4.0), 2, 2), [[1.0, 2.0], [3.0, 4.0]], []),
        (multi_array((1.0, 2.0), 2, 1), [[1.0, 2.0]], []),
        (multi_array(()), [], ["empty"]),
        ([], [], ["empty"]),
        ([[]], [], ["empty"]),
        (b"", [], ["empty"]),
        ([1.0], [], ["wrong_length"]),
        ([1, 2, 3], [], ["wrong_length"]),
        (np.zeros((3, 3)), [], ["wrong_length"] * 3),
        (np.zeros((1, 1, 2)), [], ["wrong_length"]),
        ([1.0, float("nan")], [], ["not_finite"]),
        ([1.0, float("inf")], [], ["not_finite"]),
        ([[1.0, 2.0], [float("nan"), 0.0]], [[1.0, 2.0]], ["not_finite"]),
        ([[1.0, 2.0], [3.0]], [[1.0, 2.0]], ["wrong_length"]),
        ("12", [], ["wrong_length"]),
        (["1", "2"], [], ["wrong_length"]),
        ([1.0, None], [], ["wrong_length"]),
        ([10**400, 1], [], ["wrong_length"]),
        ([1j, 2], [], ["wrong_length"]),
        ([True, False], [], ["wrong_length"]),
        ([1.0, True], [], ["wrong_length"]),
        ([1.0, np.bool_(1)], [], ["wrong_length"]),
        (np.array([True, False]), [], ["wrong_length"]),
        (multi_array((1.0, True)), [], ["wrong_length"]),
        ([[1.0, 2.0], [True, 2.0]], [[1.0, 2.0]], ["wrong_length"]),
        ([[[1.0], [2.0]]], [], ["wrong_length"]),
        (Messages([[[1.0], [2.0]]]), [], ["wrong_length"]),
        (Messages([[[1.0, 2.0], [3.0, 4.0]]]), [], ["wrong_length"]),
        (Messages([[1.0, (2.0,)]]), [], ["wrong_length"]),
        (Messages([np.array([[1.0, 2.0]])]), [[1.0, 2.0]], []),
        ({1: 2}, [], ["wrong_length"]),
        (object(), [], ["wrong_length"]),
        (7.0, [], ["wrong_length"]),
        (Messages(), [], []),
        (Messages([[1.0, 2.0], None, []]), [[1.0, 2.0]], ["wrong_length", "empty"]),
    ],
)
def test_values(value, rows, bad):
    assert rows_of(value) == (rows, bad)


@pytest.mark.parametrize(
    ("value", "fault"),
    [
        ([1.0, True], "numbers are expected, not Booleans"),
        (np.array([True, True]), "numbers are expected, not Booleans"),
        ([[[1.0], [2.0]]], "numbers are expected, not lists in a list"),
        (["1", "2"], "numbers are expected, not list"),
        ([1.0, None], "numbers are expected, not list"),
        ("12", "numbers are expected, not str"),
    ],
)
def test_what_is_no_number_is_told(value, fault):
    assert take(value, 2, single=False).fault == fault


def test_one_feature_may_be_a_plain_number():
    assert rows_of(7.0, 1) == ([[7.0]], [])
    assert rows_of(float("nan"), 1) == ([], ["not_finite"])


def test_float32_is_rounded_before_it_is_judged():
    assert rows_of([0.1], 1, single=True)[0] == [[float(np.float32(0.1))]]
    assert rows_of([1e300], 1, single=True) == ([], ["not_finite"])


class Awkward:
    def __getattr__(self, name):
        raise RuntimeError(name)

    def __len__(self):
        raise RuntimeError


ANYTHING = st.recursive(
    st.one_of(
        st.none(), st.booleans(), st.integers(), st.floats(), st.text(), st.binary(),
        st.complex_numbers(), st.builds(Awkward), st.just(np.array(None, dtype=object)),
    ),
    lambda inner: st.one_of(
        st.lists(inner), st.lists(inner).map(Messages), st.tuples(inner, inner),
        st.dictionaries(st.text(), inner),
    ),
    max_leaves=6,
)  # fmt: skip


@given(st.lists(ANYTHING, max_size=6))
def test_nothing_raises_and_nothing_bad_enters_the_window(values):
    one = monitor([[float(k), float(k % 3)] for k in range(10)])
    for value in values:
        accepted = one._last.accepted
        filled = one._window.filled
        result = step(one, value)
        assert isinstance(result.omission, bool)
        assert one._window.filled == min(4, filled + result.accepted - accepted)
        assert np.isfinite(one._window._lower).all()
        one.status_message()
        one.faults()

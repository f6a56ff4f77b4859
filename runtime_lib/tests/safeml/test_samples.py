"""Any value is taken as samples, or counted as none; no value ends the monitor."""

from types import SimpleNamespace

import numpy as np
import pytest
from eddi_runtime.history import Messages
from eddi_runtime.safeml.arrays import take
from hypothesis import given
from hypothesis import strategies as st

from runtime_lib.tests.safeml.monitors import monitor, step


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

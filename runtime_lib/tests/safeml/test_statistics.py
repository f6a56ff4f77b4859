"""Every statistic equals its definition, from whatever side it is computed."""

import numpy as np
import pytest
from eddi_runtime.safeml import arrays
from eddi_runtime.safeml.comparison import (
    Comparison,
    CramerVonMises,
    Window,
)

from runtime_lib.tests.safeml.monitors import of_windows

METRICS = ("ks", "cvm", "ad")


def test_sums_that_do_not_fit_into_64_bits():
    """Whole numbers or doubles: the same to 1e-10."""
    chance = np.random.RandomState(1)
    reference = np.sort(chance.normal(size=(1, 3000)), axis=1)
    window = chance.normal(0.2, size=(1, 1, 200))
    exact = of_windows(Comparison("cvm", reference, 200), window)
    comparison = Comparison("cvm", reference, 200)
    made = pytest.MonkeyPatch()
    made.setattr("eddi_runtime.safeml.comparison._EXACT", 1)
    comparison.of_ranks = CramerVonMises(comparison.backend, reference, 200)
    made.undo()
    np.testing.assert_allclose(of_windows(comparison, window), exact, rtol=1e-10)


@pytest.mark.parametrize("metric", METRICS)
@pytest.mark.parametrize("levels", [None, 8])
def test_the_window_equals_its_last_values(metric, levels):
    """The ring against a comparison of what it should hold, while it is also cleared at times."""
    chance = np.random.RandomState(2)
    tests, m = 3, 7

    def some(*shape):
        values = chance.normal(size=shape)
        return values if levels is None else np.round(values * levels) / levels

    comparison = Comparison(metric, np.sort(some(tests, 50), axis=1), m)
    window, last = Window(comparison), []
    for count in range(2000):
        if count % 701 == 700:
            window.clear()
            last = []
        sample = some(tests)
        window.push(sample)
        last = [*last, sample][-m:]
        assert window.is_full == (len(last) == m)
        if window.is_full and count % 5 == 0:
            expected = of_windows(comparison, np.array(last).T[None])[0]
            np.testing.assert_allclose(window.statistics(), expected, rtol=1e-13, atol=1e-13)


def test_infinity_is_beyond_every_reference():
    """It is what a component becomes of numbers that are too large to multiply."""
    comparison = Comparison("ad", np.arange(100.0)[None], 2)
    window = Window(comparison)
    for value in (np.inf, -np.inf):
        window.push(np.array([value]))
    expected = of_windows(comparison, np.array([[[1e9, -1e9]]]))[0]
    np.testing.assert_array_equal(window.statistics(), expected)


@pytest.mark.parametrize("metric", METRICS)
def test_a_million_steps_do_not_drift(metric, request):
    """No growth and no drift: a long profile for the million, some thousand else."""
    is_long = request.config.getoption("--hypothesis-profile", default=None) == "long"
    steps = 1_000_000 if is_long else 8_000
    chance = np.random.RandomState(4)
    samples = np.round(chance.normal(size=(1009, 2)), 2)
    comparison = Comparison(metric, np.sort(np.round(chance.normal(size=(2, 200)), 2), axis=1), 20)
    window = Window(comparison)
    before = vars(window).keys()
    for count in range(steps):
        window.push(samples[count % 1009])
        if count % 97 == 0 and window.is_full:
            window.statistics()
    fresh = Window(comparison)
    for count in range(steps - 20, steps):
        fresh.push(samples[count % 1009])
    np.testing.assert_array_equal(window.statistics(), fresh.statistics())
    assert (window._tied, window._equal) == (fresh._tied, fresh._equal)
    assert vars(window).keys() == before
    assert len(window._ties) == 20


def test_an_absent_library_is_said_and_numpy_used(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "torch", None)
    with pytest.warns(RuntimeWarning, match="numpy is used, because torch cannot be"):
        assert arrays.torch_or_numpy().name == "numpy"


def cases():
    chance = np.random.RandomState(9)
    for levels in (None, 6):
        pooled = chance.normal(size=(3, 80 + 5 * 12))
        pooled = pooled if levels is None else np.round(pooled * levels) / levels
        windows = pooled[:, 80:].reshape(3, 5, 12).swapaxes(0, 1)
        yield np.sort(pooled[:, :80], axis=1), np.ascontiguousarray(windows)


class Renamed(arrays.Backend):
    """Stands for an array library of another name: nothing may go by lists or numpy's own ways."""

    def __init__(self):
        super().__init__(np, "renamed")

    def numpy(self, values):
        return values


@pytest.mark.parametrize("metric", METRICS)
def test_the_way_of_other_libraries(metric):
    from eddi_runtime.safeml.comparison import Window

    for reference, windows in cases():
        there = Comparison(metric, reference, 12, Renamed())
        window = Window(there)
        for sample in windows[0].T:
            window.push(np.ascontiguousarray(sample))
        expected = of_windows(Comparison(metric, reference, 12), windows)
        np.testing.assert_array_equal(window.statistics(), expected[0])
        np.testing.assert_array_equal(of_windows(there, windows), expected)

"""PyTorch decides as numpy does; without it numpy takes its place."""

import numpy as np
import pytest
from eddi_runtime.safeml import arrays
from eddi_runtime.safeml.comparison import Comparison

from eddi_scaffold.kinds.safeml.thresholds import of_windows


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


@pytest.mark.parametrize("metric", ["ks", "cvm", "ad"])
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

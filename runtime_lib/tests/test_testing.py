"""The public helpers for tests of monitors, and a runtime copied under another name."""

import pytest
from eddi_runtime.testing import FakeClock, inputs, script

from runtime_lib.tests.conserts import GOOD, active, nested


def test_scripted_inputs():
    made = nested()
    assert [active(rows) for rows in script(made, [{}, GOOD, {"d": True}])] == [[], ["G"], ["G"]]
    with pytest.raises(LookupError, match="no input q; there: a, b, c, n, d"):
        inputs(made, {"q": 1})


def test_the_clock_stands_still():
    clock = FakeClock(5.0)
    clock.advance(0.5)
    assert clock() == clock() == 5.5

"""The start of a mission, as the reports and the warnings take it: everything is in order."""

from __future__ import annotations

import pytest

from eddi_scaffold.kinds.reliability.trial import at_start
from tests.kinds.reliability.monitors import read_text

CPU = "c: {type: processor, mttf_ref: 400 h, t_ref: 51 degC, t_max: %s degC, u_max: %s}"
BATTERY = (
    "b: {type: battery, failure_rate: 1e-3 1/h, alpha: 1e-3 1/h, beta: 1e-3 1/h, degradation: "
    "1e-3 1/h, t_ref: 25 degC, t_max: %s degC, activation_energy: 0.5}"
)


@pytest.mark.parametrize("part", [CPU % (85, 0.5), CPU % (40, 2), BATTERY % 20, BATTERY % 60])
def test_what_is_in_order_is_within_its_range(part: str) -> None:
    model, problems = read_text(f"horizon: 1 h\nmodels: {{{part}}}\n")
    assert model is not None, problems
    start = at_start(model.data)
    assert start.valid
    assert 0.0 < start.p_fail < at_start(model.data, known=False).p_fail

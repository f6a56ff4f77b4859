"""What numbers per state mean, and what is refused."""

import math

import pytest
from eddi_runtime.bayesian_network.outputs import EvidenceError, finding, outcomes_finding

STATES = ("low", "mid", "high")


@pytest.mark.parametrize(
    ("values", "want"),
    [
        ([0.0, 0.0, 0.0], None),
        ([0, False, 0.0], None),
        ([0.0, 1.0, 0.0], 1),
        ([0.0, 0.0, 0.4], 2),
        ([True, 0, 0], 0),
        ([7.0, 3.0, 0.0], [1.0, 3.0 / 7.0, 0.0]),
        ([0.3, 0.3, 0.3], [1.0, 1.0, 1.0]),
        ((0.0, 2, 1), [0.0, 1.0, 0.5]),
        ([5e-324, 5e-324, 0.0], [1.0, 1.0, 0.0]),
    ],
)
def test_evidence_rule(values, want):
    assert finding(values, STATES) == want
    assert outcomes_finding(dict(zip(STATES, values)), STATES) == want


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ([math.nan, 0.0, 0.0], "low is nan, not a finite number from 0 on"),
        ([0.0, math.inf, 0.0], "mid is inf, not a finite number from 0 on"),
        ([0.5, 0.0, -0.5], "high is -0.5, not a finite number from 0 on"),
        ([0.0, -1.0, 0.0], "mid is -1.0, not a finite number from 0 on"),
        ([0.0, "1", 0.0], "mid is '1', which is no number"),
        ([0.0, None, 0.0], "mid is an object of type NoneType, which is no number"),
        ([1.0, 0.0], "2 values for 3 states"),
        ([1.0], "1 values for 3 states"),
    ],
)
def test_what_is_no_evidence(values, reason):
    with pytest.raises(EvidenceError, match=f"^{reason}$"):
        finding(values, STATES)


@pytest.mark.parametrize(
    ("values", "want"),
    [
        ([0.0, 1.0, 0.0], 1),
        ([0.0, 0.9999999999999999, 0.0], 1),
        ([0.0, 0.9999999, 0.0], None),
        ([0.0, 0.4, 0.0], None),
        ([0.7, 0.3, 0.0], None),
        ([1.0, 1.0, 0.0], None),
    ],
)
def test_the_rule_of_d72(values, want):
    assert finding(values, STATES, virtual=False) == want

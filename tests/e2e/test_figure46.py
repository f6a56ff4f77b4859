"""The check of the demonstration finds monitors that misbehave (no ROS needed)."""

import pytest

from tests.e2e import figure46

OFF, ON = {"System_A_G0_c2": False}, {"System_A_G0_c2": True}


def check(*states, steady=True):
    figure46.check_history(figure46.SYSTEM_B, list(states), steady=steady)


def test_a_good_history_passes():
    check(OFF, OFF, ON, ON)


@pytest.mark.parametrize(
    "states", [(), (ON,), (OFF, ON, OFF, ON), (OFF, {"System_A_G0": True})], ids=str
)
def test_a_bad_history_is_found(states):
    with pytest.raises(AssertionError):
        check(*states)


def test_a_lost_guarantee_may_be_allowed():
    check(OFF, ON, OFF, ON, steady=False)


def test_evidence_that_comes_too_late_is_found():
    class Early:
        def states(self, topic):
            return [OFF, ON]

    with pytest.raises(AssertionError, match="before its evidence"):
        figure46.never_active(Early(), figure46.SYSTEM_B)

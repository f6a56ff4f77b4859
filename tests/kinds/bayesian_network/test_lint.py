"""Good hand-written methods raise no alarm, damaged ones no traceback; texts are snapshots."""

from __future__ import annotations

from textwrap import indent

import pytest
from hypothesis import given

from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds.bayesian_network.method_module import lint
from tests.fuzz.mutations import mutations

FRAME = """class BayesianNetworkConfig:
    def node_Speed(self):
        # States of Speed: low, high.
{declared}        is_bn_output = False
        outcome_low = 0.0
        outcome_high = 0.0
        '''-----Manual edit begin-----'''  # region: node:Speed
{body}        '''-----Manual edit end-----'''  # region: node:Speed
        return is_bn_output, {{'low': outcome_low, 'high': outcome_high}}
"""
GOOD = """\
speed = self.dra_data.speed
if not math.isfinite(speed):
    pass
elif 1.0 < speed <= 2.0:
    outcome_low = 0.3
    outcome_high = 0.7
else:
    outcome_high = 1.0
"""
DECLARED = "        # Declared: discretised from speed, unless set here.\n"


def module(body: str, declared: str = "") -> Source:
    text = FRAME.format(body=indent(body, " " * 8), declared=declared)
    return Source("bayesian_network_config.py", text.encode())


@pytest.mark.parametrize(
    "body",
    [
        GOOD,
        "is_bn_output = True\n",
        "for state in self.states():\n    outcome_low = max(outcome_low, state)\n",
        "if self.dra_data.speed is None:\n    return is_bn_output, {}\noutcome_low = 1.0\n",
        "outcome_low = self.likelihood()\noutcome_high = 1.0 - outcome_low\n",
    ],
)
def test_a_good_body_raises_no_alarm(body: str) -> None:
    assert lint(module(body)) == []


@pytest.mark.parametrize(("body", "cases"), [("pass\n", []), ("outcome_low = 1.0\n", ["B406"])])
def test_only_a_body_that_sets_something_is_beside_a_declaration(
    body: str, cases: list[str]
) -> None:
    assert [problem.case for problem in lint(module(body, DECLARED))] == cases


@given(mutations(module(GOOD).data))
def test_damaged_modules_are_problems_not_tracebacks(data: bytes) -> None:
    lint(Source("bayesian_network_config.py", data))

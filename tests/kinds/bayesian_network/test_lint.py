"""What is often wrong in hand-written methods: a body each, its exact text, no false alarm."""

from __future__ import annotations

from pathlib import Path
from textwrap import indent

import pytest
from hypothesis import given

from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds.bayesian_network.lint import lint
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
elif speed <= 1.0:
    outcome_low = 1.0
elif 1.0 < speed <= 2.0:
    outcome_low = 0.3
    outcome_high = 0.7
else:
    outcome_high = 1.0
"""


def module(body: str, declared: str = "") -> Source:
    text = FRAME.format(body=indent(body, " " * 8), declared=declared)
    return Source("bayesian_network_config.py", text.encode())


def said(source: Source) -> list[str]:
    return [
        f"{one.place.line}: {one.message}" + (f" ({one.hint})" if one.hint else "")
        + f" [{one.code}]"
        for one in lint(source)
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("body", "wanted"),
    [
        (
            "if math.isfinite(x) and x <= 1:\n    outcome_low = 1.0\n",
            (
                "8: a path through node_Speed sets no outcome: the node is unobserved there "
                "(is an `else` missing?) [B410]"
            ),
        ),
        (
            "if self.dra_data.slow:\n    outcome_low = 1.0\nelse:\n    outcome_high = 0.0\n",
            (
                "11: node_Speed: this `else` sets an outcome to 0, which it is already "
                "(is 1.0 meant?) [B411]"
            ),
        ),
        (
            "outcome_hihg = 1.0\n",
            "8: node_Speed has no 'outcome_hihg' (did you mean 'outcome_high'?) [B412]",
        ),
        (
            "outcome_low = 1.0\noutcome_high = 1\n",
            (
                "9: a path through node_Speed sets outcome_high and outcome_low to 1 "
                "(two certain states contradict each other: set one) [B413]"
            ),
        ),
        (
            "is_bn_output = True\noutcome_low = 1.0\n",
            "8: node_Speed is an output and evidence at once: it only echoes what is set [B414]",
        ),
        (
            "if self.dra_data.speed <= 1:\n    outcome_low = 1.0\nelse:\n    outcome_high = 1.0\n",
            (
                "11: node_Speed: NaN takes this `else` (test for it first (math.isfinite), or "
                "declare the node in the configuration) [B415]"
            ),
        ),
        (
            (
                "if isnan(x):\n    pass\nelif x <= 1:\n    outcome_low = 1.0\n"
                "elif 1.5 < x:\n    outcome_high = 1.0\nelse:\n    outcome_high = 1.0\n"
            ),
            "12: node_Speed: the comparisons leave a gap between 1 and 1.5 [B416]",
        ),
        (
            (
                "if isnan(x):\n    pass\nelif x <= 1:\n    outcome_low = 1.0\n"
                "elif x > 0.5 and x < 3:\n    outcome_high = 1.0\nelse:\n    outcome_high = 1.0\n"
            ),
            "12: node_Speed: the comparisons overlap between 1 and 0.5 [B416]",
        ),
        ("outcome_low = 1.5\n", "8: node_Speed: an outcome of 1.5 is outside [0, 1] [B417]"),
    ],
)
def test_a_fault_is_told_with_its_line(body: str, wanted: str) -> None:
    found = said(module(body))
    if "B411" in wanted:  # such a body leaves the node unobserved as well
        found = [one for one in found if "B410" not in one]
    assert found == [wanted]


def test_a_declared_node_that_is_set_by_hand() -> None:
    declared = "        # Declared: discretised from speed, unless set here.\n"
    assert said(module("outcome_low = 1.0\n", declared)) == [
        (
            "9: node_Speed is declared in the configuration and set here, which takes precedence "
            "(remove the declaration, or this body) [B406]"
        )
    ]
    assert said(module("pass\n", declared)) == []
    (one,) = said(module("if self.dra_data.slow:\n    outcome_low = 1.0\n", declared))
    assert one.endswith("[B406]")  # and no B410: where nothing is set, the declaration applies


@pytest.mark.parametrize(
    "body",
    [
        GOOD,
        "pass\n",
        "is_bn_output = True\n",
        "for state in self.states():\n    outcome_low = max(outcome_low, state)\n",
        "if self.dra_data.speed is None:\n    return is_bn_output, {}\noutcome_low = 1.0\n",
        "outcome_low = self.likelihood()\noutcome_high = 1.0 - outcome_low\n",
    ],
)
def test_a_good_body_raises_no_alarm(body: str) -> None:
    assert said(module(body)) == []


def test_what_is_no_python() -> None:
    (problem,) = lint(Source("bayesian_network_config.py", b"def node_A(:\n"))
    assert (problem.code, problem.level, problem.place.line) == ("B418", "error", 1)


def test_check_looks_at_the_module_of_a_package(tmp_path: Path) -> None:
    from tests.cli.command import run

    path = tmp_path / "bayesian_network_config.py"
    path.write_bytes(module("outcome_low = 1.5\n").data)
    result = run("check", path, cwd=tmp_path)
    assert result.status == 0
    assert "bayesian_network_config.py:8: warning: " in result.err
    assert run("export", path, "-o", "out", cwd=tmp_path).status == 2


@given(mutations(module(GOOD).data))
def test_damaged_modules_are_problems_not_tracebacks(data: bytes) -> None:
    lint(Source("bayesian_network_config.py", data))

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
            "outcome_hihg = 1.0\n",
            "8: node_Speed has no 'outcome_hihg' (did you mean 'outcome_high'?) [B412]",
        ),
        (
            "is_bn_output = True\noutcome_low = 1.0\n",
            "8: node_Speed is an output and evidence at once: it only echoes what is set [B412]",
        ),
        ("outcome_low = 1.5\n", "8: node_Speed: an outcome of 1.5 is outside [0, 1] [B412]"),
    ],
)
def test_a_fault_is_told_with_its_line(body: str, wanted: str) -> None:
    assert said(module(body)) == [wanted]


def test_a_declared_node_that_is_set_by_hand() -> None:
    declared = "        # Declared: discretised from speed, unless set here.\n"
    assert said(module("outcome_low = 1.0\n", declared)) == [
        (
            "9: node_Speed is declared in the configuration and set here, which takes precedence "
            "(remove the declaration, or this body) [B406]"
        )
    ]
    assert said(module("pass\n", declared)) == []


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

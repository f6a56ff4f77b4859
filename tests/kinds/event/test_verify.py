"""What `verify` says of the text of events: no single change is called proved."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.packages.verifying import checked
from tests.evidence.mutants import mutants

EVENTS = """\
ENUM Mode { AUTO, MANUAL }
VAR x : NUMBER UNIT m RANGE 0 .. 40
VAR y : NUMBER TIMEOUT 1s
VAR mode : Mode
VAR ok : BOOL
EVENT Near (EVIDENCE) := NOT ONCE(x < 1.5 m, 1s) AND (ok OR KNOWN(y)) AND mode == AUTO
EVENT Fast (HAZARD) := AVERAGE(y, 2s, COVERAGE 0.5) + y * 2 > 3 OR LATCH(ok, y > 7)
EVENT Old (HAZARD) := AGE(y) > 0.2 s
EVENT Band (EVIDENCE) := HYSTERESIS(y, 1, 2) XOR RISE(ok)
"""


@pytest.mark.slow
def test_every_mutant_is_seen(tmp_path: Path) -> None:
    (tmp_path / "rich.events").write_text(EVENTS, "utf-8")
    (monitor,), _ = monitors_of(tmp_path / "rich.events", [])
    text = monitor.compiled.text
    assert checked(monitor, text) == (
        ["conditions of Near, Fast, Old, Band", "the table of inputs"],
        [],
    )
    original, count = ast.parse(text).body[1:], 0
    for mutant in mutants(text):
        body = ast.parse(mutant).body[1:]  # without the docstring
        if [*map(ast.dump, body)] != [*map(ast.dump, original)]:
            assert checked(monitor, mutant)[1] != [], mutant
            count += 1
    assert count > 300

"""Ports of an EDDI that nobody connected: read with a warning, but no evidence rests on them."""

from __future__ import annotations

from pathlib import Path

from eddi_scaffold.kinds import Options
from tests.kinds.reliability.monitors import models_of
from tests.kinds.reliability.test_reliability_diagnostics import HEAD, PACKAGE

TREE = """<failureModels xsi:type="f:FaultTree" name="T">
<failures name="out" originType="Output"/>
<causes xsi:type="f:Gate" name="Top" failure="$.0/@failures.0" causes="$.0/@causes.1"/>
<causes xsi:type="f:Gate" name="Port" gateType="InputEvent"/></failureModels>
"""


def test_no_threshold_trusts_a_tree_with_an_open_port(tmp_path: Path) -> None:
    path = tmp_path / "model.xml"
    body = TREE.replace("$", PACKAGE)
    path.write_text(HEAD + body + "</odeProductPackages></i:DDIPackage>\n", "utf-8")
    models, problems = models_of(path)
    assert [(one.level, one.code) for one in problems] == [("warning", "X014")]
    assert models["T"].configure(Options())[0] is not None
    options = Options(values={"thresholds": [{"id": "go", "activate": 0.1}]})
    configured, problems = models["T"].configure(options)
    assert configured is None
    (one,) = problems
    assert (one.code, one.place.line) == ("R005", 10)
    assert one.message == (
        "port 'Port' has no input: what it represents is left out, so that no threshold may "
        "trust p_fail of 'T'"
    )

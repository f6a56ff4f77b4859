"""Age limits, and what one monitor reads of another."""

from pathlib import Path

import pytest

from eddi_scaffold.common.files import Source
from eddi_scaffold.deployments.checking import check_files
from eddi_scaffold.monitors.config_reading import read_config
from eddi_scaffold.monitors.publications import check_limits
from tests.checkouts import HERE

CONFIG = """
Model: {{id: A, type: ConSert}}
SimulatorOutputs: [{{id: b, type: std_msgs.Bool, topic: /b/free{source}}}]
EDDIInputs:
- {{id: D, requires: [b], max_age: {max_age}}}
"""


@pytest.mark.parametrize(
    ("max_age", "source", "told"),
    [
        ("500", "", ["5:K029: 'D'"]),
        ("5", ", max_age: 500", ["3:K029: 'b'"]),
        ("99", "", []),
        ("none", "", []),
        ("null", "", []),
    ],
)
def test_an_age_in_milliseconds_is_a_warning(max_age: str, source: str, told: list[str]) -> None:
    text = CONFIG.format(max_age=max_age, source=source)
    config, problems = read_config(Source("a.yml", text.encode()))
    assert config is not None, problems
    found = [f"{p.place.line}:{p.code}: {p.message}" for p in check_limits(config)]
    why = "counts as known for 500 s after its source has died: `max_age` is in seconds"
    assert found == [f"{one} {why}" for one in told]


ROVER = HERE / "examples" / "rover-events"
NETWORK = HERE / "examples" / "pedestrian"


TITLE = "risk.output_nodes[Critcal].outcomes[x].outcome_value"
OUTCOME = "risk.output_nodes[Critical].outcomes[hihg].outcome_value"


@pytest.mark.parametrize(
    ("field", "hint"),
    [
        ("output_nodes[Criticl].outcomes[Yes].outcome_value", "Critical"),
        ("output_nodes[Critical].outcomes[Yess].outcome_value", "Yes"),
    ],
)
def test_an_output_of_what_the_network_does_not_have(tmp_path: Path, field: str, hint: str) -> None:
    network = tmp_path / "network.yml"
    text = (NETWORK / "eddi_config.yml").read_text("utf-8")
    network.write_text(f"{text}  - {{id: one, topic: one, field: '{field}'}}\n", "utf-8")
    problems = check_files((NETWORK / "pedestrian.xml", network))
    (problem,) = [one for one in problems if one.code == "K020"]
    assert problem.hint == f"did you mean {hint!r}?"
    assert problem.place.line == len(text.splitlines()) + 1

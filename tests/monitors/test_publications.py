"""Age limits, and outputs of what a monitor does not have."""

import pytest

from eddi_scaffold.common.files import Source
from eddi_scaffold.deployments.checking import check_files
from eddi_scaffold.monitors.config_reading import read_config
from eddi_scaffold.monitors.publications import check_limits
from tests.checkouts import HERE
from tests.data_files import tabled
from tests.diagnosed import assert_reported

CONFIG = """
Model: {{id: A, type: ConSert}}
SimulatorOutputs: [{{id: b, type: std_msgs.Bool, topic: /b/free{source}}}]
EDDIInputs:
- {{id: D, requires: [b], max_age: {max_age}}}
"""
NETWORK = HERE / "examples" / "pedestrian"


@pytest.mark.parametrize(
    ("max_age", "source", "lines"),
    [("500", "", [5]), ("5", ", max_age: 500", [3]), ("99", "", []), ("none", "", [])],
)
def test_an_age_in_milliseconds_is_a_warning(max_age: str, source: str, lines: list[int]) -> None:
    text = CONFIG.format(max_age=max_age, source=source)
    config, problems = read_config(Source("a.yml", text.encode()))
    assert config is not None, problems
    reported = list(check_limits(config))
    assert [problem.place.line for problem in reported] == lines
    if lines:
        assert_reported("K029", reported)


@tabled
def test_an_output_of_what_the_network_does_not_have(field, hint, tmp_path):
    network = tmp_path / "network.yml"
    text = (NETWORK / "eddi_config.yml").read_text("utf-8")
    network.write_text(f"{text}  - {{id: one, topic: one, field: '{field}'}}\n", "utf-8")
    problems = check_files((NETWORK / "pedestrian.xml", network))
    (problem,) = [problem for problem in problems if problem.code == "K020"]
    assert problem.hint == f"did you mean {hint!r}?"
    assert problem.place.line == len(text.splitlines()) + 1

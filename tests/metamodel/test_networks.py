"""Bayesian networks with what is known of them and what is wanted."""

from typing import Any

import pytest

from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds.bayesian_network.cross_check import posteriors
from eddi_scaffold.monitors.loading import read_models
from tests.kinds.bayesian_network.networks import joined, running
from tests.metamodel.expected import FOLDER, cases, models

CASES = cases("bayesian_network")


@pytest.mark.parametrize(("file", "want"), CASES, ids=[file for file, _ in CASES])
def test_content_outputs_and_posteriors(file: str, want: dict[str, Any]) -> None:
    (model,) = (one for one in models(file) if one.name == want["name"])
    assert {node.id: list(node.states) for node in model.data.nodes} == want["nodes"]
    assert {node.id: list(node.parents) for node in model.data.nodes} == want["parents"]
    assert dict(model.data.known) == want.get("evidence", {"Wind": None})
    monitor, problems = joined(model)
    assert monitor is not None, problems
    assert list(monitor.model.settings.outputs) == want["targets"]
    for row in want["posteriors"]:
        found = posteriors(running(monitor), row["given"])
        for node, states in row["of"].items():
            assert list(found[node]) == pytest.approx(list(states.values()), rel=1e-9, abs=1e-15)


def test_what_states_mean_is_said_to_be_unused() -> None:
    text = (FOLDER / "07_bayesian_network.xml").read_text("utf-8")
    state = '<nodeStates name="fog"/>'
    assert text.count(state) == 1
    text = text.replace(state, '<nodeStates name="fog"><dimension/></nodeStates>')
    (said,) = (
        one
        for one in read_models(Source("07.xml", text.encode())).problems
        if "dimension" in one.message
    )
    assert (said.code, said.level) == ("X014", "info")

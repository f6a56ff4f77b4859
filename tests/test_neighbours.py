"""Monitors that feed each other."""

from __future__ import annotations

import pytest

from eddi_scaffold.config import read_config
from eddi_scaffold.neighbours import check_neighbours
from eddi_scaffold.source import Source

PROVIDER = b"""
Model: {id: B, type: ConSert, frequency: 2}
EDDIOutputs: [{id: b, topic: /b/guarantees}]
"""
CONSUMER = """
Model: {{id: A, type: ConSert}}
SimulatorOutputs: [{{id: b, type: eddi_messages.ConSertOutput, topic: /b/guarantees}}]
EDDIInputs:
- {{id: D, requires: [b], max_age: {max_age}}}
"""


def found(max_age: str) -> list[str]:
    configs = []
    for name, data in (("b.yml", PROVIDER), ("a.yml", CONSUMER.format(max_age=max_age).encode())):
        config, problems = read_config(Source(name, data))
        assert config is not None, problems
        configs.append(config)
    return [f"{p.place.line}:{p.code}: {p.message}" for p in check_neighbours(configs)]


def test_an_age_below_two_periods_of_the_provider_is_a_warning() -> None:
    assert found("0.5") == [
        "5:K029: input 'D' is unknown after 0.5 s, but B publishes only every 0.5 s"
    ]


@pytest.mark.parametrize("max_age", ["1.0", "none", "null"])
def test_longer_and_absent_ages_are_fine(max_age: str) -> None:
    assert found(max_age) == []

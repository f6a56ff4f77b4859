"""Fault trees written as Open-PSA: read back, and compared with SCRAM where it is installed."""

import random

import pytest

from eddi_scaffold.kinds.reliability.system import (
    BasicEvent,
    ComponentModel,
    FaultTree,
    Gate,
    Law,
    ReliabilitySystem,
)
from eddi_scaffold.kinds.reliability.trial import at_start
from eddi_scaffold.kinds.reliability.write import to_open_psa
from tests.kinds.reliability.monitors import sound
from tests.kinds.reliability.test_mef import read


def drawn(chance: random.Random) -> ReliabilitySystem:
    """Return a random tree of every gate and law that the format has."""
    laws = [
        lambda: Law("exponential", (chance.random() * 2,)),
        lambda: Law("weibull", (chance.random() * 3 + 0.1, chance.random() * 3 + 0.3)),
        lambda: Law("fixed", (chance.choice([0.0, 1.0, chance.random()]),)),
    ]
    names = [f"E{k}" for k in range(chance.randint(2, 6))]
    events = {name: BasicEvent(name, chance.choice(laws)()) for name in names}
    gates = {}
    for k in range(chance.randint(1, 5)):
        of = chance.choice(["AND", "OR", "XOR", "NOT", "VOTE"])
        count = 1 if of == "NOT" else chance.randint(1, min(4, len(names)))
        below = tuple(chance.sample(names, count))
        least = chance.randint(1, count) if of == "VOTE" else None
        names.append(f"G{k}")
        gates[f"G{k}"] = Gate(f"G{k}", of, below, least)
    content = FaultTree(names[-1], events, gates)
    return ReliabilitySystem({"T": ComponentModel("T", "fault_tree", content)}, "T")


def test_what_is_written_is_read_back() -> None:
    chance = random.Random(1)
    for _ in range(100):
        system = drawn(chance)
        text = to_open_psa(system)
        assert text is not None
        reading = read(text)
        assert reading.problems == (), text
        found = at_start(reading.models[0].data).p_fail
        assert found == pytest.approx(at_start(system).p_fail, rel=1e-12), text


@pytest.mark.parametrize(
    "change",
    [
        ("{type: OR, of: [A, B]}", "{type: PAND, of: [A, B]}"),
        ("{rate: 1e-3 1/h}", "{rate: 1e-3 1/h, age: 5 h}"),
        ("    gates:", "    age: 5 h\n    gates:"),
        ("models:", "models:\n  c: {type: k_out_of_n, k: 2, rate: 1e-3 1/h, max: 3}"),
    ],
)
def test_what_the_format_does_not_have_is_not_written(change: tuple[str, str]) -> None:
    text = (
        "models:\n  t:\n    type: fault_tree\n    gates: {T: {type: OR, of: [A, B]}}\n"
        "    events: {A: {rate: 1e-3 1/h}, B: {rate: 1e-4 1/h}}\n"
    )
    assert to_open_psa(sound(text).data) is not None
    assert change[0] in text
    assert to_open_psa(sound(text.replace(*change)).data) is None

"""Compiled reliability models: the text, what of a hostile model is in it, what it imports."""

import math
from collections.abc import Iterable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from eddi_scaffold.common.problems import Place
from eddi_scaffold.kinds.reliability import chains
from eddi_scaffold.kinds.reliability.fault_tree import Gate
from eddi_scaffold.kinds.reliability.system import Arc, Chain, ComponentModel, Observation
from runtime_lib.tests.reliability.reliability_models import (
    Model,
    but,
    chain,
    compiled,
    event,
    model,
    monitor,
    quad,
    series,
    tree,
)
from runtime_lib.tests.reliability.test_unknown_inputs import BATTERY, CPU, ROTORS, UNITS
from tests.program.formatting import HOSTILE, assert_plain_data

ARCS = [[i, j, 0.1 / (1 + i + 2 * j)] for i in range(8) for j in range(8) if i != j]
DENSE = chain(ARCS, 8, [7], observe=[[0, "new", False], [7, "ok", True]])
LARGE = chain([[i, i + 1, 0.5] for i in range(11)], 12, [11], age=2.0)
LARGE = replace(LARGE, name="large")
GO = {"id": "go", "activate": 0.1, "release": 0.2, "hold": 0.5}


def whole(**options: Any) -> Model:
    parts = [BATTERY, CPU, UNITS, quad(0.01), DENSE, LARGE]
    events = [event("model", model=part.name) for part in parts]
    events += [event("exponential", 0.01, age=3.0), event("weibull", 50.0, 2.0, input="w")]
    events += [event("PAND", 0.1, 0.2), event("fixed", 0.25, input="f"), event("POR", 0.1, 0.2)]
    gates = [Gate("XOR", (0, 1, 2, 3)), Gate("OR", tuple(range(4, 12)))]
    inputs = ["battery_level", "battery_temperature", "cpu_temperature", "cpu_utilisation"]
    inputs += ["units_available", *ROTORS, "new", "ok", "tree_w", "tree_f", "mission_end"]
    parts = [*parts, tree(events, gates), series("tree")]
    return model(parts, inputs, thresholds=[GO], on_unknown="worst_case", **options)


def hostile() -> Model:
    events = [event("exponential", 1e-9, name=one) for one in HOSTILE]
    events[0] = events[0]._replace(place='"""\nimport os')
    states = ('"""', "\n")
    seen = tuple(Observation(states[0], one, negated=True) for one in HOSTILE)
    of = Chain(states, states[:1], states[1:], (Arc(*states, 0.1),), seen)
    named = ComponentModel("\n#", "markov", of, place=Place("", path="\\"))
    gates = [Gate("OR", (0, 1)), Gate("OR", tuple(range(2, 12)))]
    names = [('"""\nimport os', "\n#"), ("x" * 500, "\\")]
    top = tree([*events, event("model", model="\n#")], gates, names)
    made = model([named, top], HOSTILE, thresholds=[{**GO, "id": '"\n'}])
    inputs = (replace(one, attribute=f"value {k}") for k, one in enumerate(made.declaration.inputs))
    return made._replace(declaration=replace(made.declaration, inputs=tuple(inputs)))


MODELS = [
    whole(mission_end=False),
    whole(mission_end=True),
    model([quad(0.01)], ROTORS),
    hostile(),
]


@pytest.mark.parametrize("made", MODELS)
def test_the_formatter_changes_nothing_and_nothing_of_a_model_becomes_code(made: Model) -> None:
    assert_plain_data(made.text())


def test_each_python_writes_the_same_digits(monkeypatch: pytest.MonkeyPatch) -> None:
    """From Python 3.12 on, ``sum`` adds floats in another way."""
    texts = []
    for add in (_one_by_one, math.fsum):
        monkeypatch.setattr(chains, "sum", add, raising=False)
        texts.append([one.text() for one in MODELS])
    assert texts[0] == texts[1]


def _one_by_one(values: Iterable[float]) -> float:
    whole = 0.0
    for value in values:
        whole += value
    return whole


def test_a_hostile_model_works() -> None:
    one = hostile().monitor()
    source = SimpleNamespace(**{f"value {k}": False for k in range(len(HOSTILE))})
    assert one.execute_step(source, 0).valid
    vars(source)["value 2"] = True
    assert one.execute_step(source, 0).p_fail == 1.0


@pytest.mark.slow
def test_very_many_units_are_counted() -> None:
    one = monitor([but(UNITS, k=4990, rate=1e-3, max=None)], ["units_available"])
    known = one.execute_step(SimpleNamespace(units_available=5000), 0)
    fewer = one.execute_step(SimpleNamespace(units_available=4995), 0)
    assert 0.0 < known.p_fail < fewer.p_fail < 1.0
    assert known.p_fail + known.reliability == pytest.approx(1.0, rel=1e-9)


def test_two_monitors_of_one_text_are_independent() -> None:
    module = compiled([quad(0.01)], ROTORS, states=8)
    one, other = module.Monitor(), module.Monitor()
    working: dict[str, Any] = dict.fromkeys(ROTORS, True)
    assert (
        one.execute_step(SimpleNamespace(**{**working, "rotors_motor_1": False}), 0).p_fail == 1.0
    )
    assert other.execute_step(SimpleNamespace(**working), 0).p_fail < 0.05
    assert one.execute_step(SimpleNamespace(**working), 10**8).p_fail == 1.0

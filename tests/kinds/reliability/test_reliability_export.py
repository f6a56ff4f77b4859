"""A system that uses every key of ``reliability_config.yml`` is exported as the same system."""

from __future__ import annotations

import re

import pytest

from eddi_scaffold.kinds.reliability.show import outline, readme
from eddi_scaffold.kinds.reliability.system import ReliabilitySystem
from eddi_scaffold.kinds.reliability.write import to_yaml
from tests.kinds.reliability.monitors import read_text

EVERY_KEY = """
horizon: mission_end
mission_time: 3 h
top: Loss
models:
  Rotors: {type: propulsion, configuration: PNPNPN, rates: [1e-5 1/h, 1e-5 1/h, 2e-5 1/h, 1e-5 1/h,
    1e-5 1/h, 1e-5 1/h], positions: [1, 0, 2, 3, 4, 5], status: list}
  Cells: {type: battery, failure_rate: 1e-4 1/h, alpha: 0.1 1/h, beta: 0.2 1/h,
    degradation: 0.3 1/h, t_ref: 293.15 K, t_max: 60 degC, activation_energy: 0.4}
  Board: {type: processor, mttf_ref: 10000 h, t_ref: 25 degC, t_max: 90 degC, u_max: 0.8,
    activation_energy: 0.3, shape: 1.5, age: 500 h}
  Links: {type: k_out_of_n, k: 2, rate: 3000 FIT, max: 4}
  Power: {type: series, of: [Cells, Board]}
  Camera:
    type: markov
    initial: [Fine]
    states: [Fine, Blurred, Lost]
    fail: [Lost]
    arcs: [{from: Fine, to: Blurred, rate: 1 1/day}, {from: Blurred, to: Lost, rate: 2 1/h}]
    observe: {Fine: sharp, Lost: not alive}
    repair: true
  Radio:
    type: markov
    states: [Up, Down]
    initial: [Up]
    fail: [Down]
    arcs: [{from: Up, to: Down, rate: 1e-3 1/h}]
    age: 12 h
  Loss:
    type: fault_tree
    top: Top
    gates:
      Top: {type: OR, of: [Two, Parts, First, CameraFails, RadioFails, LinksFail, Two]}
      Two: {type: VOTE, k: 2, of: [Valve, Pump, Seal]}
      Parts: {type: AND, of: [RotorsFail, PowerFails]}
      First: {type: PAND, of: [Left, Right]}
    events:
      Valve: {rate: 1e-6 1/h, observed: true}
      Pump: {scale: 900 h, shape: 2, age: 20 h}
      Seal: {p: 1e-3}
      Left: {rate: 1e-6 1/h}
      Right: {rate: 1e-6 1/h}
      RotorsFail: {model: Rotors}
      PowerFails: {model: Power}
      CameraFails: {model: Camera}
      RadioFails: {model: Radio}
      LinksFail: {model: Links}
    repair: true
    age: 100 h
thresholds:
  - {id: go, activate: 1e-4, release: 2e-4, hold: 1 s, topic: /rte/go}
  - {id: stop, activate: 1e-3, release: 1e-3, hold: 250 ms}
on_unknown: worst_case
max_gap: 3 s
"""


def read(text: str) -> ReliabilitySystem:
    model, problems = read_text(text)
    assert [one for one in problems if one.level == "error"] == []
    assert model is not None
    system = model.data
    assert isinstance(system, ReliabilitySystem)
    return system


CHANGES = {
    "as it is": ("", ""),
    "a fixed horizon": ("horizon: mission_end\nmission_time: 3 h", "horizon: 30 min"),
    "nothing is accepted": ("on_unknown: worst_case\nmax_gap: 3 s\n", ""),
    "cut sets": ("    age: 100 h", "    approximation: cut_sets\n    node_limit: 5000"),
    "one rate": ("rates: [1e-5 1/h, 1e-5 1/h, 2e-5 1/h, 1e-5 1/h,\n    1e-5 1/h, 1e-5 1/h]",
                 "rate: 1e-5 1/h"),
}  # fmt: skip


@pytest.mark.parametrize("change", CHANGES)
def test_what_is_exported_reads_back_as_the_same(change: str) -> None:
    old, new = CHANGES[change]
    assert old in EVERY_KEY
    system = read(EVERY_KEY.replace(old, new, 1))
    text = to_yaml(system)
    assert read(text) == system, text
    assert to_yaml(read(text)) == text


def test_every_key_is_exported() -> None:
    keys = set(re.findall(r"\b([a-z][a-z_]*): ", EVERY_KEY))
    text = to_yaml(read(EVERY_KEY))
    assert {key for key in keys if not re.search(rf"\b{key}\b", text)} == set()


def test_every_key_is_shown() -> None:
    shown = "\n".join(outline(read(EVERY_KEY)))
    for line in (
        "threshold go: p_fail <= 0.0001, gone above 0.0002, after 1 s",
        "threshold stop: p_fail <= 0.001, gone above 0.001, after 0.25 s",
        "rates: 1e-05 1/h, 1e-05 1/h, 2e-05 1/h, 1e-05 1/h, 1e-05 1/h, 1e-05 1/h",
        "Fine (initial)\n    -> Blurred",
        "age 12 h",
        "2/3 Two",
        "PAND First",
        "Valve  1e-06 1/h, observed",
        "Pump  Weibull 900 h, shape 2, age 20 h",
        "Seal  p 0.001",
        "PowerFails  model Power",
        "2/3 Two (see above)",
    ):
        assert line in shown, shown


def test_the_readme_has_the_numbers_of_the_start() -> None:
    lines = readme(read(EVERY_KEY))
    assert lines[0].startswith("`Loss` fails within 3 h (the mission's end) with probability ")
    assert "| go | 0.0001 | 0.0002 | 1 s |" in lines
    assert "While an input is unknown, its worst case counts." in lines
    assert "- Seal, Valve" in lines

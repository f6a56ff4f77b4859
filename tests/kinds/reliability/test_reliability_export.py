"""A system that uses every key of ``reliability_config.yml`` is exported as the same system."""

import re
from pathlib import Path

import pytest

from eddi_scaffold.kinds.reliability.show import outline, readme
from eddi_scaffold.kinds.reliability.system import ReliabilitySystem
from eddi_scaffold.kinds.reliability.write import to_yaml
from tests.kinds.reliability.monitors import read_text

EVERY_KEY = (Path(__file__).parents[2] / "data/reliability/every_key.yml").read_text("utf-8")


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

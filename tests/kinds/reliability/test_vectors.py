"""Vectors of reliability models: monitors pass them, mutants are killed or equal."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import yaml
from eddi_runtime.testing import failures

from eddi_scaffold.kinds import Model
from eddi_scaffold.kinds.reliability.compile import compile_system
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.packages.verifying import checked
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import Declaration
from runtime_lib.tests.bound_models import loaded
from tests.evidence.mutants import Mutated, input_class, mutants
from tests.kinds.reliability.monitors import sound

EXAMPLES = Path(__file__).parents[3] / "examples"
MODELS = yaml.safe_load(Path(__file__).with_name("models_with_vectors.yml").read_text("utf-8"))
WAREHOUSE = None, [EXAMPLES / "warehouse-robot" / "robot.yml"]
DRONE = EXAMPLES / "drone" / "drone.xml", [EXAMPLES / "drone" / "reliability_config.yml"]


def failures_of(model: Model, compiled: Model, folder: Path, **unit: Any) -> list[str]:
    """Return what a monitor does otherwise than the vectors of a model say."""
    inputs = tuple(
        BoundInput(of.id, of.id, ("x",), 0.5, unit.get(of.unit or "")) for of in model.inputs()
    )
    vectors = folder / "vectors.json"
    vectors.write_text(model.vectors(inputs, {}))
    declaration = Declaration("m", "", inputs)
    monitor = loaded("reliability", compile_system(compiled.data, declaration), declaration).Monitor
    return failures(str(vectors), monitor, input_class(monitor))


@pytest.mark.parametrize("name", MODELS)
def test_the_monitor_of_a_model_passes(name: str, tmp_path: Path) -> None:
    model = sound(MODELS[name])
    assert failures_of(model, model, tmp_path) == []
    assert failures_of(model, model, tmp_path, percent=(100, 1)) == []


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("horizon: 5 h", "horizon: mission_end\nmission_time: 5 h"),
        ("rate: 0.3", "rate: 3.0e6"),
    ],
)
def test_larger_models_have_no_complete_vectors(before: str, after: str) -> None:
    inputs = tuple(BoundInput(of, of, ("x",), 0.5, None) for of in ("a_ok", "f_seen"))
    text = sound(MODELS["markov"].replace(before, after)).vectors(inputs, {})
    assert '"complete": true' not in text


def test_a_model_with_heat_and_propulsion_has_no_vectors() -> None:
    airframe = sound((EXAMPLES / "drone" / "airframe.yml").read_text("utf-8"))
    assert airframe.vectors((), {}) == ""


OTHERS = [
    ("k", "k: 3", "k: 2"),
    ("battery", "beta: 7.0e-3", "beta: 8.0e-3"),
    ("markov", "from: C, to: F, rate: 0.3", "from: C, to: F, rate: 0.31"),
    ("markov", "A: a_ok", "B: a_ok"),
    ("trees", "k: 2", "k: 3"),
    ("trees", "of: [b, c]", "of: [b, d]"),
    ("parts", "age: 3 h", "age: 4 h"),
]


@pytest.mark.parametrize(("name", "before", "after"), OTHERS)
def test_the_monitor_of_another_model_fails(
    name: str, before: str, after: str, tmp_path: Path
) -> None:
    model, other = sound(MODELS[name]), sound(MODELS[name].replace(before, after))
    assert model != other
    assert failures_of(model, other, tmp_path)


def observed(monitor_class: Any, values: Sequence[Sequence[Any]]) -> Iterator[tuple[Any, ...]]:
    """Yield the results of steps: from any observation to any other, soon and late."""
    names = [spec.attribute for spec in monitor_class.inputs]
    for first, then in itertools.product(itertools.product(*values), repeat=2):
        monitor = monitor_class()
        rows = (first, 0), (then, 10**8), (then, 6 * 10**9), (first, 36 * 10**11), (first, 0)
        for row, now in rows:
            source = SimpleNamespace(**dict(zip(names, row, strict=True)))
            result = monitor.execute_step(source, now)
            yield (*result[:7], *result.evidence.values(), len(result.unknown), bool(result.reason))


@pytest.mark.parametrize(
    ("of", "name", "values", "share"),
    [
        (WAREHOUSE, "power", ((100, 74.0, 49.0, 20.0, None, "x"), (4, 3, 2, None, 2.5)), 0.08),
        (DRONE, "MissionLoss", ((True, False, None, "x"), (True, False, None, "x")), 0.3),
    ],
)
def test_each_mutant_is_killed_seen_or_equal(
    of: Any, name: str, values: Any, share: float, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    """A mutant that the vectors do not kill is equal to 1e-9, or `verify` sees it."""
    monitor = next(m for m in monitors_of(*of)[0] if m.id == name)
    mutated = Mutated(monitor, tmp_path)
    assert checked(monitor, f"{mutated.head}\n{mutated.body}")[1] == []
    number = Counter[str]()
    for text in mutants(mutated.body, mutated.drawn(request, share)):
        is_killed, mutant = mutated.killed(text)
        how = "vectors kill it" if is_killed else "verify sees it"
        number[how] += 1
        if not is_killed and not checked(monitor, f"{mutated.head}\n{text}")[1]:
            steps = (observed(of, values) for of in (mutated.original, mutant))
            for row, other in zip(*steps, strict=True):
                assert all(map(is_same, row, other)), text
    assert number["vectors kill it"] > number["verify sees it"]


def is_same(value: float, other: float) -> bool:
    return (
        math.isclose(value, other, rel_tol=1e-9) or math.isnan(value) is math.isnan(other) is True
    )

"""The kind as a whole: what is generated, what it says of itself, what goes to the robot."""

import hashlib
import random
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.kinds.safeml import KIND
from eddi_scaffold.kinds.safeml.scope import Design, Plan
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.platforms.ros_packages import messages_of
from eddi_scaffold.recordings.playing import compiled
from tests.kinds.safeml.monitors import CONNECTED, LONG_NAMES, joined, running

_CHANCE = random.Random(11)
ROWS = [[round(_CHANCE.gauss(5, 1), 3), _CHANCE.gauss(0, 2)] for _ in range(300)]
FIGURE = {
    "window_size": 10,
    "significance_level": 0.1,
    "distance_metric": "'KolmogorovSmirnovDistance'",
}


def plan_of(folder: Path, **keys: object) -> Plan:
    monitor, _ = joined(folder, ROWS, **{**FIGURE, **keys})
    plan: Plan = monitor.model.options.plan
    return plan


def test_the_violation_is_spelt_as_the_document_has_it_where_asked(tmp_path: Path) -> None:
    asked = CONNECTED.replace("type: SafeML", "type: SafeML, violation_field: oddViolation")
    texts = {}
    for config in (CONNECTED, asked):
        monitor, problems = joined(tmp_path, ROWS, config, **FIGURE)
        assert problems == []
        assert monitor.config is not None
        answers = {"kind": "safeml", "config": monitor.config.as_data()}
        texts[config] = messages_of({"scope": answers})["SafeMLOutput"]
    assert "bool odd_violation\n" in texts[CONNECTED]
    assert "bool oddViolation\n" in texts[asked]
    wrong = asked.replace("oddViolation", "Violation")
    with pytest.raises(EddiError, match="must be odd_violation or oddViolation"):
        joined(tmp_path, ROWS, wrong, **FIGURE)


@pytest.mark.parametrize(
    ("requires", "expression"),
    [
        ("requires: [features], field: data", "features"),  # whole arrays fill it
        ("requires: [features, more]", "joined(features, more.data)"),
        ("requires: [scan], field: ranges", "scan.ranges"),
        ("requires: [scan]", None),  # a person writes the region
    ],
)
def test_messages_are_joined(requires: str, expression: str | None, tmp_path: Path) -> None:
    connected = CONNECTED.replace(
        "SimulatorOutputs: [",
        "SimulatorOutputs: [{id: scan, type: sensor_msgs.LaserScan, topic: /scan}, "
        "{id: more, type: std_msgs.Float64, topic: /more}, ",
    )
    config = connected.replace("requires: [features], field: data", requires)
    (binding,) = joined(tmp_path, ROWS, config, **FIGURE)[0].inputs
    assert (binding.expression, binding.model.every_message) == (expression, True)


@pytest.mark.parametrize(
    ("type_", "key", "dtype"),
    [
        ("std_msgs.Float32MultiArray", "auto", "float32"),
        ("std_msgs.Float64MultiArray", "auto", "float64"),
        ("sensor_msgs.LaserScan", "auto", "float32"),
        ("std_msgs.Float64MultiArray", "float32", "float32"),
        ("std_msgs.Float32MultiArray", "float64", "float64"),
    ],
)
def test_element_type(type_: str, key: str, dtype: str, tmp_path: Path) -> None:
    connected = CONNECTED.replace("std_msgs.Float32MultiArray", type_)
    if "Laser" in type_:
        connected = connected.replace("field: data", "field: ranges")
    monitor, _ = joined(tmp_path, ROWS, connected, **FIGURE, input_dtype=key)
    assert monitor.model.options.plan.single == (dtype == "float32")


def test_quantised_samples_in_float32_do_not_violate(tmp_path: Path) -> None:
    """A constant column of 0.1 is another number in float32: both sides are rounded."""
    rows = [[0.1, round(_CHANCE.gauss(0, 1), 1)] for _ in range(600)]
    keys = {**FIGURE, "window_size": 50, "calibration": "iid"}
    monitor = compiled(joined(tmp_path, rows, CONNECTED, **keys)[0])
    violations = 0
    for row in rows[300:]:
        sample = np.array(row, dtype=np.float32)
        violations += monitor.execute_step(SimpleNamespace(sample=sample), 0).odd_violation
    assert violations <= 0.1 * 300
    careless = running(tmp_path, rows, **keys)
    for row in rows[300:]:
        sample = np.array(row, dtype=np.float32)
        result = careless.execute_step(SimpleNamespace(sample=sample), 0)
    assert result.odd_violation


def test_axes_come_from_the_other_half(tmp_path: Path) -> None:
    plan = plan_of(tmp_path, n_components=1, calibration="iid")
    assert (plan.n, plan.tests) == (150, 2)
    plan = plan_of(tmp_path, calibration="iid")
    assert (plan.n, plan.tests) == (300, 2)
    plan = plan_of(tmp_path, n_components=2)
    assert plan.design.floor is None  # nothing is left out


def test_auto_calibrates_from_twenty_windows_on(tmp_path: Path) -> None:
    for metric in ("KolmogorovSmirnovDistance", "CramerVonMisesDistance"):
        plan = plan_of(tmp_path, window_size=15, distance_metric=metric)
        assert plan.calibration is not None
        assert plan.threshold >= max(plan.theoretical, plan.calibration.quantile)
    assert plan_of(tmp_path, window_size=16).calibration is None


def test_a_huge_window_ends_quickly(tmp_path: Path) -> None:
    with pytest.raises(EddiError, match="a whole number of samples from 1 to 1000000"):
        joined(tmp_path, [[1.0], [2.0]], **{**FIGURE, "window_size": 2_000_000})
    _, problems = joined(tmp_path, [[1.0], [2.0]], **{**FIGURE, "window_size": 1_000_000})
    assert {problem.code for problem in problems} == {"L009"}


def test_the_frozen_message_has_the_md5_of_packages_in_the_field() -> None:
    """What genmsg computes of a message without constants and comments."""
    text = KIND.messages["SafeMLOutput"].strip()
    digest = hashlib.md5(text.encode(), usedforsecurity=False).hexdigest()
    assert digest == "195444b28061334335568bfdb01494e8"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("bad")


def answer(folder: Path, config: bytes, csv: bytes) -> None:
    """Read both files; where they are sound, let the monitor run some steps."""
    (folder / "safeml_config.yml").write_bytes(config)
    (folder / "reference.csv").write_bytes(csv)
    try:
        (monitor,), _ = monitors_of(folder / "safeml_config.yml", [])
    except EddiError as refused:
        for problem in refused.problems:
            assert problem.place.file
            assert "\n" not in problem.message
        return
    one = compiled(monitor)
    features = monitor.model.data.reference.rows.shape[1]
    for value in (0.0, 1e308, -1e-308, 5.0):
        result = one.execute_step(SimpleNamespace(sample=[value] * features), 0)
        one.message(result)
        one.status_message()


VALUES = st.sampled_from([0.0, 1.0, -1.0, 1e-320, 1e150, 1e300, -1e308, 0.1])


@pytest.mark.filterwarnings("error")
@given(
    st.lists(st.lists(VALUES, min_size=2, max_size=2), min_size=8, max_size=40),
    st.sampled_from(["ks", "cvm", "ad"]),
    st.sampled_from([0, 1, 2]),
    st.booleans(),
)
def test_extreme_numbers(
    folder: Path, rows: list[list[float]], metric: str, components: int, standardize: bool
) -> None:
    config = (
        f"window_size: 4\nreference_sample_file: reference.csv\nsignificance_level: 0.3\n"
        f"distance_metric: {LONG_NAMES[metric]}\nn_components: {components}\n"
        f"standardize: {str(standardize).lower()}\n"
    )
    csv = "\n".join(",".join(map(repr, row)) for row in rows)
    answer(folder, config.encode(), csv.encode())


def test_a_sample_equal_to_a_row_has_equal_values() -> None:
    """Else rounding noise makes quantised samples differ from their own reference."""
    chance = np.random.RandomState(6)
    rows = np.round(chance.normal(size=(80, 12)), 1)
    design = Design(rows, components=5, residual=True, halves=True)
    for k, row in enumerate(rows[:40]):
        values = design.values(row)
        for test, value in enumerate(values):
            assert value in design.reference[test], (k, test)


def test_axes_have_few_digits() -> None:
    """Their last ones differ between machines."""
    rows = np.random.RandomState(2).normal(size=(90, 5))
    table = Design(rows, components=3, residual=True, halves=True).table
    assert table is not None
    vectors = table[2:]
    assert (np.round(vectors, 12) == vectors).all()
    np.testing.assert_allclose(vectors @ vectors.T, np.eye(3), atol=1e-11)


def test_a_sample_in_the_plane_of_the_axes_has_no_residual() -> None:
    """The digits that axes lack are no residual."""
    chance = np.random.RandomState(4)
    rows = chance.normal(size=(100, 2)) @ chance.normal(size=(2, 40)) * 1e6 + 1e5
    design = Design(rows, components=2, residual=True, halves=True)
    assert {design.values(row)[2] for row in rows} == {0.0}

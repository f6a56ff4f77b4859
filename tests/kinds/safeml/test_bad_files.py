"""Damaged configurations and references: problems or a monitor that runs, never anything else."""

from pathlib import Path
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.recordings.playing import compiled


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
    names = {
        "ks": "KolmogorovSmirnovDistance",
        "cvm": "CramerVonMisesDistance",
        "ad": "AndersonDarlingDistance",
    }
    config = (
        f"window_size: 4\nreference_sample_file: reference.csv\nsignificance_level: 0.3\n"
        f"distance_metric: {names[metric]}\nn_components: {components}\n"
        f"standardize: {str(standardize).lower()}\n"
    )
    csv = "\n".join(",".join(map(repr, row)) for row in rows)
    answer(folder, config.encode(), csv.encode())

"""Each diagnostic of SafeML: a configuration and a reference that earn it, and its exact text.

The cases stand in ``diagnostics.txt``: keys that replace those of one sound configuration
(``= KEY`` leaves one out); rows of the reference after ``@`` (``@b`` bytes in hex, ``@ ramp N`` a
drift of N rows, ``@ walk N`` dependent ones).
"""

import random
from pathlib import Path

import pytest

from eddi_scaffold.common.catalogue import area
from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.problems import Problem, in_order
from eddi_scaffold.kinds.safeml import KIND
from eddi_scaffold.kinds.safeml.safeml_model import SafeMLModel
from tests.diagnosed import Cases

CASES = Cases(Path(__file__).with_name("diagnostics.txt"))
SOUND = {
    "window_size": "4",
    "reference_sample_file": "reference.csv",
    "significance_level": "0.2",
    "distance_metric": "KolmogorovSmirnovDistance",
}
_RANDOM = random.Random(5)
ROWS = "\n".join(f"{_RANDOM.gauss(0, 1):.4f},{_RANDOM.gauss(0, 1):.4f}" for _ in range(40))


def lay(given: str, folder: Path, *, whole: bool) -> Path:
    lines = given.splitlines()
    keys = dict(SOUND)
    own = [line for line in lines if line and line[0] not in "@="]
    for line in own:
        keys[line.partition(":")[0]] = line.partition(":")[2].strip()
    for line in lines:
        keys.pop(line.removeprefix("= "), None)
    text = "\n".join(own if whole else (f"{key}: {value}" for key, value in keys.items()))
    (folder / "safeml_config.yml").write_text(text + "\n", "utf-8")
    (folder / "reference.csv").write_bytes(reference_of(lines))
    return folder / "safeml_config.yml"


def reference_of(lines: list[str]) -> bytes:
    rows = [line[2:] for line in lines if line.startswith("@ ")]
    if any(line.startswith("@b ") for line in lines):
        return bytes.fromhex(next(line[3:] for line in lines if line.startswith("@b ")))
    if rows and rows[0].startswith("ramp"):
        rows = [f"{k + (k % 3) / 7},{(k * 7) % 11}" for k in range(int(rows[0].split()[1]))]
    if rows and rows[0].startswith("walk"):
        rows = walk(int(rows[0].split()[1]))
    return ("\n".join(rows) if rows else ROWS).encode()


def walk(count: int) -> list[str]:
    """Return samples each of which resembles the one before (autocorrelation 0.9)."""
    chance, value, rows = random.Random(3), 0.0, []
    for _ in range(count):
        value = 0.9 * value + chance.gauss(0, 1)
        rows.append(f"{value:.4f}")
    return rows


def problems_of(path: Path) -> list[Problem]:
    reading = SafeMLModel.read_file(read_source(path), ())
    return in_order([*reading.problems, *(p for m in reading.models for p in m.check())])


@pytest.mark.parametrize("name", CASES.inputs)
def test_text_of_the_diagnostic(name: str, tmp_path: Path) -> None:
    problems = problems_of(lay(CASES.inputs[name], tmp_path, whole="(whole file)" in name))
    assert name[:4] in {problem.code for problem in problems}
    CASES.check(name, problems)


def test_every_code_has_a_case() -> None:
    assert {name[:4] for name in CASES.inputs} == {*area("L").diagnostics}


def test_the_sound_files_have_no_problem(tmp_path: Path) -> None:
    assert problems_of(lay("", tmp_path, whole=False)) == []


def test_figure_23_as_it_is_printed(tmp_path: Path) -> None:
    """SESAME D7.2 Fig 23, with as many features as it asks components for."""
    (tmp_path / "reference_sample.csv").write_text(
        "\n".join(",".join(f"{_RANDOM.gauss(0, 1):.18e}" for _ in range(12)) for _ in range(400))
    )
    path = tmp_path / "safeml_config.yml"
    path.write_text(
        "# Constants to specify at design time\n"
        "window_size : 100 #[steps]\n"
        "reference_sample_file : 'reference_sample.csv'\n"
        "significance_level: 0.1\n"
        "distance_metric : 'KolmogorovSmirnovDistance'\n"
        "n_components : 10\n"
    )
    assert KIND.recognises(read_source(path))
    assert problems_of(path) == []

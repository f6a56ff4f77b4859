"""Damaged files of every kind: no traceback, no hang, and nothing changed that was refused.

``pytest tests/fuzz/test_readers.py --hypothesis-profile=long`` tries 100,000 for each reader, in
parts that the workers of xdist share.
"""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from tests.fuzz.damage import Reader, Sample, damaged_sample, fuzz
from tests.fuzz.readers import NAMES, readers

pytestmark = pytest.mark.slow

LONG = settings.default.max_examples >= 1000
COUNT, PARTS = (10_000, 10) if LONG else (50, 1)
LIMIT = 1.0 if LONG else 10.0
"""Processor seconds for one step of a command; a hang is looked for, not slowness."""
SEED = os.environ.get("EDDI_FUZZ_SEED", "1")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("readers")


@pytest.mark.parametrize("part", range(PARTS))
@pytest.mark.parametrize("name", NAMES)
def test_damaged(name: str, part: int, folder: Path) -> None:
    if name == "bags":
        pytest.importorskip("rosbags", reason="the extra `bags` is not installed")
    reader = readers(folder / f"{name}-{part}", [name])[name]
    result = fuzz(reader, f"{name}:{SEED}.{part}", COUNT, LIMIT)
    assert not result.faults, "\n\n".join(map(str, result.faults.values()))


def test_the_damage_is_the_same_each_time(folder: Path) -> None:
    reader = readers(folder / "twice", ["events"])["events"]
    assert damaged_sample(reader, "x:1") == damaged_sample(reader, "x:1")
    assert damaged_sample(reader, "x:1") != damaged_sample(reader, "x:2")


def test_what_goes_wrong_is_found(folder: Path) -> None:
    """The frame itself: a fault and a hang are told with what makes them again."""

    def attempt(sample: Sample) -> Iterator[None]:
        while len(sample.data) % 2:
            pass
        yield
        raise KeyError(len(sample.data))

    reader = Reader("bad", [Sample("x", b"ab" * 50)], attempt)
    result = fuzz(reader, "s", 20, 0.02)
    hang, fault = sorted(result.faults.values(), key=lambda one: one.what)
    assert hang.what == "HangError in test_readers.py:attempt"
    assert fault.what.startswith("KeyError in test_readers.py:")
    assert hang.count + fault.count == 20
    assert damaged_sample(reader, fault.seed) == fault.sample

"""Work grows with the size of the input, and no faster: for every reader, one thing many times.

Counted are lines of Python that run, so that every machine sees the same.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

from eddi_scaffold.kinds import kinds
from tests.fuzz.damage import Reader, Sample
from tests.fuzz.readers import readers
from tests.growth.inputs import GROWING, Growing

pytestmark = pytest.mark.slow

TIMES = 2
COUNT = 16
FEWER = {"XDSL: nodes": 10, "BIF: variables": 10}
"""Where a thing is a lot of work: the order of inference is searched for it."""
FEWER |= {"XDSL: children of one node": 40, "XDSL: states": 11, "Open-PSA: gates": 50}
FEWER |= {"Open-PSA: uses of a parameter": 50}  # with fewer, what is constant grows
FEWER |= {"deployment: robots that fulfil a demand": 3}  # a model for each
MOST = 1.25
"""How much faster than the input the work may grow; with a square it is twice as fast."""
_READERS: dict[str, Reader] = {}


@pytest.fixture(autouse=True)
def no_vectors(monkeypatch: pytest.MonkeyPatch) -> None:
    """Take test vectors away: their work grows until a bound of its own."""
    for kind in kinds().values():
        monkeypatch.setattr(kind.model_class, "vectors", lambda *_: "")
    monkeypatch.setattr("eddi_scaffold.conditions.standalone.vectors_of_conditions", lambda _: {})


def reader_of(one: Growing, folder: Path) -> Reader:
    """Return what reads it, once; what it imports then is no work of the input."""
    if one.reader not in _READERS:
        _READERS[one.reader] = readers(folder, [one.reader])[one.reader]
        _work(one, folder, 3)
    return _READERS[one.reader]


def _work(one: Growing, folder: Path, count: int) -> tuple[int, int]:
    """Return the size of an input and the work that it makes."""
    reader, data = reader_of(one, folder), one.text(count).encode()
    return len(data), work(lambda: list(reader.attempt(Sample(one.file, data))))


def work(call: Callable[[], object]) -> int:
    """Return how many lines of our own code, and of difflib, a call runs."""
    count = 0

    def line(_: FrameType, __: str, ___: Any) -> Any:
        nonlocal count
        count += 1
        return line

    def entered(frame: FrameType, _: str, __: Any) -> Any:
        nonlocal count
        count += 1
        file = frame.f_code.co_filename
        return line if "/eddi_" in file or file.endswith("difflib.py") else None

    before = sys.gettrace()
    sys.settrace(entered)
    try:
        call()
    finally:
        sys.settrace(before)
    return count


@pytest.mark.parametrize("name", GROWING)
def test_work_grows_with_the_input(name: str, tmp_path_factory: pytest.TempPathFactory) -> None:
    one, count = GROWING[name], FEWER.get(name, COUNT)
    folder = tmp_path_factory.mktemp("reader", numbered=True)
    (short, less), (long, more) = (_work(one, folder, n) for n in (count, count * TIMES))
    assert more <= MOST * max(TIMES, long / short) * less, (less, more)

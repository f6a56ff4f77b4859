"""Work grows with the size of the input, and no faster: for every reader, one thing many times.

Counted are lines of Python that run, so that every machine sees the same.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.fuzz.damage import Sample
from tests.fuzz.readers import readers
from tests.growth.inputs import GROWING, Growing
from tests.growth.work import work

pytestmark = pytest.mark.slow

TIMES = 2
COUNT = 16
FEWER = {"XDSL: chain": 10, "XDSL: nodes": 10, "BIF: variables": 10}
"""Where a thing is a lot of work: the order of inference is searched for it."""
FEWER |= {"XDSL: children of one node": 40, "XDSL: states": 50, "Open-PSA: gates": 50}
FEWER |= {"Open-PSA: uses of a parameter": 50}  # with fewer, what is constant grows
FEWER |= {"deployment: robots": 4, "deployment: robots that fulfil a demand": 4}  # a model for each
MOST = 1.25
"""How much faster than the input the work may grow; with a square it is twice as fast."""
_WARM: set[str] = set()


def _work(one: Growing, folder: Path, text: str) -> int:
    reader = readers(folder, [one.reader])[one.reader]
    return work(lambda: list(reader.attempt(Sample(one.file, text.encode()))))


@pytest.mark.parametrize("name", GROWING)
def test_work_grows_with_the_input(name: str, tmp_path: Path) -> None:
    one = GROWING[name]
    if one.reader not in _WARM:  # what is imported once is no work of the input
        _WARM.add(one.reader)
        _work(one, tmp_path / "warm", one.text(3))
    count = FEWER.get(name, COUNT)
    small, large = one.text(count), one.text(count * TIMES)
    less, more = _work(one, tmp_path / "small", small), _work(one, tmp_path / "large", large)
    growth = max(TIMES, len(large) / len(small))
    assert more <= MOST * growth * less, (less, more)

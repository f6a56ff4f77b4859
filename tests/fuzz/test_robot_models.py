"""Damaged .rossystem and .ros* texts: our own syntax error or a result, and never a hang.

``--hypothesis-profile=long`` tries 5,000 texts in each test.
"""

from __future__ import annotations

import time
from functools import cache

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.mros import MrosSyntaxError, read_ros_models, read_rossystem
from eddi_scaffold.mros.show import model_json, system_json
from tests.data_files import data_file
from tests.fuzz.mutations import mutations
from tests.mros.test_outputs import ARM, LASERS, NODES
from tests.mros.test_reading import INDENT_MODEL, INDENT_SYSTEM, MODEL, SYSTEM

pytestmark = pytest.mark.slow

OWN = [("rossystem", text) for text in (SYSTEM, INDENT_SYSTEM, LASERS, ARM)]
OWN += [("ros", MODEL), ("ros1", INDENT_MODEL), ("ros1", NODES)]
LIMIT = 1.0
"""Seconds for one text; a hang, not slowness, is looked for."""


@cache
def corpus() -> list[tuple[str, bytes]]:
    found = [(suffix, text.encode()) for suffix, text in OWN]
    try:
        folder = data_file("mros/corpus")
    except pytest.skip.Exception:
        return found
    files = sorted(path for path in folder.rglob("*.ros*") if path.stat().st_size < 60_000)
    return found + [(path.suffix[1:], path.read_bytes()) for path in files]


texts = st.deferred(
    lambda: st.sampled_from(corpus()).flatmap(
        lambda one: st.tuples(st.just(one[0]), mutations(one[1]))
    )
)


def attempt(text: str | bytes, suffix: str) -> MrosSyntaxError | None:
    """Read a text to the end; anything but our own error fails the test by itself."""
    try:
        if suffix == "rossystem":
            system_json(read_rossystem(text, "x"))
        else:
            model_json(read_ros_models(text, "x"))
    except MrosSyntaxError as failed:
        return failed
    return None


def is_told_well(failed: MrosSyntaxError | None) -> bool:
    return failed is None or (failed.line >= 1 and failed.col >= 1 and bool(failed.message))


@given(texts)
def test_damaged_texts(one: tuple[str, bytes]) -> None:
    suffix, data = one
    start = time.process_time()
    assert is_told_well(attempt(data, suffix))
    assert time.process_time() - start < LIMIT


STARTS = [
    "",
    "RosSystem { Name a RosComponents (",
    "RosSystem { RosComponents ( ComponentInterface { RosParameters { RosParameter a { value ",
    "PackageSet {",
    "a:\n nodes:\n  ",
    "a:\n nodes:\n  b:\n   parameters:\n    - c: ",
]


@pytest.mark.parametrize("mark", ["{", "[", "(", "'", '"', "/*", "a:\n ", "- ", "}", "#\n"])
@pytest.mark.parametrize("start", STARTS)
def test_one_mark_many_times(start: str, mark: str) -> None:
    began = time.process_time()
    for suffix in ("rossystem", "ros"):
        assert is_told_well(attempt(start + mark * 10_000, suffix))
    assert time.process_time() - began < 2 * LIMIT


@pytest.mark.parametrize("start", ["", "a:\n nodes:\n  b:\n   parameters:\n"])
def test_deep_indentation(start: str) -> None:
    text = start + "".join(f"{' ' * (depth + 5)}a:\n" for depth in range(3000))
    for suffix in ("rossystem", "ros"):
        assert is_told_well(attempt(text, suffix))

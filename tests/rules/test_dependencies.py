"""What is declared in pyproject.toml."""

from __future__ import annotations

import pytest

from tests.checkouts import HERE

tomllib = pytest.importorskip("tomllib", reason="Python 3.11 reads TOML")


@pytest.mark.parametrize("name", ["pyproject.toml", "runtime_lib/pyproject.toml"])
def test_every_dependency_has_both_bounds(name: str) -> None:
    document = tomllib.loads((HERE / name).read_text("utf-8"))
    extras = document["project"].get("optional-dependencies", {}).values()
    lists = [document["build-system"]["requires"], document["project"]["dependencies"], *extras]
    for requirement in (one for several in lists for one in several):
        assert ">=" in requirement, requirement
        assert "<" in requirement, requirement

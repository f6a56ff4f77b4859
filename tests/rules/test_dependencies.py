"""What is declared in pyproject.toml."""

from __future__ import annotations

import pytest

from tests.checkouts import HERE

tomllib = pytest.importorskip("tomllib", reason="Python 3.11 reads TOML")


DISTRIBUTIONS = ("", "runtime_lib", "eddi_scaffold/regions")


@pytest.mark.parametrize("folder", DISTRIBUTIONS)
def test_every_dependency_has_both_bounds(folder: str) -> None:
    document = tomllib.loads((HERE / folder / "pyproject.toml").read_text("utf-8"))
    extras = document["project"].get("optional-dependencies", {}).values()
    needed = document["project"].get("dependencies", [])
    lists = [document["build-system"]["requires"], needed, *extras]
    for requirement in (one for several in lists for one in several):
        assert ">=" in requirement, requirement
        assert "<" in requirement, requirement

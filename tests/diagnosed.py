"""Tests of diagnostics outside of the snapshots prove their example in the registry themselves."""

from __future__ import annotations

from collections.abc import Iterable

from eddi_scaffold.cli.console import console
from eddi_scaffold.common.catalogue import find
from eddi_scaffold.common.problems import Problem


def assert_example(code: str, given: str | Iterable[Problem]) -> None:
    """Assert that the example of a code stands in what is printed, or is the text of a problem."""
    found = find(code)
    assert found is not None
    if not isinstance(given, str):
        console.colour = False
        given = "".join(console.text(problem) for problem in given)
    assert found.example in given
    assert f"[{code}]" in found.example

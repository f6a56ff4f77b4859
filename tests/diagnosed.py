"""Tests of diagnostics outside of the snapshots say which code is reported."""

from __future__ import annotations

import re
from collections.abc import Iterable
from string import Formatter

from eddi_scaffold.cli.console import console
from eddi_scaffold.common.catalogue import find
from eddi_scaffold.common.problems import Problem


def assert_reported(code: str, printed: str | Iterable[Problem]) -> None:
    """Assert that a text of a code stands in what is printed, or among problems."""
    diagnostic = find(code)
    assert diagnostic is not None
    if not isinstance(printed, str):
        console.colour = False
        printed = "".join(console.text(problem) for problem in printed)
    texts = [rf": {_pattern(case.text)} \[{code}\]" for case in diagnostic.cases.values()]
    assert any(re.search(text, printed) for text in texts), printed


def _pattern(template: str) -> str:
    """Return what any values make of a text."""
    parts = Formatter().parse(template)
    return "".join(re.escape(text) + ("" if field is None else ".*") for text, field, _, _ in parts)

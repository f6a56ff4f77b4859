"""Findings about a text of events: offsets become places."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from itertools import accumulate

from eddi_scaffold.common.problems import Place, Problem, problem

Locate = Callable[[int], Place]
"""Offset in the text (0 to its length) -> place in the file that holds it."""

EXPRESSION = "<expression>"
"""Name of a text that came from no file."""
MAX_FINDINGS = 100


class TextFindings:
    """Collects what is wrong with one text.

    Attributes:
        problems: so far, in the order in which they were found.
    """

    def __init__(self, text: str, locate: Locate) -> None:
        self.problems: list[Problem] = []
        self.text = text
        self._locate = locate

    def add(self, case: str, offset: int, /, *, hint: str | None = None, **fields: object) -> None:
        """Add the problem of a case at an offset."""
        if len(self.problems) < MAX_FINDINGS:
            self.problems.append(problem(case, self._locate(offset), hint=hint, **fields))


def line_and_column(text: str) -> Callable[[int], tuple[int, int]]:
    """Return the function offset -> line and column, both from 1."""
    starts = [0, *accumulate(len(line) + 1 for line in text.split("\n"))]

    def of(offset: int) -> tuple[int, int]:
        line = bisect_right(starts, offset)
        return line, offset - starts[line - 1] + 1

    return of


def in_text(text: str, name: str = EXPRESSION) -> Locate:
    """Return the places of a text that is a whole file."""
    of = line_and_column(text)
    return lambda offset: Place(name, *of(offset))

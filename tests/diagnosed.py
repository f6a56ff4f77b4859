"""Tests of diagnostics outside of the snapshots say which code is reported."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from pathlib import Path
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


class Cases:
    """Inputs and what is reported of each: ``### NAME``, the input, ``>>>``, the problems.

    ``UPDATE_DIAGNOSTICS=1`` writes what is reported now.
    """

    def __init__(self, file: Path) -> None:
        self._file = file
        parts = re.split(r"(?m)^### ", file.read_text("utf-8"))[1:]
        self._texts = dict(part.split("\n", 1) for part in parts)
        self.inputs = {name: text.partition(">>>\n")[0] for name, text in self._texts.items()}

    def check(self, name: str, problems: Iterable[Problem]) -> None:
        """Assert that these are the problems of a case."""
        reported = "\n".join(map(shown, problems))
        if os.environ.get("UPDATE_DIAGNOSTICS"):
            text, case = self._file.read_text("utf-8"), f"### {name}\n{self.inputs[name]}>>>\n"
            old = f"### {name}\n{self._texts[name]}"
            self._file.write_text(text.replace(old, f"{case}{reported}\n\n"), "utf-8")
        else:
            assert reported == self._texts[name].partition(">>>\n")[2].rstrip("\n")


def shown(problem: Problem) -> str:
    """Return a problem as the console prints it, with the name of its file."""
    place = problem.place
    parts = [Path(place.file).name, *(n for n in (place.line, place.col) if n is not None)]
    hint = f"\n  hint: {problem.hint}" if problem.hint else ""
    where = ":".join(map(str, parts))
    return f"{where}: {problem.level}: {problem.message} [{problem.code}]{hint}"

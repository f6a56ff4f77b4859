"""The source lines of problems, read again from their files when they are printed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from eddi_scaffold.files import open_regular
from eddi_scaffold.problems import Problem

MAX_LINE = 1024 * 1024
"""Bytes of a longer line are not shown: the place could not be found in it."""


def with_source_lines(problems: Iterable[Problem]) -> list[Problem]:
    """Attach to each problem its source line, where the file can still be read."""
    problems = list(problems)
    wanted: dict[str, set[int]] = {}
    for problem in problems:
        if problem.excerpt is None and problem.place.file and problem.place.line is not None:
            wanted.setdefault(problem.place.file, set()).add(problem.place.line)
    found = {file: _lines(Path(file), numbers) for file, numbers in wanted.items()}
    return [_with_line(problem, found.get(problem.place.file, {})) for problem in problems]


def _with_line(problem: Problem, lines: Mapping[int, str]) -> Problem:
    line = lines.get(problem.place.line or 0)
    return (
        replace(problem, excerpt=line) if line is not None and problem.excerpt is None else problem
    )


def _lines(file: Path, numbers: set[int]) -> dict[int, str]:
    """Return the lines of a file with these numbers; none when it has gone or is not text."""
    found: dict[int, str] = {}
    try:
        with open_regular(file) as stream:
            for number, line in enumerate(stream, 1):
                if number in numbers and len(line) <= MAX_LINE and b"\0" not in line:
                    text = line.decode("utf-8-sig" if number == 1 else "utf-8", "replace")
                    found[number] = text.rstrip("\r\n")
                if number >= max(numbers):
                    break
    except OSError:
        pass  # the problem itself was reported, the line only helps
    return found

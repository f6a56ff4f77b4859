"""Everything that is printed: data to stdout, words to stderr; only this module writes there."""

from __future__ import annotations

import json
import os
import re
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from enum import IntEnum
from pathlib import Path
from typing import TextIO

from eddi_scaffold.common.files import open_regular
from eddi_scaffold.common.problems import EddiError, Problem, in_order, plural, problem


class ExitStatus(IntEnum):
    """Meaning of the exit status of a command."""

    NO = 1  # the answer is no: problems were found, packages are not up to date
    BAD_INPUT = 2  # the input cannot be used; nothing was done
    LOOK = 3  # done, but a person should look at what is left
    OUR_BUG = 70
    INTERRUPTED = 130


MAX_LINE = 1024 * 1024  # bytes of a longer line are not shown: the place could not be found in it


def with_source_lines(problems: Iterable[Problem]) -> list[Problem]:
    """Attach to each problem its source line, where the file can still be read."""
    problems = list(problems)
    numbers: dict[str, set[int]] = {}
    for reported in problems:
        if reported.excerpt is None and reported.place.file and reported.place.line is not None:
            numbers.setdefault(reported.place.file, set()).add(reported.place.line)
    lines = {(file, n): line for file in numbers for n, line in _lines(file, numbers[file])}
    places = ((reported.place.file or "", reported.place.line or 0) for reported in problems)
    return [
        replace(reported, excerpt=lines.get(place, reported.excerpt))
        for reported, place in zip(problems, places, strict=True)
    ]


def _lines(file: str, numbers: set[int]) -> Iterator[tuple[int, str]]:
    """Yield the lines of a file with these numbers; none when it has gone or is not text."""
    with suppress(OSError), open_regular(Path(file)) as stream:  # the line only helps
        for number, line in enumerate(stream, 1):
            if number in numbers and len(line) <= MAX_LINE and b"\0" not in line:
                text = line.decode("utf-8-sig" if number == 1 else "utf-8", "replace")
                yield number, text.rstrip("\r\n")
            if number >= max(numbers):
                break


_COLOURS = {
    "error": "31", "warning": "33", "info": "36", "hint": "36", "place": "1",
}  # fmt: skip
_WIDTH = 160  # characters of a source line that are shown


class Console:
    """Where a command's words go."""

    quiet = False  # print errors only
    verbose = False  # print infos as well

    def data(self, text: str) -> None:
        """Print data that one could pipe."""
        _write(sys.stdout, _clean(f"{text}\n"))

    def json(self, value: object) -> None:
        """Print one JSON value."""
        _write(sys.stdout, json.dumps(value, indent=2) + "\n")

    def say(self, text: str) -> None:
        """Print words, unless quiet."""
        if not self.quiet:
            _write(sys.stderr, _clean(f"{text}\n"))

    def complain(self, text: str) -> None:
        """Print words, quiet or not."""
        _write(sys.stderr, _clean(f"{text}\n"))

    def progress(self, text: str) -> None:
        """Print what is being done, on a terminal only."""
        if _on_terminal() and not self.quiet:
            _write(sys.stderr, f"{text}\n")

    def problems(self, problems: Iterable[Problem], *, summary: bool = True) -> None:
        """Print problems in order, with source lines, carets, hints and a closing count."""
        shown = [p for p in in_order(problems) if self.shows(p)]
        for reported in with_source_lines(shown):
            _write(sys.stderr, self.text(reported))
        if shown and summary:
            self.say(count_line(shown))

    def shows(self, problem: Problem) -> bool:
        """Return whether a problem of this level is printed."""
        if problem.level == "error":
            return True
        return not self.quiet and (problem.level == "warning" or self.verbose)

    def text(self, problem: Problem) -> str:
        """Return the lines of one problem."""
        place = problem.place
        where = ":".join(str(part) for part in (place.file, place.line, place.col) if part)
        level = self._painted(problem.level, f"{problem.level}:")
        start = self._painted("place", f"{_one_line(where)}: ") if where else ""
        lines = [f"{start}{level} {_one_line(problem.message)} [{problem.code}]"]
        if problem.excerpt is not None and problem.excerpt.strip():
            lines += [f"    {line}" for line in _excerpt(problem.excerpt, place.col)]
        if problem.hint:
            lines.append(f"  {self._painted('hint', 'hint:')} {_one_line(problem.hint)}")
        return "".join(f"{line}\n" for line in lines)

    def _painted(self, role: str, text: str) -> str:
        forced = bool(os.environ.get("FORCE_COLOR")) or _on_terminal()
        coloured = forced and not os.environ.get("NO_COLOR")
        return f"\x1b[{_COLOURS[role]}m{text}\x1b[0m" if coloured else text


def count_line(problems: Sequence[Problem]) -> str:
    """Return the closing line: ``2 errors, 1 warning``."""
    counts = Counter(problem.level for problem in problems)
    return ", ".join(
        plural(counts[level], level) for level in ("error", "warning", "info") if counts[level]
    )


def _on_terminal() -> bool:
    return sys.stderr is not None and sys.stderr.isatty()  # None: closed before we started


def _excerpt(line: str, col: int | None) -> list[str]:
    """Return the part of a source line around a column, with a caret below it."""
    start = max(0, col - _WIDTH // 2) if col is not None and col > _WIDTH else 0
    part = line[start : start + _WIDTH].expandtabs(8)
    if col is None or col > len(line) + 1:
        return [_one_line(part)]
    before = _one_line(line[start : col - 1].expandtabs(8))
    return [_one_line(part), f"{' ' * len(before)}^"]


def _one_line(text: str) -> str:
    return re.sub(r"\s*\n\s*", " ", _clean(text))


def _clean(text: str) -> str:
    """Replace what is not printable, so that text of a model cannot steer the terminal."""
    if text.replace("\n", "").replace("\t", "").isprintable():  # a long diff, as a rule
        return text
    return "".join(
        char if char.isprintable() or char in "\n\t" else ascii(char)[1:-1] for char in text
    )


def _write(stream: TextIO | None, text: str) -> None:
    """Write text; what the encoding of the stream cannot hold becomes an escape.

    Whoever read the stream may have gone (`| head`): the command goes on, and ends with the status
    that its work deserves.
    """
    if stream is None:  # closed before we started
        return
    encoding = stream.encoding or "utf-8"
    try:
        stream.write(text.encode(encoding, "backslashreplace").decode(encoding))
        stream.flush()
    except OSError as refused:
        # What is written from now on vanishes, also what the interpreter flushes at its end.
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)
        if stream is sys.stdout and not isinstance(refused, BrokenPipeError):
            raise EddiError(problem("F002.output", reason=refused.strerror)) from None


console = Console()  # the one console of the process; its flags are set by the command line

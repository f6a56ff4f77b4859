"""What is wrong with an input, where, and what to do: values, not exceptions."""

from __future__ import annotations

import difflib
import itertools
import re
from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace

from eddi_scaffold.common import catalogue
from eddi_scaffold.common.catalogue import Level


@dataclass(frozen=True)
class Place:
    """The place of something in an input."""

    file: str = ""  # path as the user gave it; empty when there is none
    line: int | None = None  # counted from 1, as is the column
    col: int | None = None
    path: str | None = None  # EMF fragment path of the element (`//@a.0/@b.1`), XML only


@dataclass(frozen=True)
class Problem:
    """One finding about an input."""

    level: Level  # `error` stops every command that would write
    case: str  # its name in the catalogue, `K029.long`
    message: str  # one sentence without a full stop
    place: Place = Place()  # where it was found
    hint: str | None = None  # what to do
    excerpt: str | None = None  # the source line; the printer puts a caret below the column

    @property
    def code(self) -> str:
        """The stable code, such as ``K029``."""
        return self.case.partition(".")[0]

    def about(self, subject: str) -> Problem:
        """Return the problem with the subject before its message."""
        return replace(self, message=f"{subject}: {self.message}")

    def as_json(self) -> dict[str, object]:
        """Return the stable JSON form of ``--json``."""
        return {
            "level": self.level,
            "code": self.code,
            "message": self.message,
            "hint": self.hint,
            "file": self.place.file or None,
            "line": self.place.line,
            "col": self.place.col,
        }


class EddiError(Exception):
    """Bad input or usage: a command stops, prints the problems and exits with 2."""

    def __init__(self, *problems: Problem) -> None:
        super().__init__("; ".join(p.message for p in problems))
        self.problems = problems


class HintedError(ValueError):
    """A value is wrong; who knows the code and the place makes a problem of it."""

    def __init__(self, message: str, hint: str | None = None) -> None:
        super().__init__(message)
        self.hint = hint


def problem(
    case: str, place: Place = Place(), /, *, hint: str | None = None, **fields: object
) -> Problem:
    """Return the problem of a case of the catalogue (``K029.long``) with the fields of its texts.

    A hint is given where it is computed, and the catalogue has none.
    """
    level, text, template = catalogue.case_of(case)
    if template is not None:
        hint = template.format_map(fields)
    return Problem(level, case, text.format_map(fields), place, hint)


def has_errors(problems: Iterable[Problem]) -> bool:
    """Return whether one of the problems is an error."""
    return any(p.level == "error" for p in problems)


def in_order(problems: Iterable[Problem]) -> list[Problem]:
    """Sort by file, line, column and code, without repetitions: the order of every report."""
    return sorted(
        dict.fromkeys(problems),
        key=lambda p: (p.place.file, p.place.line or 0, p.place.col or 0, p.code, p.message),
    )


def with_excerpts(problems: Iterable[Problem], text: str) -> list[Problem]:
    """Attach to each problem the source line of ``text`` that it concerns."""
    # not splitlines(), which sees line ends that XML, YAML and editors do not
    lines = re.split(r"\r\n|\r|\n", text)
    return [
        replace(p, excerpt=lines[p.place.line - 1])
        if p.place.line is not None and p.place.line <= len(lines) and p.excerpt is None
        else p
        for p in problems
    ]


def most_similar(word: str, known: Iterable[str]) -> str | None:
    """Return the one known word that is most like ``word``, ``None`` when none is near."""
    folded = {k.casefold(): k for k in known}
    match = difflib.get_close_matches(word.casefold(), sorted(folded), n=1, cutoff=0.6)
    return folded[match[0]] if match else None


def did_you_mean(word: str, known: Iterable[str]) -> str | None:
    """Return the hint ``did you mean X?``, ``None`` when nothing is near."""
    match = most_similar(word, known)
    return f"did you mean {match!r}?" if match is not None else None


_MOST_NAMES = 5_000
_MOST_WORDS = 20
_MOST_LISTED = 20


class SimilarNames:
    """Hints on near names that stay affordable in a file with thousands of wrong ones.

    Comparing texts is slow: only the first :data:`_MOST_WORDS` different words are compared.
    """

    def __init__(self, known: Collection[str], otherwise: str | None = None) -> None:
        self._known = known if len(known) <= _MOST_NAMES else ()
        self._otherwise = f"{otherwise}: {shortened_list(known)}" if otherwise is not None else None
        self._hints: dict[str, str | None] = {}

    def hint(self, word: str) -> str | None:
        """Return ``did you mean ...?`` or the known names, ``None`` without either."""
        if word not in self._hints and len(self._hints) < _MOST_WORDS:
            self._hints[word] = did_you_mean(word, self._known)
        return self._hints.get(word) or self._otherwise


def plural(number: int, what: str) -> str:
    """Return a number with its noun, in the plural where it is not one."""
    return f"{number} {what}{'s' if number != 1 else ''}"


def shortened_list(names: Collection[str]) -> str:
    """Return names for a message, not all where they are many."""
    shown = ", ".join(itertools.islice(names, _MOST_LISTED))
    more = len(names) - _MOST_LISTED
    return f"{shown} and {more} more" if more > 0 else shown or "none"

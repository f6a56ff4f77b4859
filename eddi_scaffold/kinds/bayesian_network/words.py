"""The words of a network that is text (BIF), with their places; the first fault ends it."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterator
from typing import NamedTuple

from eddi_scaffold.kinds.bayesian_network.model import Named
from eddi_scaffold.problems import EddiError, Place, error
from eddi_scaffold.source import Source

CODE = "B231"
_CONTROL = re.compile(r"[\0-\x08\x0e-\x1f\x7f]")


class Word(NamedTuple):
    """A word, a text in quotes without them, or a mark; empty at the end of the file."""

    text: str
    at: int
    is_name: bool


class Words:
    """What a text consists of, one word after the other.

    Args:
        source: the file.
        pattern: its groups are a text in quotes, a mark, a word, and what is none of them; white
            space and comments are in no group.

    Raises:
        EddiError: the file is not UTF-8, or holds control characters (B231).
    """

    def __init__(self, source: Source, pattern: re.Pattern[str]) -> None:
        self.file = source.name
        self._text = source.text(CODE)
        self._lines: list[int] | None = None
        control = _CONTROL.search(self._text)
        if control is not None:
            word = Word(control[0], control.start(), is_name=False)
            raise self.fault(f"this character is no text: {control[0]!r}", word)
        self._rest = self._words(pattern)
        self.next = next(self._rest)

    def _words(self, pattern: re.Pattern[str]) -> Iterator[Word]:
        for match in pattern.finditer(self._text):
            group = match.lastindex
            if group is None:
                continue
            word = Word(match[group], match.start(), group in (1, 3))
            if group == 4:
                raise self.fault(f"this is not finished: {word.text}", word)
            yield word
        while True:
            yield Word("", len(self._text), is_name=False)

    @property
    def at_end(self) -> bool:
        """Whether no word is left."""
        return self.next.at == len(self._text)

    def take(self) -> Word:
        """Return the next word and go on."""
        word, self.next = self.next, next(self._rest)
        return word

    def is_mark(self, *marks: str) -> bool:
        """Return whether the next word is one of these marks."""
        return not self.next.is_name and self.next.text in marks

    def skip_mark(self, mark: str) -> bool:
        """Return whether this mark is next, and go behind it."""
        found = self.is_mark(mark)
        if found:
            self.take()
        return found

    def mark(self, mark: str) -> None:
        """Go behind a mark that must be next."""
        if not self.skip_mark(mark):
            raise self.expected(f"`{mark}`")

    def name(self, what: str) -> Named:
        """Return the next word, which must be a name or a number."""
        if not self.next.is_name:
            raise self.expected(what)
        word = self.take()
        return Named(word.text, self.place(word))

    def names(self, what: str, end: str) -> list[Named]:
        """Return all names up to a mark, and go behind it."""
        found = []
        while not self.skip_mark(end):
            found.append(self.name(f"{what} or `{end}`"))
        return found

    def values(self, end: str = ";") -> tuple[str, ...]:
        """Return the texts of all names up to a mark, and go behind it; for many numbers."""
        found = []
        while self.next.is_name:
            found.append(self.take().text)
        self.mark(end)
        return tuple(found)

    def skip_to(self, mark: str) -> None:
        """Go behind the next mark of this form."""
        while not self.skip_mark(mark):
            if self.at_end:
                raise self.expected(f"`{mark}`")
            self.take()

    def place(self, word: Word) -> Place:
        """Return the place of a word."""
        if self._lines is None:
            self._lines = [0, *(match.end() for match in re.finditer("\n", self._text))]
        line = bisect_right(self._lines, word.at)
        return Place(self.file, line, word.at - self._lines[line - 1] + 1)

    def expected(self, what: str) -> EddiError:
        """Return the problem that the next word is something else."""
        found = "the end of the file" if self.at_end else repr(self.next.text)
        return self.fault(f"{what} is expected, not {found}", self.next)

    def fault(self, message: str, word: Word) -> EddiError:
        """Return a problem with the form of the text (B231)."""
        return EddiError(error(CODE, message, self.place(word)))

"""What ``compiled.py`` holds of a larger part of a network: the messages along a join tree."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Mapping, NamedTuple, Sequence

from .engine import Rows

if TYPE_CHECKING:
    from .arrays import Running


class Schedule(NamedTuple):
    """The messages of a large part."""

    # number -> (numbers of the parents, table of its probabilities), of the whole file
    nodes: Mapping[int, tuple[tuple[int, ...], Rows]]
    messages: tuple[tuple[Any, ...], ...]  # fields of ``arrays.Message``, each behind its parts
    answers: tuple[int, ...]  # the message with the row of each output

    def running(self, positions: Mapping[int, int], cards: Sequence[int]) -> Running:
        from .arrays import Running  # noqa: PLC0415 - numpy takes 0.1 s and 25 MB

        return Running(self, positions)


def rows_of(text: str) -> list[list[float]]:
    """Return the rows of a large table, one in a line: tuples would take long to import."""
    return [list(map(float, line.split())) for line in text.splitlines()]

"""What ``compiled.py`` holds of a larger part of a network: messages, and operations of numpy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Mapping, NamedTuple, Sequence

from .engine import Posteriors, Rows, States

if TYPE_CHECKING:
    from .arrays import Running


class Steps(NamedTuple):
    """Operations on arrays that are made when the monitor starts.

    How an array is made, by the first word of its row:

    - ``constant`` message, order of axes, shape: a copy of known numbers;
    - ``cases`` message, order of axes, shape: one such copy for each case of its inputs;
    - ``row`` message: its numbers as a list; ``rows``: one list for each case;
    - ``evidence`` node, shape: the vector of a node;
    - ``result`` shape: where an operation writes to; ``ones`` length;
    - ``view`` slot, order of axes, shape: the same memory as that slot;
    - ``piece`` slot, axis, first, last: a part of it, or of each of its cases.
    """

    slots: tuple[tuple[Any, ...], ...]  # a row for each array
    # (numpy, arrays) -> the step: states -> a row for each output
    bind: Callable[..., Callable[[States], Posteriors]] | None = None
    # (message, function, slot, ...), where there is no ``bind``
    operations: tuple[tuple[Any, ...], ...] = ()
    answers: tuple[int, ...] = ()  # slot with the row of each output, where there is no ``bind``


class Schedule(NamedTuple):
    """The operations of a large part."""

    # number -> (numbers of the parents, table of its probabilities), of the whole file
    nodes: Mapping[int, tuple[tuple[int, ...], Rows]]
    messages: tuple[tuple[Any, ...], ...]  # fields of ``arrays.Message``, each behind its parts
    # the message with the row of each output; without outputs, those whose product is summed
    answers: tuple[int, ...]
    hard: Steps | None  # for steps without virtual evidence: messages of few inputs are looked up
    full: Steps | None  # for any evidence; None where each observable node is observed

    def running(self, cards: Mapping[int, tuple[int, int]], wanted: Sequence[int]) -> Running:
        from .arrays import Running  # noqa: PLC0415 - numpy takes 0.1 s and 25 MB

        return Running(self, {node: position for node, (position, _) in cards.items()}, wanted)


def rows_of(text: str) -> list[list[float]]:
    """Return the rows of a large table, one in a line: tuples would take long to import."""
    return [list(map(float, line.split())) for line in text.splitlines()]

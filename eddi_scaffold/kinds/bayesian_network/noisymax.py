"""Noisy-MAX nodes of GeNIe as tables (Diez 1993, "Parameter adjustment in Bayes networks").

The file holds, for each parent, one column of probabilities per state of that parent in the order
of its strengths, then a column for the leak; the last column of a parent belongs to the state that
causes nothing and is 0 ... 0 1 (SMILE manual, "Noisy-MAX"). The node takes the strongest of the
states that its parents and the leak cause each by itself; its first state is the strongest.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise, product

from eddi_scaffold.kinds.bayesian_network.model import in_digits

LARGEST = 1_000_000
"""A table may have so many entries: it doubles with each parent of two states."""
_TOLERANCE = 1e-6


class NoisyMaxError(ValueError):
    """The numbers are not a noisy-MAX; the message explains why."""


def noisy_max_table(
    parameters: Sequence[str], strengths: Sequence[str], cards: Sequence[int], own: int
) -> tuple[tuple[str, ...], bool]:
    """Return the table in the order of all tables, and whether there is a leak.

    Args:
        parameters: texts of the columns, one after the other.
        strengths: for each parent, the order of its states; empty: as given.
        cards: number of states of each parent.
        own: number of states of the node.

    Raises:
        NoisyMaxError: something does not fit.
    """
    numbers = [_probability(text) for text in parameters]
    count = own * (sum(cards) + 1)
    if len(numbers) != count:
        message = f"{len(numbers)} parameters, expected {count} ({own} x ({sum(cards)} + 1))"
        raise NoisyMaxError(message)
    size = own * math.prod(cards)
    if size > LARGEST:
        message = f"its table would have {in_digits(size)} entries, more than {LARGEST}"
        raise NoisyMaxError(message)
    columns = [numbers[k : k + own] for k in range(0, count, own)]
    for column in columns:
        if abs(math.fsum(column) - 1.0) > _TOLERANCE:
            raise NoisyMaxError(f"a column sums to {math.fsum(column):.9g}, not to 1")
    nothing = [*[0.0] * (own - 1), 1.0]
    at = 0
    causes: list[list[list[float]]] = []
    for number, order in enumerate(_orders(strengths, cards)):
        of = columns[at : at + len(order)]
        at += len(order)
        if of[-1] != nothing:
            message = f"the last column of parent {number + 1} must be 0 ... 0 1"
            raise NoisyMaxError(message)
        causes.append([_below(of[order.index(state)]) for state in range(len(order))])
    leak = _below(columns[-1])
    rows = (_row([*states, leak]) for states in product(*causes))
    return tuple(repr(value) for row in rows for value in row), columns[-1] != nothing


def _probability(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 <= value <= 1.0:
        raise NoisyMaxError(f"{text!r} is not a probability")
    return value


def _orders(strengths: Sequence[str], cards: Sequence[int]) -> Iterator[list[int]]:
    """Yield, for each parent, the states from the strongest to the one that causes nothing."""
    if strengths and len(strengths) != sum(cards):
        raise NoisyMaxError(f"{len(strengths)} strengths, expected {sum(cards)}")
    at = 0
    for number, card in enumerate(cards):
        known = [str(state) for state in range(card)]
        texts = list(strengths[at : at + card]) or known
        at += card
        if sorted(texts) != sorted(known):
            raise NoisyMaxError(
                f"the strengths of parent {number + 1} are not an ordering of its states"
            )
        order = [int(text) for text in texts]
        if any(order[order[state]] != state for state in order):
            # which of two readings SMILE means shows only here, and in no file
            raise NoisyMaxError(f"the strengths of parent {number + 1} can be read in two ways")
        yield order


def _below(column: Sequence[float]) -> list[float]:
    """Return P(as strong as this state or weaker) for each state, from the strongest on."""
    return [min(math.fsum(column[state:]), 1.0) for state in range(len(column))]


def _row(causes: Sequence[Sequence[float]]) -> list[float]:
    """Return P(state): every cause by itself stays below what the strongest reaches."""
    reached = [*(math.prod(of) for of in zip(*causes, strict=True)), 0.0]
    values = [high - low for high, low in pairwise(reached)]
    total = math.fsum(values)
    return [max(value / total, 0.0) for value in values]

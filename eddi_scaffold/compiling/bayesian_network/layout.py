"""In which order the axes of each message lie in memory, so that few copies are needed.

A product sums over axes that both parts have (``summed``), keeps others of both (``batch``), and
has axes of the one or the other part only (``left``, ``right``). Numpy multiplies such arrays
without a copy when each group of axes is adjacent, so each message is laid out as its first reader
wants it, going backwards from the outputs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from eddi_scaffold.compiling.bayesian_network.graph import bits
from eddi_scaffold.compiling.bayesian_network.messages import Edge, Message

Axes = tuple[int, ...]


class Groups(NamedTuple):
    """The axes of a product; see the module."""

    batch: Axes
    left: Axes
    right: Axes
    summed: Axes


def layouts(
    operations: Sequence[Message],
    messages: Mapping[Edge, Message],
    resolve: Mapping[Edge, Edge],
) -> dict[Edge, Axes]:
    """Return the order of axes of each operation's result, slowest first.

    Args:
        operations: the products that are computed in each step, each behind its parts.
        messages: all messages.
        resolve: part -> the message that it is equal to.
    """
    computed = {operation.edge for operation in operations}
    order: dict[Edge, Axes] = {}
    for message in reversed(operations):
        wish = order.get(message.edge, tuple(bits(message.mask)))
        parts = [resolve[part] for part in message.parts]
        groups = groups_of(message, messages, parts, wish, order)
        if groups.summed and not _adjacent(wish, groups):
            wish = groups.batch + groups.left + groups.right
        order[message.edge] = wish
        for part, own in zip(parts, (groups.left, groups.right), strict=False):
            if part in computed and part not in order:
                both = (*groups.batch, *own, *groups.summed)
                kept = set(bits(messages[part].mask))
                order[part] = both if groups.summed else tuple(n for n in wish if n in kept)
    return order


def groups_of(
    message: Message,
    messages: Mapping[Edge, Message],
    parts: Sequence[Edge],
    wish: Axes,
    order: Mapping[Edge, Axes],
) -> Groups:
    """Return the groups of a product, each in the order of its result or of its parts.

    Args:
        message: the product.
        messages: all messages.
        parts: its two parts.
        wish: order of the axes of the result.
        order: orders that are settled.
    """
    one, other = (messages[part].mask for part in parts)
    summed = one & other & ~message.mask
    inside: list[int] = list(bits(summed))
    for part in parts:
        if part in order:
            inside = [node for node in order[part] if summed >> node & 1]
            break
    return Groups(
        batch=tuple(node for node in wish if (one & other) >> node & 1),
        left=tuple(node for node in wish if (one & ~other) >> node & 1),
        right=tuple(node for node in wish if (other & ~one) >> node & 1),
        summed=tuple(inside),
    )


def _adjacent(wish: Axes, groups: Groups) -> bool:
    places = {node: place for place, node in enumerate(wish)}
    for group in (groups.batch, groups.left, groups.right):
        where = [places[node] for node in group]
        if where and max(where) - min(where) != len(where) - 1:
            return False
    return True

"""A text as a tree of named pieces of whole lines: what is merged piece by piece."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from difflib import SequenceMatcher

_MOST_TWINS = 10_000
"""Pairs that are compared where items of a block share a key."""


@dataclass(frozen=True)
class Leaf:
    """A function, a statement, an element or the comments behind the last one.

    Attributes:
        key: what identifies it within its block.
        lines: its lines, with the comments above it.
    """

    key: str
    lines: tuple[str, ...]


@dataclass(frozen=True)
class Block:
    """A class, an element with others in it, commands from `if` to `endif`.

    Attributes:
        key: what identifies it within its block.
        header: the comments above it, and what opens it.
        items: its members, in the end what closes it.
    """

    key: str
    header: tuple[str, ...]
    items: tuple[Leaf | Block, ...]

    @property
    def lines(self) -> tuple[str, ...]:
        """All lines of the block."""
        return self.header + tuple(line for item in self.items for line in item.lines)


Item = Leaf | Block


def numbered(items: Iterable[Item]) -> Iterator[Item]:
    """Yield the items of a block with keys of their own: the second of a key is ``#2``."""
    seen: Counter[str] = Counter()
    for item in items:
        seen[item.key] += 1
        key = item.key if seen[item.key] == 1 else f"{item.key} #{seen[item.key]}"
        yield (
            Leaf(key, item.lines) if isinstance(item, Leaf) else Block(key, item.header, item.items)
        )


def aligned(items: Sequence[Item], before: Sequence[Item], mark: str) -> tuple[Item, ...]:
    """Give items that share a key the numbers of those that they were: position tells nothing.

    Args:
        items: of a block.
        before: of the block that it was made from.
        mark: sets the keys of new ones apart from those that somebody else adds.
    """
    old: dict[str, list[Item]] = {}
    own: dict[str, list[Item]] = {}
    for found, of in ((old, before), (own, items)):
        for item in of:
            found.setdefault(_plain_key(item), []).append(item)
    keys: dict[int, str] = {}
    for key, twins in own.items():
        known = old.get(key, [])
        if (len(twins) > 1 or len(known) > 1) and len(twins) * len(known) <= _MOST_TWINS:
            heirs = _heirs(known, twins)
            added = (f"{key} #{mark}{n}" for n in range(len(twins)))
            keys |= {id(one): heirs.get(id(one)) or next(added) for one in twins}
    return tuple(replace(item, key=keys.get(id(item), item.key)) for item in items)


def _heirs(known: Sequence[Item], twins: Sequence[Item]) -> dict[int, str]:
    """Return the key of each item that was there before; none overtakes another."""
    old, new = ([_plain(item) for item in items] for items in (known, twins))
    keys: dict[int, str] = {}
    for tag, i1, i2, j1, j2 in SequenceMatcher(None, old, new, autojunk=False).get_opcodes():
        first = j1
        for i in range(i1, i2) if tag in {"equal", "replace"} else ():
            choice = range(first, max(first + 1, j2 - (i2 - i - 1)))[: max(0, j2 - first)]
            if choice:
                alike = [(-len(set(old[i]) & set(new[j])), j) for j in choice]
                first = min(alike)[1] + 1
                keys[id(twins[first - 1])] = known[i].key
    return keys


def _plain(item: Item) -> tuple[str, ...]:
    return tuple(line.strip() for line in item.lines if line.strip())


def _plain_key(item: Item) -> str:
    return item.key.partition(" #")[0]


@dataclass
class Piece:
    """Where an element or a command is; lines are counted from 0.

    Attributes:
        key: what identifies it.
        start: its first line.
        opened: the last line of what opens it; of one without others in it, its last line.
        closes: the first line of what closes it.
        stop: its last line.
        inner: the pieces in it.
        solid: whether it has more in it than pieces and comments.
    """

    key: str
    start: int
    opened: int
    closes: int = -1
    stop: int = -1
    inner: list[Piece] = field(default_factory=list)
    solid: bool = False

    def extend(self, line: int) -> None:
        """Take a comment along that begins on the last line."""
        self.stop = max(self.stop, line)


def items_of(pieces: Sequence[Piece], lines: Sequence[str], first: int, depth: int) -> list[Item]:
    """Return the items of pieces; comments and blank lines belong to the piece below them.

    Args:
        pieces: in the order of the text.
        lines: of the whole text.
        first: the line behind the last one that belongs to something else.
        depth: levels that are split; what is deeper stays in one item.
    """
    found: list[Item] = []
    at, number = first, 0
    while number < len(pieces):
        piece = pieces[number]
        number += 1
        alone = True
        stop = piece.stop
        while number < len(pieces) and pieces[number].start <= stop:  # several on one line
            stop, alone = max(stop, pieces[number].stop), False
            number += 1
        if alone and depth > 0 and _has_own_lines(piece):
            inner = items_of(piece.inner, lines, piece.opened + 1, depth - 1)
            end = Leaf("<end>", tuple(lines[piece.inner[-1].stop + 1 : stop + 1]))
            header = tuple(lines[at : piece.opened + 1])
            found.append(Block(piece.key, header, (*numbered(inner), end)))
        else:
            found.append(Leaf(piece.key, tuple(lines[at : stop + 1])))
        at = stop + 1
    return found


def _has_own_lines(piece: Piece) -> bool:
    """Return whether the pieces in it share no line with what opens and closes it."""
    return (
        bool(piece.inner)
        and not piece.solid
        and piece.opened < piece.inner[0].start
        and max(one.stop for one in piece.inner) < piece.closes
    )

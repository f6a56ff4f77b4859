"""Keys of the indentation dialect: known ones in any case, unknown ones as notices."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from eddi_scaffold.mros.indent.lines import Line, LineCursor
from eddi_scaffold.mros.model import Notice
from eddi_scaffold.mros.text import Text


class Keys:
    """Walks through the keys of blocks and collects what is not known.

    Attributes:
        notices: unknown and misspelt keys so far.
    """

    def __init__(self, text: Text) -> None:
        self.text = text
        self.notices: list[Notice] = []

    def known(
        self, lines: Iterable[Line], keys: Iterable[str], what: str
    ) -> Iterator[tuple[str, LineCursor, Line]]:
        """Yield (key in lower case, rest of its line, line) of the known keys of a block.

        Raises:
            MrosSyntaxError: a line has no key.
        """
        wanted = tuple(keys)
        for line in lines:
            words = LineCursor(self.text, line)
            place = words.place()
            key = words.key(what)
            if key.lower() in wanted:
                yield key.lower(), words, line
            else:
                self._unknown(key, place, wanted)

    def _unknown(self, key: str, place: tuple[int, int], wanted: tuple[str, ...]) -> None:
        line, col = place
        near = next((known for known in wanted if edits(key.lower(), known) <= 2), None)
        if near is not None:
            fields = {"key": key, "meant": near}
            self.notices.append(Notice("M006.misspelt", line, col, fields))
        else:
            self.notices.append(Notice("M005.unknown_key", line, col, {"key": key}))


def edits(one: str, other: str) -> int:
    """Return how many letters must be inserted, removed or replaced, at most 3."""
    if abs(len(one) - len(other)) > 2:
        return 3
    row = list(range(len(other) + 1))
    for i, a in enumerate(one, 1):
        before, row[0] = row[0], i
        for j, b in enumerate(other, 1):
            before, row[j] = row[j], min(row[j] + 1, row[j - 1] + 1, before + (a != b))
    return min(row[-1], 3)

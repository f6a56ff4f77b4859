"""Hints on near names that stay affordable in a file with thousands of wrong ids."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eddi_scaffold.problems import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Collection

_MOST_NAMES = 5_000
_MOST_WORDS = 20


class NearNames:
    """Finds the known id that is most like a wrong one.

    Comparing texts is slow: only the first :data:`_MOST_WORDS` different words get a hint.
    """

    def __init__(self, known: Collection[str]) -> None:
        self._known = known if len(known) <= _MOST_NAMES else ()
        self._hints: dict[str, str | None] = {}

    def hint(self, word: str) -> str | None:
        """Return ``did you mean ...?``, ``None`` when nothing is near."""
        if word not in self._hints and len(self._hints) < _MOST_WORDS:
            self._hints[word] = did_you_mean(word, self._known)
        return self._hints.get(word)

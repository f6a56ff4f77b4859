"""Inputs of a model as far as a topic for them is sought; names as words, and their likeness."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from os.path import commonprefix
from pathlib import Path

from eddi_scaffold.common.toml_tables import read_toml
from eddi_scaffold.kinds import InputType

WORDS = read_toml(Path(__file__).with_name("words.toml"))
Synonyms = frozenset[frozenset[str]]  # groups of words; those of a group mean the same
_SYNONYMS: Synonyms = frozenset(frozenset(group.split()) for group in WORDS["synonyms"])
_SAYING_NOTHING = frozenset(WORDS["saying_nothing"].split())
_BREAK = re.compile(r"[^A-Za-z0-9]+|(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
_LONG = 4
_COMMON = 5
MEANS_THE_SAME = 0.7  # from this match on, a word is taken for another one


@cache
def words(text: str) -> tuple[str, ...]:
    """Split a name or a sentence into words: lower case, one word for each direction."""
    return tuple(
        WORDS["same"].get(word, word) for word in map(str.lower, _BREAK.split(text)) if word
    )


def _telling(text: str) -> list[str]:
    """Return the words of an input that tell what it is; all of them where none does."""
    every = list(dict.fromkeys(words(text)))
    return [word for word in every if word not in _SAYING_NOTHING] or every


@cache
def _likeness(first: str, second: str, synonyms: Synonyms) -> float:
    """Return how far two words mean the same, from 0 to 1."""
    if first == second:
        return 1.0
    if any(first in group and second in group for group in _SYNONYMS | synonyms):
        return 0.8
    common = len(commonprefix((first, second)))  # noqa: RUF071 - characters are meant
    shorter, longer = sorted((len(first), len(second)))
    if shorter >= _LONG and common == shorter:
        return 0.7
    return 0.6 if common >= _COMMON and 2 * common >= longer else 0.0


@dataclass(frozen=True)
class InputNeed:
    """What an input needs."""

    id: str
    type: InputType
    # of the model; `""` for a ratio, `None` where it has none or is not known
    unit: str | None = None
    description: str = ""  # of the model, for people
    is_demand: bool = False  # only the output of another monitor can fulfil it
    needs_age: bool = True  # a value that is too old would be dangerous
    states: tuple[str, ...] = ()  # names of the states of one that is a state
    timeout: float | None = None  # seconds after which the model takes it as unknown
    synonyms: Synonyms = frozenset()  # words that mean the same on this robot
    events: tuple[str, ...] = ()  # of the EDDI, that say when it holds, with their conditions

    @cached_property
    def words(self) -> Sequence[str]:
        """What the id tells."""
        return _telling(self.id)

    @cached_property
    def described(self) -> Sequence[str]:
        """What the description and the events tell."""
        return _telling(" ".join((self.description, *self.events)))

    @cached_property
    def compared(self) -> Sequence[str]:
        """What the conditions of the events read."""
        conditions = " ".join(event.partition(" (")[2] for event in self.events)
        return [word for word in words(conditions) if word.isalpha()]

    @cached_property
    def every_word(self) -> frozenset[str]:
        """All words of id and description."""
        return frozenset(words(f"{self.id} {self.description}"))

    @property
    def is_number(self) -> bool:
        """Whether it is one number."""
        return self.type in ("float", "int")

    def fit(self, word: str, others: Iterable[str]) -> float:
        """Return the best match of a word among others, from 0 to 1."""
        return max((_likeness(word, other, self.synonyms) for other in others), default=0.0)

    def says(self, any_of: str) -> bool:
        """Return whether id or description has one of some words."""
        return not self.every_word.isdisjoint(any_of.split())

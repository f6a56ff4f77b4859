"""Inputs of a model as far as a topic for them is sought."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

from eddi_scaffold.connect.name_words import Synonyms, best, telling, words
from eddi_scaffold.kinds import InputType, ModelInput


@dataclass(frozen=True)
class InputNeed:
    """What an input needs.

    Attributes:
        unit: of the model; ``""`` for a ratio, ``None`` where it has none or is not known.
        description: of the model, for people.
        is_demand: only the output of another monitor can fulfil it.
        needs_age: a value that is too old would be dangerous.
        states: names of the states of one that is a state.
        timeout: seconds after which the model takes it as unknown.
        synonyms: words that mean the same on this robot.
        events: of the EDDI, that say when it holds, with their conditions.
    """

    id: str
    type: InputType
    unit: str | None = None
    description: str = ""
    is_demand: bool = False
    needs_age: bool = True
    states: tuple[str, ...] = ()
    timeout: float | None = None
    synonyms: Synonyms = frozenset()
    events: tuple[str, ...] = ()

    @cached_property
    def words(self) -> Sequence[str]:
        """What the id tells."""
        return telling(self.id)

    @cached_property
    def described(self) -> Sequence[str]:
        """What the description and the events tell."""
        return telling(" ".join((self.description, *self.events)))

    @cached_property
    def told(self) -> Sequence[str]:
        """What the conditions of the events read."""
        conditions = " ".join(event.partition(" (")[2] for event in self.events)
        return [word for word in words(conditions) if word.isalpha()]

    @cached_property
    def every_word(self) -> frozenset[str]:
        """All words of id and description."""
        return frozenset(words(f"{self.id} {self.description}"))

    @classmethod
    def of(
        cls, item: ModelInput, synonyms: Synonyms = frozenset(), events: tuple[str, ...] = ()
    ) -> InputNeed:
        """Return what an input of a model needs."""
        text = item.description or ""
        return cls(
            item.id,
            item.type,
            item.unit,
            text,
            item.is_demand,
            item.safety,
            item.states,
            item.timeout,
            synonyms,
            events,
        )

    def fit(self, word: str, others: Iterable[str]) -> float:
        """Return the best match of a word among others, from 0 to 1."""
        return best(word, others, self.synonyms)

    def says(self, *some: str) -> bool:
        """Return whether id or description has one of some words."""
        return not self.every_word.isdisjoint(some)

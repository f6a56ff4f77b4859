"""What inputs need, topics of a robot, and the values that their messages hold."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import islice
from os.path import commonprefix
from pathlib import Path
from typing import Literal

from eddi_scaffold.common import units
from eddi_scaffold.common.identifiers import TODO, attribute, is_identifier
from eddi_scaffold.common.toml_tables import read_toml
from eddi_scaffold.config.field_types import Fields, element, is_primitive, python_type
from eddi_scaffold.kinds import ModelInput
from eddi_scaffold.monitors.message_types.documented import documented
from eddi_scaffold.mros.topics import TopicEntry

WORDS = read_toml(Path(__file__).with_name("words.toml"))
Synonyms = frozenset[frozenset[str]]  # groups of words; those of a group mean the same
_SYNONYMS: Synonyms = frozenset(frozenset(group.split()) for group in WORDS["synonyms"].values())
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
class InputNeed(ModelInput):
    """An input of a model, and what else tells which topic may fill it."""

    synonyms: Synonyms = frozenset()  # words that mean the same on this robot
    events: tuple[str, ...] = ()  # of the EDDI, that say when it holds, with their conditions

    @cached_property
    def words(self) -> Sequence[str]:
        """What the id tells."""
        return _telling(self.id)

    @cached_property
    def described(self) -> Sequence[str]:
        """What the description and the events tell."""
        return _telling(" ".join((self.description or "", *self.events)))

    @cached_property
    def compared(self) -> Sequence[str]:
        """What the conditions of the events read."""
        conditions = " ".join(event.partition(" (")[2] for event in self.events)
        return [word for word in words(conditions) if word.isalpha()]

    @cached_property
    def every_word(self) -> frozenset[str]:
        """All words of id and description."""
        return frozenset(words(f"{self.id} {self.description or ''}"))

    @property
    def is_number(self) -> bool:
        """Whether it is one number."""
        return self.type in ("float", "int")

    def fit(self, word: str, others: Iterable[str]) -> float:
        """Return the best match of a word among others, from 0 to 1."""
        return max((_likeness(word, other, self.synonyms) for other in others), default=0.0)

    def says(self, *texts: str) -> bool:
        """Return whether id or description has a word of some texts."""
        return not self.every_word.isdisjoint(" ".join(texts).split())


FieldsOf = Callable[[str], Fields | None]
_DEPTH = 6
_MOST = 1000  # fields of a message that are looked at, with those inside of its fields
_MATRIX = re.compile(r"float(?:32|64)\[(9|36)\]")


@dataclass(frozen=True)
class RobotTopic(TopicEntry):
    """A topic of the robot, with ``package/Type`` as its type."""

    @property
    def is_of_monitor(self) -> bool:
        """Whether one of our own monitors publishes it."""
        return self.type.startswith("eddi_messages/")

    @cached_property
    def message(self) -> str:
        """The name of the type without its package."""
        return self.type.rpartition("/")[2]

    @cached_property
    def words(self) -> Sequence[str]:
        """What topic and id tell."""
        return (*words(self.topic), *words(self.id))


@dataclass(frozen=True)
class TopicField:
    """One value of a message, or one element of a list of values."""

    # names of fields, with `[]` behind a list and `[7]` behind one element of a matrix; empty where
    # the fields of the message are not known
    path: tuple[str, ...]
    type: str  # `bool`, `int`, `float` or `str`; empty where it is not known
    # in which it may be; none when it has none, `None` when that is not known
    units: tuple[str, ...] | None
    is_only: bool = False  # the message holds nothing else

    @cached_property
    def text(self) -> str:
        """The path as text."""
        return ".".join(self.path)

    @cached_property
    def lists(self) -> int:
        """How many lists its path goes through."""
        return sum(name.endswith("[]") for name in self.path)

    @cached_property
    def is_list(self) -> bool:
        """Whether it is an element of the only list."""
        return self.lists == 1 and self.text.endswith("[]")

    @property
    def is_variance(self) -> bool:
        """Whether it says how uncertain another value is."""
        return "variance" in self.path[-1] if self.path else False  # of covariance as well

    @property
    def read_units(self) -> tuple[str, ...] | None:
        """The units in which it is read: of a variance, those of the deviation."""
        if self.units is None or not self.is_variance:
            return self.units
        return tuple(units.root(unit) or unit for unit in self.units)


def leaves(message: str, fields_of: FieldsOf) -> list[TopicField]:
    """Return the values of a message; of a monstrous one the first, models are any text."""
    if fields_of(message) is None:
        return [TopicField((), "", None)]
    visited = islice(_fields(message, (), fields_of, (message,)), _MOST)
    ends = [end for end in visited if end is not None]
    fields = []
    for path, type_ in ends:
        known = documented(message, path, fields_of)
        unit = None if known is None else known.units
        fields.append(TopicField(path, python_type(type_), unit, len(ends) == 1))
    return fields


def _fields(
    message: str, path: tuple[str, ...], fields_of: FieldsOf, above: tuple[str, ...]
) -> Iterator[tuple[tuple[str, ...], str] | None]:
    """Yield path and type of each value below a message, and ``None`` for any other field."""
    for name, type_ in (fields_of(message) or {}).items():
        yield None
        if not is_identifier(name):
            continue
        matrix = _MATRIX.fullmatch(type_)
        if matrix and "covariance" in name:
            size = {"9": 3, "36": 6}[matrix[1]]
            for index in range(size):
                yield (*path, f"{name}[{index * (size + 1)}]"), "float64"
            continue
        single = element(type_)
        inner = (*path, name if single is None else f"{name}[]")
        end = single or type_
        if is_primitive(end):
            yield inner, end
        elif end not in above and len(above) < _DEPTH and name != "header":
            yield from _fields(end, inner, fields_of, (*above, end))


@dataclass(frozen=True)
class FieldUse:
    """What is written for an input."""

    key: Literal["field", "expression"]  # `field` or `expression`
    text: str  # its value
    # the value is in this one, and converted; `None` where it is that of the model
    unit: str | None = None
    is_complete: bool = True  # nothing in it is left to a person


def access(need: InputNeed, topic: RobotTopic, leaf: TopicField) -> FieldUse:
    """Return how an input takes a value of a topic."""
    if not leaf.path:
        return FieldUse("field", TODO, is_complete=False)
    path, name = leaf.text.replace("[]", f"[{TODO}]"), attribute(topic.id)
    unit = _unit_to_convert(need, leaf)
    if need.type.endswith("[]") and leaf.is_list:
        return FieldUse("field", leaf.text.removesuffix("[]"), unit)
    if leaf.is_variance:
        return FieldUse("expression", f"SQRT({name}.{path})", unit, not leaf.lists)
    # a scan has other numbers as well: the share of it that fits a map is not its least range
    is_called_distance = need.says(WORDS["synonyms"]["distance"], WORDS["least"])
    is_distance = need.is_number and (need.unit is not None or is_called_distance)
    if topic.message in WORDS["scans"].split() and leaf.path[0] == "ranges[]" and is_distance:
        every = leaf.text.replace("[]", "[*]")
        return FieldUse("expression", f"MIN({name}.{every}, COVERAGE 0.9)", unit)
    if need.type == "bool" and leaf.type != "bool":
        return FieldUse("expression", f"{name}.{path} == {TODO}", None, is_complete=False)
    return FieldUse("field", path, unit, not leaf.lists and not topic.is_of_monitor)


def _unit_to_convert(need: InputNeed, leaf: TopicField) -> str | None:
    if need.unit is None:
        return None
    factors = {unit: units.factor(unit, need.unit) for unit in leaf.read_units or ()}
    convertible = [unit for unit, factor in factors.items() if factor is not None]
    return None if 1 in factors.values() or not convertible else convertible[0]

"""Three-valued truth, and how a raw input value becomes one: raw values are never truth-tested.

Truth values are the small ints ``FALSE < UNKNOWN < TRUE`` (strong Kleene): And is the minimum, Or
the maximum. ``bool(float("nan"))`` and ``bool("False")`` are true in Python, so each leaf accepts
exact types only and everything else is UNKNOWN.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, FrozenSet, Optional, Tuple, Union

from ..plain_values import plain, show

FALSE, UNKNOWN, TRUE = 0, 1, 2
NAMES = ("FALSE", "UNKNOWN", "TRUE")

# Why a leaf has its value; plain texts, they are used in reports.
GOOD, NOT_COVERED, MISSING, NAN, FAULT = "good", "false", "missing", "nan", "fault"

Judgement = Tuple[int, str]
"""(truth value, why)."""


class Absent:
    """Stands for an attribute that could not be read.

    Attributes:
        problem: why, empty when the object simply has no such attribute.
    """

    __slots__ = ("problem",)

    def __init__(self, problem: str = "") -> None:
        self.problem = problem


ABSENT = Absent()


@dataclass(frozen=True)
class Interval:
    """A range in the unit of the input; the start lies inside.

    Attributes:
        start: smallest double inside.
        end: the other end.
        closed: the end lies inside as well.
    """

    start: float
    end: float
    closed: bool

    def covers(self, number: float) -> bool:
        """Return whether a number other than NaN lies in the range."""
        return self.start <= number and (number <= self.end if self.closed else number < self.end)


@dataclass(frozen=True)
class BinaryLeaf:
    """A leaf with the value True or False: binary evidence, or any demand."""

    id: str

    def judge_plain(self, value: Any) -> Judgement:
        """Judge a value of an exact Python type; see ``judge``."""
        if isinstance(value, bool):
            return (TRUE, GOOD) if value else (FALSE, NOT_COVERED)
        return UNKNOWN, FAULT

    def expectation(self) -> str:
        """Return what the leaf accepts, for people."""
        return "True or False"


@dataclass(frozen=True)
class CategoricalLeaf:
    """A leaf with a text as value, which should be among the covered ones."""

    id: str
    covered: FrozenSet[str]
    text: str = ""

    def judge_plain(self, value: Any) -> Judgement:
        """Judge a value of an exact Python type; see ``judge``."""
        if isinstance(value, str):
            return (TRUE, GOOD) if value in self.covered else (FALSE, NOT_COVERED)
        return UNKNOWN, FAULT

    def expectation(self) -> str:
        """Return what the leaf accepts, for people."""
        return "a text"


@dataclass(frozen=True)
class NumericLeaf:
    """A leaf with a number as value, which should lie in one of the ranges.

    Attributes:
        ranges: in the unit of the input (a factor is already in the bounds).
        text: the ranges as in the model, for people.
    """

    id: str
    ranges: Tuple[Interval, ...]
    text: str = ""

    def judge_plain(self, value: Any) -> Judgement:
        """Judge a value of an exact Python type; see ``judge``."""
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            return UNKNOWN, FAULT
        inside = any(interval.covers(value) for interval in self.ranges)
        return (TRUE, GOOD) if inside else (FALSE, NOT_COVERED)

    def expectation(self) -> str:
        """Return what the leaf accepts, for people."""
        return "a number"


Leaf = Union[BinaryLeaf, CategoricalLeaf, NumericLeaf]


def judge(leaf: Leaf, raw: object) -> Judgement:
    """Return the truth value of a raw input value and why; never raises.

    None, absent and NaN are UNKNOWN; a value of another type than the leaf expects is UNKNOWN and
    a fault. Subclasses of the expected types and numpy scalars count by their plain value.
    """
    if raw is None or raw is ABSENT:
        return UNKNOWN, MISSING
    try:
        value = plain(raw)
        if isinstance(value, float) and value != value:  # noqa: PLR0124 - the test for NaN
            return UNKNOWN, NAN
        return leaf.judge_plain(value)
    except Exception:  # noqa: BLE001 - a hostile object: whatever it raises, it is no evidence
        return UNKNOWN, FAULT


def describe(leaf: Leaf, raw: object, why: str) -> str:
    """Return one line for people on why the leaf is not TRUE."""
    if why == MISSING:
        return "no value"
    if why == NAN:
        return "the value is NaN"
    if why == FAULT:
        problem = raw.problem if type(raw) is Absent else ""  # isinstance asks the object
        return problem or f"expected {leaf.expectation()}, got {show(raw)}"
    if isinstance(leaf, BinaryLeaf):
        return "the value is False"
    covered = leaf.text if len(leaf.text) <= 200 else f"{leaf.text[:197]}..."
    return f"the value {show(raw)} is not in {covered}"


def nearest_double(exact: Optional[Any], text: str) -> float:
    """Return the double nearest to an exact bound, or to its text when there is no factor."""
    if exact is None:
        return float(text)
    try:
        return float(exact)
    except OverflowError:
        return math.inf if exact > 0 else -math.inf

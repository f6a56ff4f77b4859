"""Three-valued truth, and how a raw input value becomes one: raw values are never truth-tested.

Truth values are the small ints ``FALSE < UNKNOWN < TRUE`` (strong Kleene): And is the minimum, Or
the maximum. ``bool(float("nan"))`` and ``bool("False")`` are true in Python, so each leaf accepts
exact types only and everything else is UNKNOWN.
"""

from __future__ import annotations

from typing import Sequence, Tuple, Union

from ..plain_values import ABSENT, Absent, plain, show

FALSE, UNKNOWN, TRUE = 0, 1, 2
NAMES = ("FALSE", "UNKNOWN", "TRUE")

# Why a leaf has its value; plain texts, they are used in reports.
GOOD, NOT_COVERED, MISSING, NAN, FAULT = "good", "false", "missing", "nan", "fault"

Judgement = Tuple[int, str]
"""(truth value, why)."""


Range = Tuple[float, float, bool]
"""(smallest double inside, the other end, does that lie inside), in the unit of the input."""


class Binary:
    """A leaf with the value True or False: binary evidence, or any demand."""

    def judge_plain(self, value: object) -> Judgement:
        """Judge a value of an exact Python type; see ``judge``."""
        if isinstance(value, bool):
            return (TRUE, GOOD) if value else (FALSE, NOT_COVERED)
        return UNKNOWN, FAULT

    def why_false(self, value: object) -> str:
        """Return why a value that the leaf accepts is FALSE, for people."""
        return "the value is False"

    def expectation(self) -> str:
        """Return what the leaf accepts, for people."""
        return "True or False"


class Categorical:
    """A leaf with a text as value, which should be among the covered ones."""

    def __init__(self, *covered: str) -> None:
        self.covered = frozenset(covered)
        self._text = "{" + ", ".join(covered) + "}"

    def judge_plain(self, value: object) -> Judgement:
        """Judge a value of an exact Python type; see ``judge``."""
        if isinstance(value, str):
            return (TRUE, GOOD) if value in self.covered else (FALSE, NOT_COVERED)
        return UNKNOWN, FAULT

    def why_false(self, value: object) -> str:
        """Return why a value that the leaf accepts is FALSE, for people."""
        return _not_in(value, self._text)

    def expectation(self) -> str:
        """Return what the leaf accepts, for people."""
        return "a text"


class Numeric:
    """A leaf with a number as value, which should lie in one of the ranges.

    Args:
        ranges: in the unit of the input (a factor is already in the bounds).
        text: the ranges as in the model, for people.
    """

    def __init__(self, ranges: Sequence[Range], text: str) -> None:
        self.ranges = ranges
        self._text = text

    def judge_plain(self, value: object) -> Judgement:
        """Judge a value of an exact Python type; see ``judge``."""
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            return UNKNOWN, FAULT
        inside = any(
            start <= value and (value <= end if closed else value < end)
            for start, end, closed in self.ranges
        )
        return (TRUE, GOOD) if inside else (FALSE, NOT_COVERED)

    def why_false(self, value: object) -> str:
        """Return why a value that the leaf accepts is FALSE, for people."""
        return _not_in(value, self._text)

    def expectation(self) -> str:
        """Return what the leaf accepts, for people."""
        return "a number"


Leaf = Union[Binary, Categorical, Numeric]


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
    return leaf.why_false(raw)


def _not_in(value: object, covered: str) -> str:
    short = covered if len(covered) <= 200 else f"{covered[:197]}..."
    return f"the value {show(value)} is not in {short}"

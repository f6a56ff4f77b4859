"""Three-valued truth, and how a raw input value becomes one: raw values are never truth-tested.

Truth values are the small ints ``FALSE < UNKNOWN < TRUE`` (strong Kleene): And is the minimum, Or
the maximum. ``bool(float("nan"))`` and ``bool("False")`` are true in Python, so each leaf accepts
exact types only and everything else is UNKNOWN.
"""

from __future__ import annotations

from typing import Sequence, Tuple

from ..plain_values import ABSENT, Absent, plain, show

FALSE, UNKNOWN, TRUE = 0, 1, 2
NAMES = ("FALSE", "UNKNOWN", "TRUE")

# Why a leaf has its value; plain texts, they are used in reports.
GOOD, NOT_COVERED, MISSING, NAN, FAULT = "good", "false", "missing", "nan", "fault"

Judgement = Tuple[int, str]
"""(truth value, why)."""

Range = Tuple[float, float, bool]
"""(smallest double inside, the other end, does that lie inside), in the unit of the input."""


class Leaf:
    """How the value of an input is judged."""

    expected = ""  # what it accepts, for people
    covered_text = ""  # what of that is TRUE, as in the model

    def judge(self, raw: object) -> Judgement:
        """Return the truth value of a raw input value and why; never raises.

        None, absent and NaN are UNKNOWN; a value of another type than the leaf expects is UNKNOWN
        and a fault. Subclasses of the expected types and numpy scalars count by their plain value.
        """
        if raw is None or raw is ABSENT:
            return UNKNOWN, MISSING
        try:
            value = plain(raw)
            if isinstance(value, float) and value != value:  # noqa: PLR0124 - the test for NaN
                return UNKNOWN, NAN
            covered = self._covers(value)
        except Exception:  # noqa: BLE001 - a hostile object: whatever it raises, it is no evidence
            covered = None
        if covered is None:
            return UNKNOWN, FAULT
        return (TRUE, GOOD) if covered else (FALSE, NOT_COVERED)

    def _covers(self, value: object) -> bool | None:
        """Return whether a value of an exact Python type is covered, None for another type."""
        raise NotImplementedError

    def describe(self, raw: object, why: str) -> str:
        """Return one line for people on why the leaf is not TRUE."""
        if why == MISSING:
            return "no value"
        if why == NAN:
            return "the value is NaN"
        if why == FAULT:
            problem = raw.problem if type(raw) is Absent else ""  # isinstance asks the object
            return problem or f"expected {self.expected}, got {show(raw)}"
        if not self.covered_text:
            return f"the value is {show(raw)}"
        text = self.covered_text
        short = text if len(text) <= 200 else f"{text[:197]}..."
        return f"the value {show(raw)} is not in {short}"


class Binary(Leaf):
    """A leaf with the value True or False, of which one is good: evidence, or any demand."""

    expected = "True or False"

    def __init__(self, good: bool = True) -> None:
        self.good = good

    def _covers(self, value: object) -> bool | None:
        return value is self.good if isinstance(value, bool) else None


class Categorical(Leaf):
    """A leaf with a text as value, which should be among the covered ones."""

    expected = "a text"

    def __init__(self, *covered: str) -> None:
        self.covered = frozenset(covered)
        self.covered_text = "{" + ", ".join(covered) + "}"

    def _covers(self, value: object) -> bool | None:
        return value in self.covered if isinstance(value, str) else None


class Numeric(Leaf):
    """A leaf with a number as value, which should lie in a range; the text shows the ranges."""

    expected = "a number"

    def __init__(self, ranges: Sequence[Range], text: str) -> None:
        self.ranges = ranges
        self.covered_text = text

    def _covers(self, value: object) -> bool | None:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            return None
        return any(
            start <= value and (value <= end if closed else value < end)
            for start, end, closed in self.ranges
        )

"""Three-valued truth: how a raw input value becomes one, and why a guarantee is as it is.

``FALSE < UNKNOWN < TRUE`` (strong Kleene): And is the minimum, Or the maximum. NaN and "False" are
true in Python, so each leaf accepts exact types only and everything else is UNKNOWN.
"""

from __future__ import annotations

from typing import Any, Callable, Mapping, NamedTuple, Optional, Sequence, Tuple

from ..plain_values import ABSENT, Absent, plain, show
from ..why import FALSE, TEXTS, TRUE, UNKNOWN, Cause, shown

NAMES = ("FALSE", "UNKNOWN", "TRUE")

# Why a leaf has its value; plain texts, they are used in reports.
GOOD, NOT_COVERED, MISSING, NAN, FAULT = "good", "false", "missing", "nan", "fault"

Judgement = Tuple[int, str]  # (truth value, why)

Range = Tuple[float, float, bool]
"""(smallest double inside, the other end, does that lie inside), in the unit of the input."""


class Leaf:
    """How the value of an input is judged."""

    expected = ""  # what it accepts, for people
    # whether a value of an exact Python type is covered, None for another type
    _covers: Callable[[Any], Optional[bool]]

    def judge(self, raw: object) -> Judgement:
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

    def fault(self, raw: object) -> str:
        """Return why a value is none of this input."""
        problem = raw.problem if type(raw) is Absent else ""  # isinstance asks the object
        return problem or f"expected {self.expected}, got {show(raw)}"

    def cause(self, raw: object, why: str) -> Cause:
        """Return why a value is not good, where its messages do not tell it."""
        if why == NOT_COVERED:
            return Cause((), "false", self._wrong(plain(raw)))
        text = {MISSING: "no value", NAN: "NaN"}.get(why) or self.fault(raw)
        return Cause((), "invalid", text)

    def _wrong(self, value: Any) -> str:
        """Return the text of a value that is not good."""
        return TEXTS["false"]


class Binary(Leaf):
    """A leaf with the value True or False, of which one is good: evidence, or any demand."""

    expected = "True or False"

    def __init__(self, good: bool = True) -> None:
        self.good = good

    def _covers(self, value: object) -> bool | None:
        return value is self.good if isinstance(value, bool) else None

    def _wrong(self, value: Any) -> str:
        return TEXTS["false"] if self.good else "true for {since}"


class Categorical(Leaf):
    """A leaf with a text as value, which should be among the covered ones."""

    expected = "a text"

    def __init__(self, *covered: str) -> None:
        self.covered = frozenset(covered)
        self.needs = " or ".join(covered)

    def _covers(self, value: object) -> bool | None:
        return value in self.covered if isinstance(value, str) else None

    def _wrong(self, value: Any) -> str:
        return f"{shown(value)} for {{since}}, needs {self.needs}"


class Numeric(Leaf):
    """A leaf with a number as value, which should lie in a range; the text shows the ranges."""

    expected = "a number"

    def __init__(
        self,
        ranges: Sequence[Range],
        text: str,
        needs: str = "",  # the same in the short form, in the unit of the model
        unit: str = "",
        factor: tuple[int, int] = (1, 1),  # a value times this is in that unit
    ) -> None:
        self.ranges = ranges
        self.needs, self.unit, self.factor = needs or text, unit, factor

    def _wrong(self, value: Any) -> str:
        return f"{shown(value, self.unit, self.factor)} for {{since}}, needs {self.needs}"

    def _covers(self, value: object) -> bool | None:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            return None
        return any(
            start <= value and (value <= end if closed else value < end)
            for start, end, closed in self.ranges
        )


Group = Tuple[str, ...]  # ids of inputs, sorted


class Explanation(NamedTuple):
    """Why one guarantee is as it is after the last step."""

    guarantee: str  # id as in the model
    active: bool  # it is active
    verdict: str  # ``TRUE``, ``UNKNOWN`` or ``FALSE``
    # inactive: each minimal set of inputs that would activate it by becoming TRUE
    missing: tuple[Group, ...]
    single_losses: Group  # active: each input whose loss alone would deactivate it, by id
    reasons: Mapping[str, str]  # for each input in ``missing``, why it is not TRUE
    truncated: bool  # there are more sets, and a listed one may be larger than needed
    # each input that rests on the words of other robots, with their names
    robots: Mapping[str, tuple[str, ...]] = {}

    def text(self) -> str:
        if self.active:
            losses = ", ".join(map(self._named, self.single_losses)) or "no single input"
            others = sorted(set(self.robots) - set(self.single_losses))
            granted = f"; granted: {', '.join(map(self._named, others))}" if others else ""
            return f"{self.guarantee} is active; its loss would end it: {losses}{granted}"
        lines = [f"{self.guarantee} is {self.verdict}, not active"]
        if not self.missing:
            lines.append("  nothing can activate it")
        for group in self.missing:
            needs = [f"{name} ({self.reasons[name]})" for name in group]
            lines += [f"  needs {' and '.join(needs)}"]
        if self.truncated:
            lines.append("  ... and more")
        return "\n".join(lines)

    def _named(self, name: str) -> str:
        robots = self.robots.get(name)
        return f"{name} by the word of {' and '.join(robots)}" if robots else name


class Guarantee(NamedTuple):
    """One guarantee."""

    id: str  # as in the model
    node: int = -1  # its number in the graph of ``search``, where its path sets are too many
    published: str = ""  # the id in the output, empty where it is the same
    default: bool = False  # holds always, without support
    ranking: int | None = None  # lowest is best, ``None`` when not given
    # the minimal sets of inputs of which each gives it, by size, then by ids
    paths: tuple[Group, ...] = ()


class Sets:
    """What follows of the guarantees in one state of the inputs, given by their ids."""

    def __init__(self, inputs: Sequence[str], leaf_values: Sequence[int]) -> None:
        self.leaf_values = leaf_values
        values = [*zip(inputs, leaf_values)]
        self._true = {name for name, value in values if value == TRUE}
        self._not_false = {name for name, value in values if value != FALSE}
        self._missing: dict[str, tuple[list[Group], bool]] = {}

    def value(self, guarantee: Guarantee) -> int:
        if any(map(self._true.issuperset, guarantee.paths)):
            return TRUE
        return UNKNOWN if any(map(self._not_false.issuperset, guarantee.paths)) else FALSE

    def missing(self, guarantee: Guarantee) -> tuple[list[Group], bool]:
        """Return the minimal sets of inputs that would make it TRUE, and "truncated"."""
        if guarantee.id not in self._missing:
            holds = self.value(guarantee) == TRUE
            self._missing[guarantee.id] = ([], False) if holds else self._lacking(guarantee)
        return self._missing[guarantee.id]

    def _lacking(self, guarantee: Guarantee) -> tuple[list[Group], bool]:
        """Return the groups that contain no other one, by size, then by ids."""
        true = self._true
        rests = {tuple([name for name in path if name not in true]) for path in guarantee.paths}
        kept: list[Group] = []
        inside: list[frozenset[str]] = []
        for group in sorted(rests, key=lambda rest: (len(rest), rest)):
            names = frozenset(group)
            if not any(map(names.issuperset, inside)):
                kept.append(group)
                inside.append(names)
        return kept, False

    def single_losses(self, guarantee: Guarantee) -> Group:
        """Return the inputs whose single loss makes a TRUE guarantee not TRUE, by id."""
        first, *others = [path for path in guarantee.paths if self._true.issuperset(path)]
        return tuple(sorted(set(first).intersection(*others)))

    def granting(self, guarantee: Guarantee) -> Group:
        """Return the TRUE inputs that a guarantee can rest on."""
        return tuple(
            sorted(self._true.intersection(name for path in guarantee.paths for name in path))
        )

"""What every model of a monitor can do, what it is given and what it reports in a step."""

from __future__ import annotations

import math
import sys
from operator import itemgetter, mul
from types import MappingProxyType
from typing import Any, Callable, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Union

from ..plain_values import Absent, plain, show

Values = Mapping[str, Any]
"""Input id -> bool, float, list of them with None, or None where nothing is known."""

NAN = float("nan")
NOTHING: Mapping[str, str] = MappingProxyType({})
AGAIN = "it reports that a failed part works again; ignored without `repair: true`"


class Moment(NamedTuple):
    """When a step is."""

    quanta: int  # how many quanta have passed since the last step
    hours: float  # the same in hours
    age: float  # hours since the first step
    horizon: float  # hours from now to the horizon
    at: int  # position of the horizon among those that were prepared


class Estimate(NamedTuple):
    """Probability of failure from now to the horizon."""

    low: float  # in the best case of what is unknown, or was when it mattered
    high: float  # in the worst case; equal to ``low`` when nothing was missed
    reliability: float  # probability of no failure in the worst case
    mttf: float  # remaining mean time to failure in hours; NaN: not computed
    unknown: tuple[str, ...] = ()  # inputs on which the result depends and that are not known
    reason: str = ""  # why the result cannot be trusted for another reason; empty otherwise


Known = Mapping[str, Estimate]  # model -> what it reported in this step

_new = tuple.__new__


def sure(p: float, reliability: float, mttf: float, reason: str = "") -> Estimate:
    """Return an estimate of which all inputs are known; twice as fast as the class."""
    return _new(Estimate, (p, p, reliability, mttf, (), reason))


def reader(names: Sequence[str]) -> Callable[[Values], tuple[object, ...]]:
    """Return what reads the values of some inputs as a tuple."""
    if len(names) > 1:
        return itemgetter(*names)
    return lambda values: tuple([values[name] for name in names])


class Importance(NamedTuple):
    """How much one event matters for the top event, at present probabilities."""

    event: str  # its name
    probability: float  # of the event
    birnbaum: float  # p(top | event) - p(top | not event)
    criticality: float  # share of the top's probability in which the event decides
    achievement: float  # risk achievement worth: p(top | event) / p(top)
    reduction: float  # risk reduction worth: p(top) / p(top | not event)


class Component:
    """One model of a monitor; it is asked once a step, behind those that it uses."""

    grows: bool = True  # what lies ahead never gets less probable with the horizon
    # input id -> what is wrong with its value, since the monitor took this over
    said: Mapping[str, str] = NOTHING

    def report_fault(self, name: str, text: str) -> None:
        said: dict[str, str] = {**self.said, name: text}
        self.said = said

    def has_failed(
        self, name: str, now: bool | None, *, before: bool, repair: bool
    ) -> bool | None:
        """Return what an input says now, of which a failure stays one unless there is repair."""
        if not before or now or repair:
            return now
        if now is False:
            self.report_fault(name, AGAIN)
        return True

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        """Let time pass, take the observations, look ahead."""
        raise NotImplementedError

    def doubt(self) -> str:
        """Return what was missed before and is still open, in words; empty for nothing."""
        return ""

    def importances(self) -> tuple[Importance, ...]:
        """Return how much each event of a fault tree matters now; empty for other models."""
        return ()

    def reset(self) -> None:
        """Return to the start of the mission."""
        self.said = NOTHING


Taken = Union[bool, float, List[Optional[bool]], None]


class Rule(NamedTuple):
    """What an input is."""

    type: str  # ``bool``, ``float``, ``int`` or ``bool[]``
    low: float = 0.0  # least number that is believed
    high: float = math.inf  # largest number
    slack: float = 0.0  # how far outside a number may be and is taken as the limit
    length: int = 0  # of a list

    def divided(self, num: int, den: int) -> Rule:
        high = self.high if self.high == FINITE else self.high * den / num
        return self._replace(low=self.low * den / num, high=high, slack=self.slack * den / num)


FINITE = sys.float_info.max


def take(rule: Rule, raw: object) -> tuple[Taken, str]:
    """Return the value, None when it is not known, and what is wrong with it; never raises."""
    if raw is None:
        return None, ""
    if type(raw) is Absent:  # isinstance asks the object
        return None, raw.problem
    try:
        if rule.type == "bool[]":
            return _list(rule, raw)
        value = plain(raw)
    except Exception as problem:  # noqa: BLE001 - a hostile object
        return None, f"it cannot be read: {type(problem).__name__}"
    if rule.type == "bool":
        if isinstance(value, bool):
            return value, ""
        return None, "" if value != value else _wrong("true or false", raw)  # noqa: PLR0124 - NaN
    return _number(rule, value, raw)


def _number(rule: Rule, value: Any, raw: object) -> tuple[Taken, str]:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None, _wrong("a number", raw)
    if isinstance(value, float) and math.isnan(value):
        return None, ""
    if not rule.low - rule.slack <= value <= rule.high + rule.slack:
        wide = f"a finite number of at least {rule.low:.15g}"
        usual = f"a number from {rule.low:.15g} to {rule.high:.15g}"
        return None, _wrong(wide if rule.high == FINITE else usual, raw)
    if rule.type == "int" and value != int(value):
        return None, _wrong("a whole number", raw)
    return min(max(float(value), rule.low), rule.high), ""


def _list(rule: Rule, raw: Any) -> tuple[Taken, str]:
    if isinstance(raw, (str, bytes, dict)) or not hasattr(raw, "__len__"):
        return None, "" if raw != raw else _wrong("a list", raw)  # noqa: PLR0124 - NaN
    items = [plain(entry) for entry in raw]
    if len(items) not in (0, rule.length):
        return None, f"{rule.length} statuses are expected, not {len(items)}"
    return [item if isinstance(item, bool) else None for item in items] or None, ""


def _wrong(expected: str, raw: object) -> str:
    return f"{expected} is expected, not {show(raw)}"


class ReliabilityResult(NamedTuple):
    """The reliability over the horizon."""

    valid: bool  # everything on which the result depends is known, and no error occurred
    p_fail: float  # probability of failure from now to the horizon, in the worst case
    p_fail_low: float  # in the best case of what is unknown, and of what was missed before
    p_fail_high: float  # in the worst case
    reliability: float  # probability of no failure from now to the horizon
    mttf: float  # remaining mean time to failure in hours; inf; NaN: not computed
    horizon: float  # hours from now
    evidence: Mapping[str, bool]  # id of a threshold -> active
    unknown: tuple[str, ...]  # inputs that are not known
    # why the result is not valid; of a valid one, what was missed before and is still open
    reason: str
    contributions: Mapping[str, float]  # model -> its p_fail_high


Matrix = Sequence[Sequence[float]]


def factors(powers: list[Matrix], quanta: int) -> Iterator[Matrix]:
    """Yield the powers that make up one of ``quanta``: as many as binary ones in it."""
    for bit in range(quanta.bit_length()):
        if bit == len(powers):
            columns = list(zip(*powers[-1]))
            square = [[dot(row, column) for column in columns] for row in powers[-1]]
            powers.append(
                [[p / whole for p in row] for row, whole in zip(square, map(sum, square))]
            )
        if quanta >> bit & 1:
            yield powers[bit]


def dot(left: Sequence[float], right: Sequence[float]) -> float:
    """Return the sum of products."""
    total: float = sum(map(mul, left, right))
    return total


_LARGEST = 709.0
_NEW = 1e-9


def hazard(age: float, ahead: float, scale: float, shape: float) -> float:
    """Return ((age + ahead) / scale) ** shape - (age / scale) ** shape without cancellation."""
    try:
        if age <= _NEW * ahead:
            return float(((age + ahead) / scale) ** shape - (age / scale) ** shape)
        return float((age / scale) ** shape * math.expm1(shape * math.log1p(ahead / age)))
    except OverflowError:  # what lies behind is nothing beside it, or both are beyond all numbers
        exponent = shape * math.log((age + ahead) / scale)
        return math.inf if exponent > _LARGEST else math.exp(exponent)

"""What inputs may hold: anything that is not of the right kind counts as unknown."""

from __future__ import annotations

import math
import sys
from typing import Any, List, NamedTuple, Optional, Union

from ..plain_values import Absent, plain, show

Taken = Union[bool, float, List[Optional[bool]], None]


class Rule(NamedTuple):
    """What an input is."""

    type: str  # ``bool``, ``float``, ``int`` or ``bool[]``
    low: float = 0.0  # least number that is believed
    high: float = math.inf  # largest number
    slack: float = 0.0  # how far outside a number may be and is taken as the limit
    length: int = 0  # of a list

    def divided(self, num: int, den: int) -> Rule:
        """Return the rule of a number that is given in another unit."""
        high = self.high if self.high == FINITE else self.high * den / num
        return self._replace(low=self.low * den / num, high=high, slack=self.slack * den / num)


FINITE = sys.float_info.max


def take(rule: Rule, raw: object) -> tuple[Taken, str]:
    """Return the value, None when it is not known, and what is wrong with it (empty: nothing).

    Never raises. None and NaN mean unknown and are not wrong.
    """
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
    items = [plain(one) for one in raw]
    if not items:
        return None, ""
    if len(items) != rule.length:
        return None, f"{rule.length} statuses are expected, not {len(items)}"
    return [item if isinstance(item, bool) else None for item in items], ""


def _wrong(expected: str, raw: object) -> str:
    return f"{expected} is expected, not {show(raw)}"

"""Three-valued numbers and truth values for hand-written code around events.

Generated code does not compute with them: they are used at the interface only. In SESAME D7.2's
sample an UNKNOWN comparison counts as true; here it is no Python condition at all.

The classes are copied into generated modules unchanged (``inspect.getsource``).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any


class BoolVal:
    """TRUE, FALSE or UNKNOWN; immutable. ``&``, ``|``, ``^``, ``~`` are Kleene's strong logic."""

    __slots__ = ("_truth",)

    def __init__(self, value: bool | None = None) -> None:
        truth = 1 if value is None else 2 if value else 0
        object.__setattr__(self, "_truth", truth)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError("a BoolVal cannot be changed")

    @classmethod
    def of(cls, truth: int) -> BoolVal:
        """Return the value of 0 (FALSE), 1 (UNKNOWN) or 2 (TRUE)."""
        return cls(None if truth == 1 else truth == 2)

    @classmethod
    def true(cls) -> BoolVal:
        """Return TRUE."""
        return cls(True)

    @classmethod
    def false(cls) -> BoolVal:
        """Return FALSE."""
        return cls(False)

    @classmethod
    def unknown(cls) -> BoolVal:
        """Return UNKNOWN."""
        return cls()

    @property
    def truth(self) -> int:
        """0 (FALSE), 1 (UNKNOWN) or 2 (TRUE)."""
        truth: int = object.__getattribute__(self, "_truth")
        return truth

    @property
    def known(self) -> bool:
        """Whether it is TRUE or FALSE."""
        return self.truth != 1

    @property
    def value(self) -> bool:
        """The Python bool; raises ValueError when UNKNOWN."""
        if not self.known:
            raise ValueError("the value is UNKNOWN")
        return self.truth == 2

    def is_true(self) -> bool:
        """Return whether it is TRUE: the question to ask for evidence."""
        return self.truth == 2

    def is_false(self) -> bool:
        """Return whether it is FALSE: the question to ask for the absence of a hazard."""
        return self.truth == 0

    def __bool__(self) -> bool:
        raise TypeError("a three-valued result is no condition: ask is_true() or is_false()")

    def __and__(self, other: BoolVal) -> BoolVal:
        return BoolVal.of(min(self.truth, other.truth))

    def __or__(self, other: BoolVal) -> BoolVal:
        return BoolVal.of(max(self.truth, other.truth))

    def __xor__(self, other: BoolVal) -> BoolVal:
        known = self.known and other.known
        return BoolVal(self.truth != other.truth) if known else BoolVal()

    def __invert__(self) -> BoolVal:
        return BoolVal.of(2 - self.truth)

    def implies(self, other: BoolVal) -> BoolVal:
        """Return NOT self OR other."""
        return ~self | other

    def equals(self, other: BoolVal) -> BoolVal:
        """Return whether both are the same, UNKNOWN when one is not known."""
        return ~(self ^ other)

    def __repr__(self) -> str:
        return f"BoolVal.{('false', 'unknown', 'true')[self.truth]}()"


class NumVal:
    """A finite number or UNKNOWN; immutable. What cannot be computed is UNKNOWN.

    Args:
        value: the number; None and NaN are UNKNOWN, and so is an infinite one.
        unknown: True for UNKNOWN, as in SESAME D7.2's ``NumVal(0, True)``.
    """

    __slots__ = ("_number",)

    def __init__(self, value: float | None = None, unknown: bool = False) -> None:
        try:
            number = math.nan if value is None or unknown else float(value)
        except OverflowError:  # a whole number beyond any double
            number = math.nan
        object.__setattr__(self, "_number", number if math.isfinite(number) else math.nan)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError("a NumVal cannot be changed")

    @classmethod
    def unknown(cls) -> NumVal:
        """Return UNKNOWN."""
        return cls()

    @property
    def number(self) -> float:
        """The number, NaN when UNKNOWN."""
        number: float = object.__getattribute__(self, "_number")
        return number

    @property
    def known(self) -> bool:
        """Whether it is a number."""
        return not math.isnan(self.number)

    @property
    def value(self) -> float:
        """The number; raises ValueError when UNKNOWN."""
        if not self.known:
            raise ValueError("the value is UNKNOWN")
        return self.number

    def __bool__(self) -> bool:
        raise TypeError("a three-valued result is no condition: compare it and ask is_true()")

    def __add__(self, other: Any) -> NumVal:
        return self._combined(other, lambda a, b: a + b)

    def __sub__(self, other: Any) -> NumVal:
        return self._combined(other, lambda a, b: a - b)

    def __mul__(self, other: Any) -> NumVal:
        return self._combined(other, lambda a, b: a * b)

    def __truediv__(self, other: Any) -> NumVal:
        return self._combined(other, lambda a, b: a / b if b else math.nan)

    def __radd__(self, other: Any) -> NumVal:
        return NumVal(other) + self

    def __rsub__(self, other: Any) -> NumVal:
        return NumVal(other) - self

    def __rmul__(self, other: Any) -> NumVal:
        return NumVal(other) * self

    def __rtruediv__(self, other: Any) -> NumVal:
        return NumVal(other) / self

    def __neg__(self) -> NumVal:
        return NumVal(-self.number)

    def __abs__(self) -> NumVal:
        return NumVal(abs(self.number))

    def __lt__(self, other: Any) -> BoolVal:
        return self._compared(other, lambda a, b: a < b)

    def __le__(self, other: Any) -> BoolVal:
        return self._compared(other, lambda a, b: a <= b)

    def __gt__(self, other: Any) -> BoolVal:
        return self._compared(other, lambda a, b: a > b)

    def __ge__(self, other: Any) -> BoolVal:
        return self._compared(other, lambda a, b: a >= b)

    def equals(self, other: Any) -> BoolVal:
        """Return whether both are the same number, UNKNOWN when one is not known."""
        return self._compared(other, lambda a, b: a == b)

    def _combined(self, other: Any, how: Callable[[float, float], float]) -> NumVal:
        right = other if isinstance(other, NumVal) else NumVal(other)
        return NumVal(how(self.number, right.number))

    def _compared(self, other: Any, how: Callable[[float, float], bool]) -> BoolVal:
        right = other if isinstance(other, NumVal) else NumVal(other)
        known = self.known and right.known
        return BoolVal(how(self.number, right.number)) if known else BoolVal()

    def __repr__(self) -> str:
        return f"NumVal({self.number!r})" if self.known else "NumVal.unknown()"

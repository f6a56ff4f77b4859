"""From the value of an input to the state of a node: declared bins and maps.

A reader never raises for a value of any type; what it cannot use leaves the node unobserved.
"""

from __future__ import annotations

import math
import sys
from bisect import bisect_left, bisect_right
from typing import Any, Callable, NamedTuple, Optional, Sequence, Tuple

from ..inputs import InputSpec
from ..plain_values import plain, show
from .evidence import Reading

ABSENT = -1
_LARGEST = sys.float_info.max


class Declaration(NamedTuple):
    """How the values of an input become states of a node.

    Attributes:
        missing: number that represents "not observed": the number of states.
        edges: of the bins, ascending, in the unit after scale and offset; None: a map.
        order: state of each bin, from low to high.
        closed_right: an edge belongs to the bin below it.
        scaled: ``scale`` and ``offset`` are to be applied.
        scale: factor of the raw value.
        offset: is added then.
        limits: closed interval of usable raw values.
        clamp: values outside are taken as the nearest limit, otherwise they are unobserved.
        allow_inf: infinite values fall into the outermost bin.
        hysteresis: how far beyond the near edge of the previous bin a value keeps it.
        policy: when there is no value: ``unobserved``, ``prior``, ``default`` or ``hold``;
            ``prior`` is ``unobserved`` by name: thresholds may rest on it.
        special: pairs of a value and a state: sentinels and the map; the types must agree, too.
    """

    missing: int
    edges: Optional[Tuple[float, ...]] = None
    order: Tuple[int, ...] = ()
    closed_right: bool = True
    scaled: bool = False
    scale: float = 1.0
    offset: float = 0.0
    limits: Tuple[float, float] = (-math.inf, math.inf)
    clamp: bool = False
    allow_inf: bool = False
    hysteresis: float = 0.0
    policy: str = "unobserved"
    special: Tuple[Tuple[object, int], ...] = ()


class Discretiser:
    """A declared discretisation that remembers nothing from one step to the next.

    The order of evaluation: missing or NaN, special values, infinite, range, scale and offset,
    bins.

    Args:
        declaration: what is declared.
        spec: the input: its default and its largest age.

    Attributes:
        read: value, time in nanoseconds -> state; the number of states for "not observed". It may
            raise for a hostile value.
        timed: it needs the time.
        doubtful: it may leave several states possible.
        prior_accepted: while the input is unknown, the prior of the node is accepted in its place.
        possible: states in which the node may be, if there are several, in spite of the one that
            was returned last.
    """

    timed = False
    doubtful = False
    possible: Sequence[int] = ()

    def __init__(self, declaration: Declaration, spec: InputSpec) -> None:
        self._declared = one = declaration
        self._edges, self._order = one.edges or (), one.order
        self._special = {(type(value), value): state for value, state in one.special}
        self._search = bisect_left if one.closed_right else bisect_right
        self.prior_accepted = one.policy == "prior"
        self._default = one.missing
        if one.policy == "default":
            state, number = self._judged(spec.default)
            if number is not None:
                state = one.order[self._search(self._edges, number)]
            self._default = one.missing if state == ABSENT else state
        self.read = self._quick()

    def absent(self, now: float) -> int:
        """Return the state when there is no value."""
        return self._default

    def known(self, raw: object, reading: Reading) -> Tuple[bool, str]:
        """Return whether a value by itself is an observation of the node.

        And the key by which it counted as what was read of it, empty for none.
        """
        one, (state, number) = self._declared, self._judged(raw)
        if number is None:
            known = state not in (ABSENT, one.missing)
            speaks = one.policy == "prior" or (state == ABSENT and reading != one.missing)
            return known, "" if known or not speaks else f"missing: {one.policy}"
        value: Any = plain(raw)
        if value in (math.inf, -math.inf):
            return True, "allow_inf: true"
        return True, "" if one.limits[0] <= value <= one.limits[1] else "out_of_range: clamp"

    def fault(self, raw: object) -> Optional[str]:
        """Return what is wrong with a value; None for a usable or a missing one."""
        value = plain(raw)
        if raw is None or (isinstance(value, float) and math.isnan(value)):
            return None
        if self.known(raw, 0)[0] or (type(value), value) in self._special:
            return None
        if self._declared.edges is None:
            return f"no state is declared for {show(raw)}"
        if type(value) in (float, int):
            return f"the value {show(raw)} is not finite or outside the range"
        return f"expected a number, got {show(raw)}"

    def reset(self) -> None:
        """Forget former values."""

    def _judged(self, raw: object) -> Tuple[int, Optional[float]]:
        """Return (state, None), or a number that falls into the bins; remembers nothing."""
        value = raw if type(raw) is float else plain(raw)
        if self._special:
            state = self._special.get((type(value), value))
            if state is not None:
                return state, None
        one = self._declared
        if one.edges is None or not (type(value) is float or type(value) is int):
            return ABSENT, None
        number = float(value)
        if number != number:  # noqa: PLR0124 - the test for NaN
            return ABSENT, None
        low, high = one.limits
        if not -math.inf < number < math.inf:
            if not one.allow_inf:
                return one.missing, None
        elif not low <= number <= high:
            if not one.clamp:
                return one.missing, None
            number = min(max(number, low), high)
        return ABSENT, number * one.scale + one.offset if one.scaled else number

    def _quick(self) -> Callable[[object, float], int]:
        """Return the short way for usual values; others take the long one."""
        one, judged, default = self._declared, self._judged, self._default
        search, edges, order = self._search, self._edges, self._order
        scale, offset = one.scale, one.offset

        def slow(raw: object, _: float) -> int:
            state, number = judged(raw)
            if number is not None:
                return order[search(edges, number)]
            return default if state == ABSENT else state

        if one.edges is None or any(type(value) is float for value, _ in one.special):
            return slow
        low, high = max(one.limits[0], -_LARGEST), min(one.limits[1], _LARGEST)

        def scaled(raw: object, now: float) -> int:
            if type(raw) is float and low <= raw <= high:
                return order[search(edges, raw * scale + offset)]
            return slow(raw, now)

        def unscaled(raw: object, now: float) -> int:
            if type(raw) is float and low <= raw <= high:
                return order[search(edges, raw)]
            return slow(raw, now)

        return scaled if one.scaled else unscaled

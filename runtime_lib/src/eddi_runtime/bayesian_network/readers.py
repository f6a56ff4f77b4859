"""From the value of an input to the state of a node: declared bins and maps.

A reader never raises; what it cannot use leaves the node unobserved.
"""

from __future__ import annotations

import math
import sys
from bisect import bisect_left, bisect_right
from typing import Any, Callable, NamedTuple, Sequence

from ..inputs import InputSpec
from ..plain_values import plain, show
from .outputs import Reading

ABSENT = -1
_LARGEST = sys.float_info.max


class Declaration(NamedTuple):
    """How the values of an input become states of a node."""

    missing: int  # number that represents "not observed": the number of states
    # of the bins, ascending, in the unit after scale and offset; None: a map
    edges: tuple[float, ...] | None = None
    order: tuple[int, ...] = ()  # state of each bin, from low to high
    closed_right: bool = True  # an edge belongs to the bin below it
    scaled: bool = False  # ``scale`` and ``offset`` are to be applied
    scale: float = 1.0  # factor of the raw value
    offset: float = 0.0  # is added then
    limits: tuple[float, float] = (-math.inf, math.inf)  # closed interval of usable raw values
    # values outside are taken as the nearest limit, otherwise they are unobserved
    clamp: bool = False
    allow_inf: bool = False  # infinite values fall into the outermost bin
    hysteresis: float = 0.0  # how far beyond the near edge of the previous bin a value keeps it
    # without a value: ``unobserved``, ``prior`` (thresholds rest on it), ``default``, ``hold``
    policy: str = "unobserved"
    # pairs of a value and a state: sentinels and the map; the types must agree, too
    special: tuple[tuple[object, int], ...] = ()


class Discretiser:
    """A declared discretisation that remembers nothing from one step to the next.

    In this order: missing or NaN, special values, infinite, range, scale and offset, bins.
    """

    timed = False  # it needs the time
    doubtful = False  # it may leave several states possible
    # states in which the node may be, if there are several
    possible: Sequence[int] = ()

    def __init__(self, declaration: Declaration, spec: InputSpec) -> None:
        self._declared = node = declaration
        self._edges, self._order = node.edges or (), node.order
        self._special = {(type(value), value): state for value, state in node.special}
        self._search = bisect_left if node.closed_right else bisect_right
        # while the input is unknown, the prior of the node is accepted in its place
        self.prior_accepted = node.policy == "prior"
        self._default = node.missing
        if node.policy == "default":
            state, number = self._judged(spec.default)
            if number is not None:
                state = node.order[self._search(self._edges, number)]
            self._default = node.missing if state == ABSENT else state
        # value, nanoseconds -> state (their number: not observed); a hostile value may raise
        self.read = self._quick()

    def absent(self, now: float) -> int:
        return self._default

    def known(self, raw: object, reading: Reading) -> tuple[bool, str]:
        """Return whether a value by itself is an observation, and by which key it counted."""
        node, (state, number) = self._declared, self._judged(raw)
        if number is None:
            known = state not in (ABSENT, node.missing)
            speaks = node.policy == "prior" or (state == ABSENT and reading != node.missing)
            return known, "" if known or not speaks else f"missing: {node.policy}"
        value: Any = plain(raw)
        if value in (math.inf, -math.inf):
            return True, "allow_inf: true"
        return True, "" if node.limits[0] <= value <= node.limits[1] else "out_of_range: clamp"

    def fault(self, raw: object) -> str | None:
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

    def _judged(self, raw: object) -> tuple[int, float | None]:
        """Return (state, None), or a number that falls into the bins."""
        value = raw if type(raw) is float else plain(raw)
        if self._special:
            state = self._special.get((type(value), value))
            if state is not None:
                return state, None
        node = self._declared
        if node.edges is None or not (type(value) is float or type(value) is int):
            return ABSENT, None
        number = float(value)
        if number != number:  # noqa: PLR0124 - the test for NaN
            return ABSENT, None
        low, high = node.limits
        if not -math.inf < number < math.inf:
            if not node.allow_inf:
                return node.missing, None
        elif not low <= number <= high:
            if not node.clamp:
                return node.missing, None
            number = min(max(number, low), high)
        return ABSENT, number * node.scale + node.offset if node.scaled else number

    def _quick(self) -> Callable[[object, float], int]:
        """Return the short way for usual values; others take the long one."""
        node, judged, default = self._declared, self._judged, self._default
        search, edges, order = self._search, self._edges, self._order
        scale, offset = node.scale, node.offset

        def slow(raw: object, _: float) -> int:
            state, number = judged(raw)
            if number is not None:
                return order[search(edges, number)]
            return default if state == ABSENT else state

        if node.edges is None or any(type(value) is float for value, _ in node.special):
            return slow
        low, high = max(node.limits[0], -_LARGEST), min(node.limits[1], _LARGEST)

        def scaled(raw: object, now: float) -> int:
            if type(raw) is float and low <= raw <= high:
                return order[search(edges, raw * scale + offset)]
            return slow(raw, now)

        def unscaled(raw: object, now: float) -> int:
            if type(raw) is float and low <= raw <= high:
                return order[search(edges, raw)]
            return slow(raw, now)

        return scaled if node.scaled else unscaled

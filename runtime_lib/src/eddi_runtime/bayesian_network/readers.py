"""From the value of an input to the state of a node: declared bins and maps.

A reader never raises for a value of any type; what it cannot use leaves the node unobserved.
"""

from __future__ import annotations

import math
import sys
from bisect import bisect_left, bisect_right
from typing import Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple, Union

from ..inputs import InputSpec
from ..plain_values import plain, show
from .hysteresis import Hysteresis

Reading = Union[int, List[float]]
"""A state, the number of states for "not observed", or likelihoods."""

_ABSENT = -1
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


class _Remembering:
    """What is done when there is no value: nothing, the default, or the last state for a while."""

    def __init__(self, missing: int, policy: str, default: int, hold_ns: int) -> None:
        self._missing = missing
        self._default = default if policy == "default" else missing
        self._hold_ns = hold_ns if policy == "hold" else -1
        self._last: Tuple[int, float, Sequence[int]] = (missing, 0, ())

    def seen(self, state: int, now: float, possible: Sequence[int] = ()) -> int:
        if self._hold_ns >= 0:
            self._last = state, now, possible
        return state

    def absent(self, now: float) -> Tuple[int, Sequence[int]]:
        """Return the state, and all that it may be if there are several."""
        if self._hold_ns < 0:
            return self._default, ()
        state, then, possible = self._last
        return (state, possible) if 0 <= now - then <= self._hold_ns else (self._missing, ())

    def reset(self) -> None:
        self._last = self._missing, 0, ()


class Discretiser:
    """A declared discretisation.

    The order of evaluation: missing or NaN, special values, infinite, range, scale and offset,
    bins, hysteresis.

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

    def __init__(self, declaration: Declaration, spec: InputSpec) -> None:
        self._declared = one = declaration
        self._missing = one.missing
        self._special: Dict[type, Dict[object, int]] = {}
        for known, state in one.special:
            self._special.setdefault(type(known), {})[known] = state
        self._edges, self._order = one.edges or (), one.order
        self._binning = one.edges is not None
        self._search = bisect_left if one.closed_right else bisect_right
        self._low, self._high = one.limits
        self._bands: Optional[Hysteresis] = None
        if one.edges is not None and one.hysteresis > 0.0:
            self._bands = Hysteresis(one.edges, one.hysteresis)
        default, value = self._judged(spec.default)
        if value is not None:
            default = one.order[self._search(self._edges, value)]
        limit = spec.max_age if isinstance(spec.max_age, float) else 0.0
        self._memory = _Remembering(
            self._missing,
            one.policy,
            self._missing if default == _ABSENT else default,
            int(min(limit, 1e9) * 1e9),
        )
        self.timed = one.policy == "hold"
        self.doubtful = self._bands is not None
        self.prior_accepted = one.policy == "prior"
        self.possible: Sequence[int] = ()
        self.read = self._quick()

    def _read(self, raw: object, now: float) -> int:
        state, value = self._judged(raw)
        if value is not None:
            return self._memory.seen(self._binned(value), now, self.possible)
        if state in (_ABSENT, self._missing):
            self._lose()
        elif self._bands is not None:
            self._bands.leave()
            self.possible = ()
        return self._memory.seen(state, now) if state != _ABSENT else self._without(now)

    def absent(self, now: float) -> int:
        """Return the state when there is no value."""
        self._lose()
        return self._without(now)

    def knows(self, raw: object) -> bool:
        """Return whether a value by itself is an observation of the node."""
        state, value = self._judged(raw)
        return value is not None or state not in (_ABSENT, self._missing)

    def accepted(self, raw: object, reading: Reading) -> str:
        """Return the key by which a value counted as what was read of it; empty for none."""
        state, value = self._judged(raw)
        number = plain(raw)
        if value is None or not isinstance(number, (float, int)):
            policy = self._declared.policy
            speaks = policy == "prior" or (state == _ABSENT and reading != self._missing)
            unknown = state in (_ABSENT, self._missing)
            return f"missing: {policy}" if unknown and speaks else ""
        if number in (math.inf, -math.inf):
            return "allow_inf: true"
        return "" if self._low <= number <= self._high else "out_of_range: clamp"

    def fault(self, raw: object) -> Optional[str]:
        """Return what is wrong with a value; None for a usable or a missing one."""
        value = plain(raw)
        if raw is None or (isinstance(value, float) and math.isnan(value)):
            return None
        state, number = self._judged(raw)
        if number is not None or 0 <= state < self._missing or self._is_special(value):
            return None
        if not self._binning:
            return f"no state is declared for {show(raw)}"
        if state == _ABSENT:
            return f"expected a number, got {show(raw)}"
        return f"the value {show(raw)} is not finite or outside the range"

    def reset(self) -> None:
        """Forget former values."""
        self._lose()
        self._memory.reset()

    def _without(self, now: float) -> int:
        state, self.possible = self._memory.absent(now)
        return state

    def _lose(self) -> None:
        if self._bands is not None:
            self._bands.lose()
            self.possible = ()

    def _judged(self, raw: object) -> Tuple[int, Optional[float]]:
        """Return (state, None), or a number that falls into the bins; remembers nothing."""
        value = raw if type(raw) is float else plain(raw)
        special = self._special.get(type(value))
        if special:
            state = special.get(value)
            if state is not None:
                return state, None
        if self._binning and (type(value) is float or type(value) is int):
            return self._number(float(value))
        return _ABSENT, None

    def _number(self, value: float) -> Tuple[int, Optional[float]]:
        if value != value:  # noqa: PLR0124 - the test for NaN
            return _ABSENT, None
        if not -math.inf < value < math.inf:
            if not self._declared.allow_inf:
                return self._missing, None
        elif not self._low <= value <= self._high:
            if not self._declared.clamp:
                return self._missing, None
            value = min(max(value, self._low), self._high)
        if self._declared.scaled:
            value = value * self._declared.scale + self._declared.offset
        return _ABSENT, value

    def _binned(self, value: float) -> int:
        order, bands = self._order, self._bands
        place = self._search(self._edges, value)
        if bands is None:
            return order[place]
        place = bands.take(value, place)
        if bands.possible or self.possible:
            self.possible = [order[one] for one in bands.possible]
        return order[place]

    def _is_special(self, value: object) -> bool:
        return value in self._special.get(type(value), ())

    def _quick(self) -> Callable[[object, float], int]:
        """Return the short way for usual values of a declaration without memory and sentinels."""
        one, slow = self._declared, self._read
        edges, order, scale, offset = one.edges, one.order, one.scale, one.offset
        if edges is None or float in self._special or one.hysteresis or one.policy == "hold":
            return slow
        search = self._search
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

"""From the value of an input to the state of a node: declared bins, maps, and direct inputs.

A reader never raises for a value of any type; what it cannot use leaves the node unobserved.
"""

from __future__ import annotations

import math
import sys
from bisect import bisect_left, bisect_right
from typing import Any, Callable, List, Optional, Protocol, Sequence, Tuple, Union

from ..inputs import InputSpec
from ..plain_values import plain, show
from .declaration import Declaration
from .evidence import EvidenceError, finding

Reading = Union[int, List[float]]
"""A state, the number of states for "not observed", or likelihoods."""

_ABSENT = -1
_LARGEST = sys.float_info.max


class Reader(Protocol):
    """Turns one input into evidence on one node.

    Attributes:
        timed: it must be told the time.
    """

    timed: bool

    def read(self, raw: object, now: float) -> Reading:
        """Return the evidence in a value at a time in nanoseconds; may raise for hostile ones."""

    def absent(self, now: float) -> Reading:
        """Return the evidence when there is no value."""

    def fault(self, raw: object) -> Optional[str]:
        """Return what is wrong with a value; None for a good or a missing one."""

    def reset(self) -> None:
        """Forget former values."""


class _Remembering:
    """What is done when there is no value: nothing, the default, or the last state for a while."""

    def __init__(self, missing: int, policy: str, default: int, hold_ns: int) -> None:
        self._missing = missing
        self._default = default if policy == "default" else missing
        self._hold_ns = hold_ns if policy == "hold" else -1
        self._last: Tuple[int, float] = (missing, 0)

    def seen(self, state: int, now: float) -> int:
        if self._hold_ns >= 0:
            self._last = (state, now)
        return state

    def absent(self, now: float) -> int:
        if self._hold_ns < 0:
            return self._default
        state, then = self._last
        return state if 0 <= now - then <= self._hold_ns else self._missing

    def reset(self) -> None:
        self._last = (self._missing, 0)


class Discretiser:
    """A declared discretisation.

    The order of evaluation: missing or NaN, special values, infinite, range, scale and offset,
    bins, hysteresis.

    Args:
        declaration: what is declared.
        spec: the input: its default and its largest age.
    """

    def __init__(self, declaration: Declaration, spec: InputSpec) -> None:
        self._declared = one = declaration
        self._missing = one.missing
        self._special = one.special
        self._edges = one.edges
        self._search = bisect_left if one.closed_right else bisect_right
        self._low, self._high = one.limits
        self._previous = _ABSENT
        default = self._state_of(spec.default)
        self._previous = _ABSENT
        limit = spec.max_age if isinstance(spec.max_age, float) else 0.0
        self._memory = _Remembering(
            self._missing,
            one.policy,
            self._missing if default == _ABSENT else default,
            int(min(limit, 1e9) * 1e9),
        )
        self.timed = one.policy == "hold"
        self._plain = _plain_bins(one)

    def read(self, raw: object, now: float) -> int:
        """Return the state of a value; see ``Reader``."""
        if type(raw) is float and self._plain is not None:
            state = self._plain(raw)
            if state != _ABSENT:
                return state
        state = self._state_of(raw)
        if state == _ABSENT:
            return self._memory.absent(now)
        return self._memory.seen(state, now)

    def absent(self, now: float) -> int:
        """Return the state when there is no value; see ``Reader``."""
        self._previous = _ABSENT
        return self._memory.absent(now)

    def fault(self, raw: object) -> Optional[str]:
        """Return what is wrong with a value; see ``Reader``."""
        value = plain(raw)
        if raw is None or (isinstance(value, float) and math.isnan(value)):
            return None
        previous, state = self._previous, self._state_of(raw)
        self._previous = previous
        if 0 <= state < self._missing or self._is_special(value):
            return None
        if self._edges is None:
            return f"no state is declared for {show(raw)}"
        if state == _ABSENT:
            return f"expected a number, got {show(raw)}"
        return f"the value {show(raw)} is not finite or outside the range"

    def reset(self) -> None:
        """Forget former values."""
        self._previous = _ABSENT
        self._memory.reset()

    def _state_of(self, raw: object) -> int:
        value = raw if type(raw) is float else plain(raw)
        special = self._special.get(type(value))
        if special:
            state = special.get(value)
            if state is not None:
                self._previous = _ABSENT
                return state
        if self._edges is None or type(value) not in (float, int):
            self._previous = _ABSENT
            return _ABSENT
        return self._bin(float(value), self._edges)  # type: ignore[arg-type]  # a number

    def _bin(self, value: float, edges: Sequence[float]) -> int:
        if value != value:  # noqa: PLR0124 - the test for NaN
            self._previous = _ABSENT
            return _ABSENT
        if not -math.inf < value < math.inf:
            if not self._declared.allow_inf:
                self._previous = _ABSENT
                return self._missing
        elif not self._low <= value <= self._high:
            if not self._declared.clamp:
                self._previous = _ABSENT
                return self._missing
            value = min(max(value, self._low), self._high)
        if self._declared.scaled:
            value = value * self._declared.scale + self._declared.offset
        place = self._search(edges, value)
        previous = self._previous
        moved = previous not in (_ABSENT, place) and self._declared.hysteresis > 0.0
        if moved and self._near(value, previous, place, edges):
            place = previous
        self._previous = place
        return self._declared.order[place]

    def _near(self, value: float, previous: int, place: int, edges: Sequence[float]) -> bool:
        beyond = value - edges[previous] if place > previous else edges[previous - 1] - value
        return beyond <= self._declared.hysteresis

    def _is_special(self, value: object) -> bool:
        return value in self._special.get(type(value), ())


def _plain_bins(one: Declaration) -> Optional[Callable[[float], int]]:
    """Return the short way for good values of a declaration without memory and sentinels."""
    edges, order, scale, offset = one.edges, one.order, one.scale, one.offset
    if edges is None or one.special[float] or one.hysteresis or one.policy == "hold":
        return None
    search = bisect_left if one.closed_right else bisect_right
    low, high = max(one.limits[0], -_LARGEST), min(one.limits[1], _LARGEST)

    def scaled(value: float) -> int:
        return order[search(edges, value * scale + offset)] if low <= value <= high else _ABSENT

    def unscaled(value: float) -> int:
        return order[search(edges, value)] if low <= value <= high else _ABSENT

    return scaled if one.scaled else unscaled


class DirectReader:
    """An input that holds the name of a state, or one likelihood per state.

    Args:
        states: names of the states.
        virtual: see ``finding``.
    """

    timed = False

    def __init__(self, states: Sequence[str], *, virtual: bool) -> None:
        self._states = tuple(states)
        self._number = {state: k for k, state in enumerate(states)}
        self._virtual = virtual

    def read(self, raw: object, now: float) -> Reading:
        """Return the state or likelihoods of a value; see ``Reader``."""
        state = self._number.get(raw) if type(raw) is str else None
        if state is not None:
            return state
        try:
            found = self._judged(raw)
        except EvidenceError:
            found = None
        return len(self._states) if found is None else found

    def absent(self, now: float) -> Reading:
        """Return "not observed"; see ``Reader``."""
        return len(self._states)

    def fault(self, raw: object) -> Optional[str]:
        """Return what is wrong with a value; see ``Reader``."""
        try:
            self._judged(raw)
        except EvidenceError as problem:
            return str(problem)
        return None

    def reset(self) -> None:
        """Forget nothing: nothing is remembered."""

    def _judged(self, raw: object) -> Union[int, List[float], None]:
        value = plain(raw)
        if isinstance(value, str):
            if value not in self._number:
                raise EvidenceError(f"there is no state {show(raw)}")
            return self._number[value]
        if raw is None or (isinstance(value, float) and math.isnan(value)):
            return None
        if value is not None:
            raise EvidenceError(f"expected a state or one number per state, got {show(raw)}")
        if not issubclass(type(raw), (list, tuple)):
            raw = _list_of_array(raw)
        if not raw:
            return None
        return finding(raw, self._states, virtual=self._virtual)  # type: ignore[arg-type]  # a list


def _list_of_array(raw: Any) -> List[object]:
    if type(raw).__name__ in ("ndarray", "array"):
        values = raw.tolist()
        if isinstance(values, list):
            return values
    raise EvidenceError(f"expected a state or one number per state, got {show(raw)}")

"""Inputs that are computed by an expression over messages (``expression:`` in eddi_config.yml)."""

from __future__ import annotations

import math
from contextlib import suppress
from typing import Any, Callable, Mapping, Sequence

from ..plain_values import UNTOLD, NotGivenError, Step, follow, given, one_line
from . import Conditions, Value, reduced

Path = Sequence[Step]
Check = Sequence[Any]
"""``within`` with the paths of two limits, or ``unless`` with a path and the value that marks that
a value is no measurement, or ``given`` with what shows that a monitor knows it: see there."""


class Expression(Conditions):
    """Represents one input's expression; compiled classes inherit it. Not thread-safe."""

    type: str  # ``bool``, ``float``, ``int`` or ``state``
    hazard = False  # a ``bool`` that is UNKNOWN is True
    states: tuple[str, ...] = ()  # of a ``state``, each with a condition of its own
    # first word of a variable -> ``message`` or ``input``, and its id
    names: Mapping[str, tuple[str, str]]
    reason: str  # why a value could not be read in the last step, empty when all could be
    # evaluates once and returns the value of each condition; compiled classes have it
    step: Callable[[int, Mapping[str, object], Mapping[str, float]], tuple[Value, ...]]

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        self.reason = ""
        self.forget_messages()
        self.restart()

    def forget_messages(self) -> None:
        """Read the messages of the next step anew, those of before as well."""
        self._reduced: dict[int, tuple[Any, Any]] = {}

    def value(
        self, t: int, messages: Mapping[str, object], ages: Mapping[str, float] | None = None
    ) -> bool | float | int | str | None:
        """Evaluate once and return the input's value, None for UNKNOWN; never raises.

        A HAZARD is True when UNKNOWN; a state is the one that is TRUE while all others are FALSE.
        """
        self.reason = ""
        truths = self.step(t, messages, {} if ages is None else ages)
        if self.type == "state":
            single = truths.count(2) == 1 and truths.count(0) == len(truths) - 1
            return self.states[truths.index(2)] if single else None
        if self.type == "bool":
            unknown = True if self.hazard else None
            return unknown if truths[0] == 1 else truths[0] == 2
        if math.isnan(truths[0]):
            return None
        if self.type == "float":
            return float(truths[0])
        return round(truths[0]) if math.isfinite(truths[0]) else None

    def field(
        self, messages: Mapping[str, object], word: str, path: Path, *checks: Check
    ) -> object:
        """Return a value of a message, None when it cannot be read; the first reason is kept."""
        message = messages.get(word)
        if message is None:
            return None
        try:
            value: Any = read_path(message, path)
            for check in checks:
                if check[0] != "given":
                    if check[0] == "unless":
                        measured = follow(message, check[1]) != check[2]
                    else:
                        low, high = (follow(message, key) for key in check[1:])
                        measured = math.isinf(value) or low <= value <= high
                    if not measured:
                        field = ".".join(str(step) for step in check[1])
                        raise LookupError(f"no measurement, by {field} of {word}")  # noqa: TRY301
                elif isinstance(value, list):  # of a list each that the monitor knows
                    value = [key if key in check[1:] else None for key in value]
                else:
                    pairs = [(key, isinstance(key, tuple)) for key in check[1:]]
                    known = [(follow(message, k[0]), *k[1:]) if path else k for k, path in pairs]
                    value = given(value, *known)
        except NotGivenError:
            self.reason = self.reason or UNTOLD
            return None
        except Exception as problem:  # noqa: BLE001 - messages are what the robot sends
            self.reason = self.reason or one_line(problem)
            return None
        return value

    def reduce(
        self,
        number: int,
        function: Callable[..., float | bool],
        messages: Mapping[str, object],
        word: str,
        *fields: Sequence[object],
    ) -> object:
        """Return a reduction of a message; that of the same message as before is not done anew."""
        message = messages.get(word)
        before, value = self._reduced.get(number, (None, None))
        if message is None or message is not before:
            asked: Sequence[Sequence[Any]] = fields
            raws = [self.field(messages, word, *row) for row in asked]
            value, reason = reduced(function, raws)
            if message is not None:
                self.reason = self.reason or reason
            self._reduced[number] = (message, value)
        return value


def read_path(message: object, path: Path) -> object:
    """Return a field of a message; a time or duration of ROS is its seconds."""
    if any(isinstance(step, (list, tuple)) and step[0] == "*" for step in path):
        return gather(message, path)
    value = follow(message, path)
    to_sec = getattr(value, "to_sec", None)
    return value if to_sec is None else to_sec()


def gather(message: object, path: Sequence[Step]) -> list[object]:
    """Return all values at the end of a path with ``["*"]``, every element of a list.

    ``["*", first, last]`` is a part, both ends included. An element that cannot be followed
    further is None; a list that is not there or shorter is a LookupError.
    """
    for k, step in enumerate(path):
        if isinstance(step, (list, tuple)) and step[0] == "*":
            items = _part(follow(message, path[:k]), step)
            rest = path[k + 1 :]
            if not rest:
                return items
            if any(isinstance(part, (list, tuple)) and part[0] == "*" for part in rest):
                return [value for item in items for value in gather(item, rest)]
            return [_followed(item, rest) for item in items]
    return [follow(message, path)]


def _part(items: Any, step: Sequence[str | int]) -> list[object]:
    there: list[object] = items.tolist() if hasattr(items, "tolist") else list(items)
    if len(step) == 1:
        return there
    first, last = int(step[1]), int(step[2])
    if last >= len(there):
        raise LookupError(f"[{first}..{last}] is beyond the {len(there)} elements")
    return there[first : last + 1]


def _followed(item: object, path: Sequence[Step]) -> object:
    with suppress(AttributeError, LookupError):
        return follow(item, path)
    return None

"""Inputs that are called as a node: the name of a state, or one likelihood for each state."""

from __future__ import annotations

import math
from typing import Any, Callable, Sequence

from ..plain_values import plain, show
from .outputs import EvidenceError, Finding, Reading, finding


class DirectReader:
    """An input that holds the name of a state, or one likelihood for each; see ``Discretiser``."""

    timed = doubtful = prior_accepted = False
    possible: Sequence[int] = ()

    def __init__(self, states: Sequence[str], *, virtual: bool) -> None:
        self._states, self._virtual = states, virtual
        self._number = {state: k for k, state in enumerate(states)}
        self.read = self._quick()

    def absent(self, now: float) -> Reading:
        return len(self._states)

    def known(self, raw: object, reading: Reading) -> tuple[bool, str]:
        return self.read(raw, 0) != len(self._states), ""

    def fault(self, raw: object) -> str | None:
        try:
            self._judged(raw)
        except EvidenceError as problem:
            return str(problem)
        return None

    def reset(self) -> None:
        """Nothing is remembered."""

    def _quick(self) -> Callable[[object, float], Reading]:
        number, missing, judged = self._number, len(self._states), self._judged

        def read(raw: object, _: float) -> Reading:
            if type(raw) is str and raw in number:
                return number[raw]
            try:
                state = judged(raw)
            except EvidenceError:
                return missing
            return missing if state is None else state

        return read

    def _judged(self, raw: object) -> Finding:
        values: Any = raw
        if type(raw) is not list:
            value = plain(raw)
            if isinstance(value, str):
                if value not in self._number:
                    raise EvidenceError(f"there is no state {show(raw)}")
                return self._number[value]
            if raw is None or (isinstance(value, float) and math.isnan(value)):
                return None
            if type(raw).__name__ in ("ndarray", "array"):
                values = values.tolist()
            # "isinstance" would believe what calls itself a list.
            if not issubclass(type(values), (list, tuple)):
                raise EvidenceError(f"expected a state or one number per state, got {show(raw)}")
        return finding(values, self._states, virtual=self._virtual) if values else None

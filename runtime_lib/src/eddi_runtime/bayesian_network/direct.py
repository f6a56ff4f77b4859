"""Inputs that are called as a node: the name of a state, or one likelihood for each state."""

from __future__ import annotations

import math
from typing import Any, Callable, List, Optional, Sequence, Union

from ..plain_values import plain, show
from .evidence import EvidenceError, finding
from .readers import Reading


class DirectReader:
    """An input that holds the name of a state, or one likelihood per state; see ``Discretiser``.

    Args:
        states: names of the states.
        virtual: see ``finding``.
    """

    timed = False
    doubtful = False
    prior_accepted = False
    possible: Sequence[int] = ()

    def __init__(self, states: Sequence[str], *, virtual: bool) -> None:
        self._states = tuple(states)
        self._number = {state: k for k, state in enumerate(states)}
        self._virtual = virtual
        self.read = self._quick()

    def absent(self, now: float) -> Reading:
        """Return "not observed"."""
        return len(self._states)

    def knows(self, raw: object) -> bool:
        """Return whether a value is an observation."""
        try:
            return self._judged(raw) is not None
        except EvidenceError:
            return False

    def accepted(self, raw: object, reading: Reading) -> str:
        """Return nothing: a direct input is taken as it is."""
        return ""

    def fault(self, raw: object) -> Optional[str]:
        """Return what is wrong with a value."""
        try:
            self._judged(raw)
        except EvidenceError as problem:
            return str(problem)
        return None

    def reset(self) -> None:
        """Forget nothing: nothing is remembered."""

    def _quick(self) -> Callable[[object, float], Reading]:
        number, missing, judged = self._number, len(self._states), self._judged

        def read(raw: object, _: float) -> Reading:
            if type(raw) is str and raw in number:
                return number[raw]
            try:
                found = judged(raw)
            except EvidenceError:
                return missing
            return missing if found is None else found

        return read

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
        values: Sequence[object]
        if issubclass(type(raw), (list, tuple)) and isinstance(raw, (list, tuple)):
            values = raw
        else:
            values = _list_of_array(raw)
        return finding(values, self._states, virtual=self._virtual) if values else None


def _list_of_array(raw: Any) -> List[object]:
    if type(raw).__name__ in ("ndarray", "array"):
        values = raw.tolist()
        if isinstance(values, list):
            return values
    raise EvidenceError(f"expected a state or one number per state, got {show(raw)}")

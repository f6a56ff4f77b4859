"""Rotors whose motors are known to work or not.

Sources: Aslansefat et al., "SafeDrones: Real-Time Reliability Evaluation of UAVs" and the paper of
2019 on multirotor reliability by the same group; motors are numbered as in the name, from 0.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, List, Optional, Sequence, Tuple, Union

from .component import AGAIN, Component, Estimate, Known, Moment, Values, reader

if TYPE_CHECKING:  # only where the mission's end is an input
    from .chain import Chain

Row = Tuple[float, float, float]
"""Of a state: failed within the horizon, alive all the time, mean life in hours."""


class Rows:
    """What lies ahead of each state, for a horizon that stays the same.

    Args:
        rows: one for each state.
    """

    def __init__(self, rows: Sequence[Row]) -> None:
        self._rows = rows

    def rows(self, at: int) -> Sequence[Row]:
        """Return what lies ahead of each state."""
        del at
        return self._rows


class Propulsion(Component):
    """The statuses leave one state, or several where one is not known, of which the worst counts.

    Args:
        chain: what lies ahead of sets of failed motors; the last state is the loss of the frame.
        sets: the failed motors in each of the other states, by their place in the configuration.
        inputs: for each place the input of its motor and, for a list, the position in it.
        repair: a failed motor may work again.
    """

    _last: Optional[Tuple[Any, ...]]
    """Statuses that ask for no further look."""

    def __init__(
        self,
        chain: Union[Rows, Chain],
        sets: Tuple[Tuple[int, ...], ...],
        inputs: Tuple[Tuple[str, Optional[int]], ...],
        *,
        repair: bool = False,
    ) -> None:
        self._rows = chain.rows
        self._sets, self._inputs, self._repair = list(map(frozenset, sets)), inputs, repair
        self._statuses = reader(tuple(dict.fromkeys(name for name, _ in inputs)))
        self.reset()

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        """Take the status of each motor."""
        del known
        statuses = self._statuses(values)
        if statuses != self._last:
            self._take(values, statuses)
        found = self._found.get(moment[4])
        if found is None:
            rows = self._rows(moment.at)
            failed, alive, lives = zip(*[rows[state] for state in self._states])
            bounds = min(failed), max(failed), min(alive), min(lives)
            found = self._found[moment.at] = Estimate(*bounds, self._unknown)
        return found

    def _take(self, values: Values, statuses: Tuple[Any, ...]) -> None:
        """Find the states that are possible."""
        latched = self.latched
        working: List[Optional[bool]] = []
        unknown: List[str] = []
        for motor, (name, position) in enumerate(self._inputs):
            value = values[name]
            if position is not None and value is not None:
                value = value[position] if len(value) == len(self._inputs) else None
            status = self._status(motor, value)
            if status is None:
                unknown.append(name)
            working.append(status)
        # a claim that something works again is counted each time
        self._last = statuses if latched == self.latched else None
        self._unknown = tuple(dict.fromkeys(unknown))
        self._states = self._consistent(working)
        self._found.clear()

    def _consistent(self, working: Sequence[Optional[bool]]) -> List[int]:
        """Return the states that these statuses allow (None: unknown)."""
        down = {i for i, works in enumerate(working) if works is False}
        maybe = down.union(i for i, works in enumerate(working) if works is None)
        found = [state for state, failed in enumerate(self._sets) if down <= failed <= maybe]
        if len(found) < 2 ** (len(maybe) - len(down)):  # some completion does not fly
            found.append(len(self._sets))
        return found

    def _status(self, motor: int, value: Optional[bool]) -> Optional[bool]:
        if self._failed[motor] and value is not False and not self._repair:
            if value is True:
                self.latched += 1
                self.report_fault(self._inputs[motor][0], AGAIN)
            return False
        self._failed[motor] = value is False
        return value

    def reset(self) -> None:
        """All motors work."""
        super().reset()
        self._failed = [False] * len(self._inputs)
        self._last = None
        self._found: Dict[int, Estimate] = {}  # of the last statuses: position of a horizon

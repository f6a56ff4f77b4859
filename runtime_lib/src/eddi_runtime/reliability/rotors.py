"""Rotors whose motors are known to work or not.

Sources: Aslansefat et al., "SafeDrones: Real-Time Reliability Evaluation of UAVs" and the paper of
2019 on multirotor reliability by the same group; motors are numbered as in the name, from 0.
"""

from __future__ import annotations

from typing import Any, Dict, List, Optional, Tuple

from .chain import Chain, Seen
from .component import AGAIN, Component, Estimate, Known, Moment, Values, reader, sure

Statuses = Tuple[Optional[bool], ...]
_KEPT = 64
"""How many different observations are kept."""


class Propulsion(Component):
    """While all statuses are known, the state is: what lies ahead of it was found in advance.

    Args:
        chain: over sets of failed motors; its last state is the loss of the frame.
        sets: the failed motors in each of the other states, by their place in the configuration.
        inputs: for each place the input of its motor and, for a list, the position in it.
        repair: a failed motor may work again.
    """

    def __init__(
        self,
        chain: Chain,
        sets: Tuple[Tuple[int, ...], ...],
        inputs: Tuple[Tuple[str, Optional[int]], ...],
        *,
        repair: bool = False,
    ) -> None:
        self.chain = chain
        self._sets, self._inputs, self._repair = list(map(frozenset, sets)), inputs, repair
        self._statuses = reader(tuple(dict.fromkeys(name for name, _ in inputs)))
        self._sure: Dict[int, List[Estimate]] = {}
        self._seen: Dict[Statuses, Seen] = {}
        self._forget()

    def _forget(self) -> None:
        self._failed = [False] * len(self._inputs)
        self._last: Optional[Tuple[Any, ...]] = None  # statuses that ask for no further look
        self._state: Optional[int] = None  # the one that is known, as long as it is
        self._vague = self.chain.everything

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        """Take the status of each motor."""
        del known
        statuses = self._statuses(values)
        if statuses != self._last:
            self._take(values, statuses)
        if self._state is None:
            vague = self.chain.step(moment, self._vague)
            if vague.reason and self.chain.states - 1 in self._vague.states:
                # a set of failures without weight is new: at the start nothing failed
                return vague._replace(reason="")
            return vague
        found = self._sure.get(moment.at)
        if found is None:
            found = self._sure[moment.at] = [sure(*row) for row in self.chain.rows(moment.at)]
        return found[self._state]

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
        if not unknown:
            self._state = self._consistent(tuple(working))[0]
            return
        if self._state is not None:
            self.chain.believe(self.chain.sure_of(self._state))
        self._state, self._vague = None, self._see(tuple(working), tuple(dict.fromkeys(unknown)))

    def _see(self, working: Statuses, unknown: Tuple[str, ...]) -> Seen:
        seen = self._seen.get(working)
        if seen is None:
            if len(self._seen) >= _KEPT:
                self._seen.clear()
            seen = self._seen[working] = Seen(self.chain, self._consistent(working))
            seen.unknown = unknown
        return seen

    def _consistent(self, working: Statuses) -> List[int]:
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
        self._forget()
        self.chain.reset()

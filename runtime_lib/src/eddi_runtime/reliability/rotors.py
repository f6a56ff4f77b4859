"""Rotors whose motors are known to work or not (SafeDrones, Aslansefat et al. 2019 and 2022)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Sequence

from .component import Component, Estimate, Known, Moment, Values, reader

if TYPE_CHECKING:  # only where the mission's end is an input
    from .chain import Chain, Row


class Rows:
    """What lies ahead of each state, for a horizon that stays the same."""

    def __init__(self, rows: Sequence[Row]) -> None:
        self._rows = rows

    def rows(self, at: int) -> Sequence[Row]:
        return self._rows


class Propulsion(Component):
    """The statuses leave one state, or several where one is not known: the worst counts."""

    _last: tuple[Any, ...] | None
    """Statuses that ask for no further look."""

    def __init__(
        self,
        chain: Rows | Chain,  # what lies ahead of each set, and last of the loss of the frame
        sets: tuple[tuple[int, ...], ...],  # of failed motors
        inputs: tuple[tuple[str, int | None], ...],  # of each motor, with its place in a list
        *,
        repair: bool = False,
    ) -> None:
        self._rows = chain.rows
        self._sets, self._inputs, self._repair = list(map(frozenset, sets)), inputs, repair
        self._statuses = reader(tuple(dict.fromkeys(name for name, _ in inputs)))
        self.reset()

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        statuses = self._statuses(values)
        if statuses != self._last:
            self._take(values, statuses)
        kept = self._found.get(moment[4])
        if kept is None:
            rows = self._rows(moment.at)
            failed, alive, lives = zip(*[rows[state] for state in self._states])
            bounds = min(failed), max(failed), min(alive), min(lives)
            kept = self._found[moment.at] = Estimate(*bounds, self._unknown)
        return kept

    def _take(self, values: Values, statuses: tuple[Any, ...]) -> None:
        failed: list[bool | None] = []
        unknown: list[str] = []
        for motor, (name, position) in enumerate(self._inputs):
            value = values[name]
            if position is not None and value is not None:
                value = value[position] if len(value) == len(self._inputs) else None
            now = None if value is None else not value
            now = self.has_failed(name, now, before=self._failed[motor], repair=self._repair)
            self._failed[motor] = now is True
            if now is None:
                unknown.append(name)
            failed.append(now)
        # a claim that something works again is reported each time
        self._last = None if self.said else statuses
        self._unknown = tuple(dict.fromkeys(unknown))
        down = {motor for motor, state in enumerate(failed) if state}
        maybe = {motor for motor, state in enumerate(failed) if state is not False}
        self._states = [k for k, those in enumerate(self._sets) if down <= those <= maybe]
        if len(self._states) < 2 ** (len(maybe) - len(down)):  # some completion does not fly
            self._states.append(len(self._sets))
        self._found.clear()

    def reset(self) -> None:
        super().reset()
        self._failed = [False] * len(self._inputs)
        self._last = None
        self._found: dict[int, Estimate] = {}  # of the last statuses: position of a horizon

"""The set of states in which a system may be, step by step: no input, no output, no clock.

Truth values are 0 FALSE < 1 UNKNOWN < 2 TRUE. Each UNKNOWN splits the system into one in which it
is so and one in which it is not; what holds in all of them is certain.
"""

from __future__ import annotations

import math
from typing import Iterable, List, Mapping, NamedTuple, Sequence, Tuple

from ..why import FALSE, TRUE, UNKNOWN
from .machine import RaisedAction, StateMachine, StateMachineOutput

Due = Tuple[RaisedAction, ...]
_EVER = -math.inf  # an earliest time of which nothing is known
_WITHHELD = frozenset({"clock", "inconsistent", "waiting"})  # then nothing is claimed


class Way(NamedTuple):
    """How a state was entered."""

    transition: int
    verdict: int  # of the transition: TRUE or UNKNOWN
    trigger: int  # which decided that; -1 for a timeout


class Occupied(NamedTuple):
    """A possible state."""

    earliest: float  # nanoseconds; it was entered between these two
    latest: float
    due: Due = ()  # in all systems that are in it, and not performed
    ways: tuple[Way, ...] = ()  # none: it is so from the start or a reset on

    def met(self, other: Occupied) -> Occupied:
        """Return the same state with the systems of another side."""
        earliest, latest = min(self.earliest, other.earliest), max(self.latest, other.latest)
        ways = tuple(dict.fromkeys([*self.ways, *other.ways]))
        return Occupied(earliest, latest, common((self.due, other.due)), ways)


Options = Mapping[int, List[Way]]
"""State -> ways that may be taken from it, in order; behind one that is TRUE is none."""


class Engine:
    """One state machine."""

    def __init__(self, machine: StateMachine) -> None:
        self._machine = machine
        rows, count = [*enumerate(machine.transitions)], range(len(machine.states))
        self._leaving = [[n for n, row in rows if row.source == state] for state in count]
        self._raises: dict[RaisedAction, int] = {}  # which trigger it fires
        self._on_entry = [self._due(row.id, "entry", row.entry) for row in machine.states]
        self._on_exit = [self._due(row.id, "exit", row.exit) for row in machine.states]
        self.reset()

    def _due(self, state: str, moment: str, numbers: Sequence[int]) -> Due:
        made: list[RaisedAction] = []
        for action in (self._machine.actions[k] for k in numbers):
            row = (state, moment, action.kind, action.text, action.target, action.priority)
            made.append(RaisedAction(*row, certain=True))
            if action.raises >= 0:
                self._raises[made[-1]] = action.raises
        return tuple(made)

    def reset(self) -> None:
        """Forget everything of former steps."""
        triggers, unknown = self._machine.triggers, self._machine.start == "unknown"
        begun = UNKNOWN if unknown else FALSE
        self._latched = {k: begun for k, trigger in enumerate(triggers) if trigger.persistent}
        self._raised: dict[int, int] = {}  # trigger -> its value by the actions of the last step
        self.last: int | None = None  # time of the last step
        self.occupied: dict[int, Occupied] = {}  # by state
        self.values: list[int] = [FALSE] * len(triggers)  # in the last step
        self.excused: tuple[int, ...] = ()  # triggers that counted as FALSE, by ``absent``
        self.since = 0.0  # latest possible entry of the only state; of several, their last change
        self.good_since: dict[str, int] = {}  # evidence -> from when on it has been good

    def step(
        self,
        t: int,  # nanoseconds, another time than that of the last step
        values: Sequence[int],  # of the triggers; those that are raised count by themselves
        reset: int = FALSE,
        observed: Mapping[int, int] = {},  # state -> its value
        *,
        waiting: bool = False,  # for first messages
    ) -> StateMachineOutput:
        """Take one step; the result has no id, and no inputs."""
        states, before, reasons = self._machine.states, [*self.occupied], []
        initial = {k: Occupied(t, t) for k, state in enumerate(states) if state.initial}
        everywhere = {k: Occupied(_EVER, t) for k in range(len(states))}
        self._touched: set[RaisedAction] = set()  # on any way
        if self.last is None:
            unknown = self._machine.start == "unknown"
            reasons += ["start"] if unknown else []
            self.occupied = everywhere if unknown else initial
        elif t < self.last:
            reasons.append("clock")
            rows = self.occupied.items()
            self.occupied = {k: stay._replace(earliest=_EVER, latest=t) for k, stay in rows}
        elif t - self.last > self._machine.max_gap:  # anything may have happened meanwhile
            reasons.append("gap")
            self._latched = {k: max(held, UNKNOWN) for k, held in self._latched.items()}
            self._raised = dict.fromkeys(self._raised, UNKNOWN)  # heard in the gap, or only now
            self.values = [UNKNOWN] * len(self._machine.triggers)
            self._move(self.last, t, missed=True)
            self.good_since = {}
        self.values = self._read(values, reset)
        if reset != FALSE:
            reasons.append("reset")
            kept = {} if reset == TRUE else self.occupied
            both = {k: stay.met(kept[k]) for k, stay in initial.items() if k in kept}
            self.occupied = {**kept, **initial, **both}
        livelock = self._move(t, t)
        reasons += ["livelock"] if livelock else []
        reasons += ["waiting"] if waiting else []
        allowed = [k for k in everywhere if observed.get(k, UNKNOWN) != FALSE]
        occupied = {k: self.occupied[k] for k in allowed if k in self.occupied}
        if not occupied:
            reasons.append("inconsistent")
            occupied = {k: everywhere[k] for k in allowed or everywhere}
        performed = () if livelock else common([stay.due for stay in occupied.values()])
        for k, stay in occupied.items():
            left = tuple([action for action in stay.due if action not in performed])
            occupied[k] = stay._replace(due=left)
        maybe = sorted(self._touched.difference(performed))
        raises = self._raises
        raised = {raises[action]: UNKNOWN for action in maybe if action in raises}
        sure = {raises[action]: TRUE for action in performed if action in raises}
        self._raised = {**raised, **sure}
        self.last, self.occupied = t, occupied
        rows_of_step = (*performed, *[action._replace(certain=False) for action in maybe])
        return self._output(before, rows_of_step, reasons)

    def _read(self, values: Sequence[int], reset: int) -> list[int]:
        """Return the triggers as they count now: raised, excused, latched."""
        pairs = [*enumerate(self._machine.triggers)]
        raised = self._raised
        read = [raised.get(k, FALSE) if trigger.raised else values[k] for k, trigger in pairs]
        self.excused = tuple([k for k, trigger in pairs if trigger.absent and read[k] == UNKNOWN])
        for k in self.excused:
            read[k] = FALSE
        for k, held in self._latched.items():
            read[k] = self._latched[k] = max(read[k], min(held, TRUE - reset))
        return read

    def _output(self, before: list[int], raised: Due, reasons: list[str]) -> StateMachineOutput:
        now, possible, states = self.last or 0, [*self.occupied], self._machine.states
        only = states[possible[0]].id if len(possible) == 1 else ""
        if only:
            self.since = self.occupied[possible[0]].latest
        elif possible != before or self.since > now:
            self.since = now
        withheld, evidence = not _WITHHELD.isdisjoint(reasons), {}
        for claim in self._machine.evidence:
            good = not withheld and set(possible).issubset(claim.states)
            if not good:
                self.good_since.pop(claim.id, None)
            begun = self.good_since.setdefault(claim.id, now) if good else now
            evidence[claim.id] = good and now - begun >= claim.hold
        names, failed = tuple([states[k].id for k in possible]), [states[k].fail for k in possible]
        in_state = {row.id: _verdict([row.id == name for name in names]) for row in states}
        claims, since = (in_state, evidence), (now - self.since) / 1e9
        rest = (names, _verdict(failed), since, *claims, raised, (), tuple(reasons))
        made = StateMachineOutput("", only, *rest)
        return made.without_claims() if withheld else made

    # A move: each possible state follows its transitions until none fires.

    def _move(self, low: int, high: int, *, missed: bool = False) -> bool:
        """Move, and return whether it is a livelock.

        States are entered between ``low`` and ``high``. ``missed``: steps were, so everything may
        have fired, and nothing is sure to have.
        """
        self._low, self._high, self._missed, livelock = low, high, missed, False
        ends: dict[int, Occupied] = {}

        def end(state: int, stay: Occupied, due: Due) -> None:
            stay = stay._replace(due=due)
            ends[state] = ends[state].met(stay) if state in ends else stay

        firsts = {
            k: self._options(k, part, first=True) for k, part in sorted(self.occupied.items())
        }
        if not any(firsts.values()):
            self.occupied = {k: self.occupied[k] for k in firsts}
            return False
        new = Occupied(low, high)
        later = [self._options(k, new, first=missed) for k in range(len(self._leaving))]
        # states where what is momentary and for how long they were occupied make no difference go
        # together
        groups = [[k for k in firsts if firsts[k] == later[k]]]
        for group in groups + [[k] for k in firsts if firsts[k] != later[k]]:
            options = {**dict(enumerate(later)), **{k: firsts[k] for k in group}}
            begun = {k: self.occupied[k] for k in group}
            entered = self._entered({k: part.due for k, part in begun.items()}, options)
            certain: dict[int, int] = {}  # state -> where it is sure to lead
            for state in {**begun, **entered}:
                sides = [of[state] for of in (begun, entered) if state in of]
                for way in options[state]:
                    target = self._machine.transitions[way.transition].target
                    if target != state and way.verdict == TRUE:
                        certain[state] = target
                    for part in sides if target == state else ():  # this ends the move
                        end(state, new._replace(ways=(way,)), self._hop(part.due, state, state))
                stays = all(way.verdict != TRUE for way in options[state])
                circle = None if stays else self._entered({state: ()}, options).get(state)
                for part in sides:
                    if stays:
                        end(state, part, part.due)
                    elif circle is not None:
                        before = [due for due in part.due if due not in circle.due]
                        end(state, circle, (*before, *circle.due))
            for state in certain:
                passed = state
                for _ in certain:
                    passed = certain.get(passed, -1)
                    livelock = livelock or passed == state
        self.occupied = {state: ends[state] for state in sorted(ends)}
        return livelock

    def _options(self, state: int, stay: Occupied, *, first: bool) -> list[Way]:
        """Return the ways that may be taken; ``first``: what is momentary counts."""
        ways: list[Way] = []
        for number in self._leaving[state]:
            transition, verdict, decides = self._machine.transitions[number], FALSE, -1
            for k in transition.triggers:
                trigger, value = self._machine.triggers[k], self.values[k]
                lasts = trigger.persistent or not (trigger.momentary or trigger.raised)
                if value > verdict and (first or lasts):
                    verdict, decides = value, k
            if transition.after is not None:
                over = TRUE if self._high - stay.latest >= transition.after else UNKNOWN
                over = FALSE if self._high - stay.earliest < transition.after else over
                verdict = min(verdict, over) if transition.triggers else over
            verdict = min(verdict, UNKNOWN) if self._missed else verdict
            ways += [Way(number, verdict, decides)] if verdict != FALSE else []
            if verdict == TRUE:
                break
        return ways

    def _entered(self, begun: Mapping[int, Due], options: Options) -> dict[int, Occupied]:
        """Return each state that is entered, with what is due on all ways to it."""
        entered: dict[int, Occupied] = {}
        open_ = [*begun.items()][::-1]
        while open_:
            state, due = open_.pop()
            onward = []
            for way in options[state]:
                target = self._machine.transitions[way.transition].target
                if target != state:
                    new = Occupied(self._low, self._high, self._hop(due, state, target), (way,))
                    known = entered.get(target)
                    entered[target] = new if known is None else known.met(new)
                    if known is None or entered[target].due != known.due:
                        onward.append((target, entered[target].due))
            open_ += reversed(onward)
        return entered

    def _hop(self, due: Due, source: int, target: int) -> Due:
        """Return what is due after a transition: each action once, at its latest place."""
        new = (*self._on_exit[source], *self._on_entry[target])
        self._touched.update(new)
        return tuple([action for action in due if action not in new]) + new


def common(lists: Iterable[Due]) -> Due:
    """Return what is in all lists, in the order of the first one."""
    first, *others = lists
    return tuple([due for due in first if all(due in other for other in others)])


def _verdict(truths: Sequence[bool]) -> int:
    """Return what is true in all systems."""
    return TRUE if all(truths) else UNKNOWN if any(truths) else FALSE

"""The monitor of a state machine: inputs to triggers, the set of possible states to claims."""

from __future__ import annotations

from collections import deque
from typing import Any, Callable, Iterable, Iterator, Mapping, Sequence

from ..event import ConditionMonitor
from ..expressions import Value as Number
from ..expressions import truth
from ..inputs import NO_TIME, UNDECIDED, InputSpec, invalid, look_again, states_of, step_time
from ..monitor import Json, Tree, Value
from ..why import FALSE, TEXTS, TRUE, UNKNOWN, Cause, length, seconds
from .engine import Engine, Way
from .machine import RaisedAction, StateMachine, StateMachineOutput

_NAMES = ("FALSE", "UNKNOWN", "TRUE")
_VERDICTS = (False, None, True)
_KEPT = 32  # changes, for people
_MOST = 256  # actions that wait for ``published``
_WITHHELD = {
    "clock": "the clock stands, or went back",
    "inconsistent": "what is observed excludes every possible state",
    "time": NO_TIME,
}


class StateMachineMonitor(StateMachine, ConditionMonitor[StateMachineOutput]):
    """What the class ``Monitor`` of a compiled state machine inherits; not thread-safe.

    ``step`` gives 0, 1 or 2 for each of the triggers, those of ``observe``, then ``reset_by``,
    without those that are ``raised`` or made of ``messages``.
    """

    kind = "state_machine"
    hazards = frozenset(["failed"])

    def __init__(self, actions: object | None = None) -> None:
        self._methods = actions
        self._engine = Engine(self)
        self.unlogged = frozenset([one.id for one in self.states])
        orders = [self.reset_by] if self.reset_by else []
        self._asked = [*self.triggers, *(one for _, one in self.observe), *orders]
        # inputs that have a limit of age; those of messages without one need never come
        self._limited = [isinstance(spec.max_age, (int, float)) for spec in self.inputs]
        of_messages = [k for one in self._asked if one.messages for k in one.needs]
        self._sporadic = [k for k in dict.fromkeys(of_messages) if not self._limited[k]]
        self.reset()

    def reset(self) -> None:
        super().reset()
        self._engine.reset()
        self._came = [False] * len(self.inputs)
        self._usable = self._usable_then = self._came[:]
        # of each trigger: it has not been known since the start, and no input was wrong
        self._settling = [True] * len(self._asked)
        self._happened = [FALSE] * len(self._asked)  # by messages since the last step
        unknown, off = {one.id: 1 for one in self.states}, {one.id: False for one in self.evidence}
        nothing = (self.model_id, "", tuple(unknown), 1, 0.0, unknown, off, (), (), ())
        self._moved = self._result = StateMachineOutput(*nothing)  # of the last move, and step
        self._told: dict[tuple[int, Way], str] = {}  # state and way -> how it was entered
        self._changes: deque[str] = deque(maxlen=_KEPT)
        self._pending: deque[RaisedAction] = deque(maxlen=_MOST)
        self._failures: dict[str, tuple[str, int]] = {}  # method -> why it failed, how often

    def execute_step(self, eddi_input: object, t_ns: int | None = None) -> StateMachineOutput:
        """Return what follows of one step; never raises.

        What is no value for an input is UNKNOWN. A step without a time, or at that of the last
        one, moves nothing. What is due is done at the end; in a node ``published`` does it.
        """
        self._waited = look_again(eddi_input, t_ns)
        self._source, self._at = eddi_input, t_ns
        t = step_time(t_ns)
        verdicts: Sequence[Number] = () if t is None else self.step(eddi_input, t)
        if t is None:
            self.raw = self.read(eddi_input)
        self._look()
        unknown = tuple([spec.id for spec in self._unknown()])
        if t is not None and t != self._engine.last:
            before, self._usable_then = self._moved, self._usable
            made = self._move(t, verdicts)
            self._moved = made._replace(id=self.model_id, unknown_inputs=unknown)
            self._pending.extend(
                one for one in made.raised if one.certain or one not in before.raised
            )
            self._note(t, before.possible != made.possible)
            self._result = self._moved
        else:
            self._result = self._moved._replace(raised=(), unknown_inputs=unknown)
            lost = any(then and not now for then, now in zip(self._usable_then, self._usable))
            if t is None or lost:  # where a simulation's clock stands, silence shows all the same
                self._result = self._result.without_claims("time" if t is None else "clock")
        if self._pending and not self.deferred:
            import logging  # noqa: PLC0415 - where nothing is due it is not needed

            log = logging.getLogger(__name__)
            self.published(log.warning, lambda *row: log.error("%s: %s\n%s", *row))
        return self._result

    def _unknown(self) -> Iterator[InputSpec]:
        for k, spec in enumerate(self.inputs):
            if not self._usable[k] and (self._came[k] or k not in self._sporadic):
                yield spec

    def _look(self) -> None:
        """Note which inputs have come and have a value, and what messages say."""
        states = states_of(self._source)
        known = [raw is not None for raw in self.raw]
        for k, spec in enumerate(self.inputs):
            state = states.get(spec.id)
            absent = state is None or state.state == "missing" or state.reason == UNDECIDED
            self._came[k] = self._came[k] or known[k] or not absent
        self._usable = [one and not self._unusable(k) for k, one in enumerate(known)]
        for k, one in enumerate(self._asked):
            if one.messages:
                (n,) = one.needs
                raw: Any = self.raw[n]
                rows = raw if issubclass(type(raw), (list, tuple)) else (raw,)
                truths = [FALSE, *map(truth, rows)]
                if raw is None and n in self._sporadic and not self._came[n]:
                    truths = [FALSE]
                self._happened[k] = max(self._happened[k], TRUE if TRUE in truths else max(truths))

    def _move(self, t: int, verdicts: Sequence[Number]) -> StateMachineOutput:
        """Take a step; a trigger that cannot be known yet is FALSE, and nothing is claimed."""
        last, given, size = self._engine.last, iter(verdicts), len(self.triggers)
        if last is not None and not 0 < t - last <= self.max_gap:
            self._settling = [False] * len(self._asked)
        values, waiting = [], False
        for k, one in enumerate(self._asked):
            value = (
                FALSE if one.raised else self._happened[k] if one.messages else int(next(given))
            )
            wrong = any(self._came[n] and not self._usable[n] for n in one.needs)
            never = [n for n in one.needs if not self._came[n]]
            if wrong or (value != UNKNOWN and not never):
                self._settling[k] = False
            early = value == UNKNOWN and not wrong and (bool(never) or self._settling[k])
            late = [n for n in never if self._limited[n] or not one.momentary]
            if k < size and self.start == "unknown" and (late or not one.momentary):
                early, late = False, []
            is_observed = size <= k < size + len(self.observe)
            values.append(FALSE if early and not is_observed else value)
            waiting = waiting or (k < size and bool(late or (early and not one.momentary)))
        observed = {state: value for (state, _), value in zip(self.observe, values[size:])}
        reset = values[-1] if self.reset_by else FALSE
        self._happened = [FALSE] * len(self._asked)
        return self._engine.step(t, values[:size], reset, observed, waiting=waiting)

    def published(
        self, warn: Callable[[str], object], error: Callable[[str, str, str], object]
    ) -> None:
        """Give the warnings since the last call, and call the functions that are certain."""
        names = {one.text: one.method for one in self.actions if one.kind == "function"}
        while self._pending:
            one = self._pending.popleft()
            if one.kind == "warning":
                perhaps = "" if one.certain else "perhaps "
                warn(f"{perhaps}{one.text} ({one.moment} {one.state}, priority {one.priority})")
            name = names[one.text] if one.kind == "function" and one.certain else ""
            method: Any = getattr(self._methods, name, None) if name else None
            if method is None:
                continue
            try:
                method(one)
                if self._failures.pop(name, None):
                    error(name, "", "")
            except Exception as problem:  # noqa: BLE001 - whatever a person's method raises
                state, (_, count) = invalid(problem, None), self._failures.get(name, ("", 0))
                reason = state.text or f"{name} raised {state.reason}"
                self._failures[name] = reason, count + 1
                error(name, reason, state.detail)

    def output_faults(self) -> tuple[str, ...]:
        failed = [f"{reason}, {count} times" for reason, count in self._failures.values()]
        return (*self._output_faults, *failed)

    # What it gives.

    def as_json(self, output: StateMachineOutput) -> Json:
        rows: Any = [one._asdict() for one in output.raised]
        return {**output._asdict(), "raised": rows}

    def series(self, output: StateMachineOutput) -> Mapping[str, Value]:
        states = {name: _VERDICTS[verdict] for name, verdict in output.in_state.items()}
        failed = _VERDICTS[output.failed]
        return {"state": output.state or None, "failed": failed, **states, **output.evidence}

    def message(self, output: object) -> Tree:
        given = output if isinstance(output, StateMachineOutput) else None
        self._output_faults = () if given else ("the output is no result of this monitor",)
        given = given or self._moved._replace(raised=()).without_claims("output")
        states = [(name, value, value == TRUE) for name, value in given.in_state.items()]
        raised: list[Tree] = [("StateMachineAction", one._asdict()) for one in given.raised]
        return "StateMachineOutput", {
            "id": given.id,
            "state": given.state,
            "possible": [*given.possible],
            "failed": given.failed,
            "since_seconds": given.since_seconds,
            "in_state": _rows("StateVerdict", ("id", "verdict", "active"), states),
            "evidence": _rows("StateMachineEvidence", ("id", "active"), given.evidence.items()),
            "raised": raised,
            "unknown_inputs": [*given.unknown_inputs],
            "reason": ", ".join(given.reasons),
            "accepted": [*self.accepted()],
        }

    def accepted(self) -> tuple[str, ...]:
        excused = [f"{self.triggers[k].text}: absent: true" for k in self._engine.excused]
        silent = [self.inputs[k].id for k in self._sporadic if not self._came[k]]
        return (*super().accepted(), *excused, *[f"{id_}: max_age: none" for id_ in silent])

    def blocked(self) -> Mapping[str, tuple[str, ...]]:
        lost = tuple([name for name, on in self._result.evidence.items() if not on])
        return {spec.id: lost or ("state",) for spec in self._unknown()}

    # Why.

    def _whys(self) -> Iterator[tuple[str, int, Iterable[Cause]]]:
        result, names = self._result, [one.id for one in self.states]
        good = {one.id for one in self.states if not one.fail}
        yield "failed", TRUE - result.failed, self._causes(good)
        for name, verdict in result.in_state.items():
            yield name, verdict, self._causes({name})
        for one in self.evidence:
            inside = {names[k] for k in one.states}
            verdict = max(result.in_state[name] for name in inside)
            hold = Cause((), "hold", TEXTS["hold"], limit=one.hold / 1e9)
            hold = hold._replace(since=self._lasting(self._engine.good_since.get(one.id)))
            verdict = TRUE if result.evidence[one.id] else min(verdict, UNKNOWN)
            yield one.id, verdict, self._causes(inside) or [hold]

    def _causes(self, inside: set[str]) -> list[Cause]:
        """Return why the system is not known to be in one of these states."""
        reasons, possible = self._result.reasons, self._result.possible
        texts = [text for reason, text in _WITHHELD.items() if reason in reasons]
        causes = [Cause((), "invalid", text) for text in texts]
        if "waiting" in reasons:
            late = [spec for k, spec in enumerate(self.inputs) if not self._came[k]]
            causes += self._of_unknown(late, {}) or [Cause((), "window", TEXTS["window"])]
        sure = inside.isdisjoint(possible)
        for state, one in self._engine.occupied.items() if not causes else ():
            name = self.states[state].id
            if name in inside:
                continue
            since = self._lasting(one.latest if len(possible) == 1 else one.earliest)
            text = f"{'' if len(possible) == 1 else 'perhaps '}in {name} for {{since}}"
            ways = sorted(one.ways, key=lambda way: -way.verdict)
            unknown = self._not_known([way.trigger for way in ways if way.verdict == UNKNOWN])
            if sure or not unknown:
                because = f", because {self._decider(ways[0])}" if ways else ""
                state_of_cause = "false" if sure else "window"
                causes.append(Cause((), state_of_cause, text + because, since=since))
            else:
                detail = text.replace("{since}", seconds(since))
                causes += self._of_unknown(unknown, self.faults(), detail)
        return causes

    def _not_known(self, triggers: Iterable[int]) -> list[InputSpec]:
        needs = {n for k in triggers if k >= 0 for n in self.triggers[k].needs}
        return [self.inputs[n] for n in sorted(needs) if not self._usable[n]]

    def _decider(self, way: Way) -> str:
        """Return what let a transition fire."""
        transition = self.transitions[way.transition]
        if way.trigger >= 0:
            return self.triggers[way.trigger].text
        source = self.states[transition.source].id
        return f"it was {length((transition.after or 0) / 1e9)} in {source}"

    def explain(self) -> str:
        """Return how each possible state was entered, the triggers now, and the last changes."""
        lines = []
        for state, one in self._engine.occupied.items():
            least, most = seconds(self._lasting(one.latest)), seconds(self._lasting(one.earliest))
            lines.append(
                f"{self.states[state].id} for {least}" + (f" .. {most}" if most != least else "")
            )
            lines += [f"  {self._told[state, way]}" for way in one.ways]
        lines += [self._value(k) for k in range(len(self.triggers))]
        return "\n".join([*lines, *self._changes])

    def _value(self, k: int) -> str:
        value = self._engine.values[k]
        unknown = self._not_known([k]) if value == UNKNOWN else []
        chains = "; ".join([cause.chain for cause in self._of_unknown(unknown, self.faults())])
        return f"{self.triggers[k].text} {_NAMES[value]}" + (f" ({chains})" if chains else "")

    def _note(self, t: int, is_other: bool) -> None:
        """Keep how states were entered, and that the set is another one."""
        told, new = {}, []
        for state, one in self._engine.occupied.items():
            for way in one.ways:
                told[state, way] = self._told.get((state, way), "")
                if not told[state, way]:
                    row = self.transitions[way.transition]
                    values = [
                        self._value(k) for k in row.triggers if self._engine.values[k] != FALSE
                    ]
                    by = ", ".join(values) or self._decider(way)
                    name = " ".join(filter(None, (row.name, row.place and f"({row.place})")))
                    told[state, way] = f"by {name}: {by}"
                    new.append(f"{self.states[state].id} {told[state, way]}")
        self._told = told
        if is_other or new:
            why = "; ".join([*self._moved.reasons, *new])
            self._changes.append(f"{t / 1e9:.1f} s: {' or '.join(self._moved.possible)}: {why}")


def _rows(message: str, fields: Sequence[str], rows: Iterable[Sequence[Any]]) -> list[Tree]:
    return [(message, dict(zip(fields, row))) for row in rows]

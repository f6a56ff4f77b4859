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

_VERDICTS = (False, None, True)
_MOST = 256  # actions that wait for ``published``
_EARLY = ("missing", "untold")  # states of an input that has not been known since the start
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
        self.unlogged = frozenset([row.id for row in self.states])
        orders = [self.reset_by] if self.reset_by else []
        self._asked = [*self.triggers, *(row for _, row in self.observe), *orders]
        # inputs that have a limit of age; those of messages without one need never come
        self._limited = [isinstance(spec.max_age, (int, float)) for spec in self.inputs]
        of_messages = [k for row in self._asked if row.messages for k in row.needs]
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
        unknown, off = {row.id: 1 for row in self.states}, {row.id: False for row in self.evidence}
        nothing = (self.model_id, "", tuple(unknown), 1, 0.0, unknown, off, (), (), ())
        self._moved = self._result = StateMachineOutput(*nothing)  # of the last move, and step
        self._late: set[int] = set()  # inputs for which it waits
        self._silent: set[int] = set()  # inputs that hold no message, and need not
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
        unknown = tuple([spec.id for spec, good in zip(self.inputs, self._usable) if not good])
        if t is not None and t != self._engine.last:
            before, self._usable_then = self._moved, self._usable
            made = self._move(t, verdicts)
            self._moved = made._replace(id=self.model_id, unknown_inputs=unknown)
            known = [action for action in before.raised if not action.certain]
            self._pending.extend([action for action in made.raised if action not in known])
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

    def _look(self) -> None:
        """Note which inputs have come and have a value, and what messages tell."""
        states = states_of(self._source)
        for k, spec in enumerate(self.inputs):
            state = states.get(spec.id)
            early = state is None or state.state in _EARLY or state.reason == UNDECIDED
            self._came[k] = self._came[k] or self.raw[k] is not None or not early
        missing = {name for name, state in states.items() if state.state == "missing"}
        silent = [k for k in self._sporadic if self.raw[k] is None]
        self._silent = {k for k in silent if not self._came[k] or self.inputs[k].id in missing}
        self._usable = [
            k in self._silent or (raw is not None and not self._unusable(k))
            for k, raw in enumerate(self.raw)
        ]
        for k, trigger in enumerate(self._asked):
            if trigger.messages:
                raw: Any = [] if trigger.needs[0] in self._silent else self.raw[trigger.needs[0]]
                rows = list.__iter__(raw) if issubclass(type(raw), list) else (raw,)
                self._happened[k] = max(self._happened[k], *map(truth, rows), FALSE)

    def _move(self, t: int, verdicts: Sequence[Number]) -> StateMachineOutput:
        """Take a step; a trigger that cannot be known yet is FALSE, and nothing is claimed."""
        last, given, size = self._engine.last, iter(verdicts), len(self.triggers)
        if last is not None and not 0 < t - last <= self.max_gap:
            self._settling = [False] * len(self._asked)
        values, waiting, self._late = [], False, set()
        for k, trigger in enumerate(self._asked):
            value = self._happened[k] if trigger.raised or trigger.messages else int(next(given))
            wrong = any(self._came[n] and not self._usable[n] for n in trigger.needs)
            never = [n for n in trigger.needs if not self._came[n]]
            if wrong or (value != UNKNOWN and not never):
                self._settling[k] = False
            early = value == UNKNOWN and not wrong and (bool(never) or self._settling[k])
            late = [n for n in never if self._limited[n] or not trigger.momentary]
            is_observed = size <= k < size + len(self.observe)
            # what is observed never moves it, an order to reset was not given before it came
            moves = k < size or not (is_observed or trigger.messages)
            if moves and self.start == "unknown" and (late or not trigger.momentary):
                early, late = False, []
            values.append(FALSE if early and not is_observed else value)
            if moves:
                self._late.update(late)
                waiting = waiting or bool(late) or (early and not trigger.momentary)
        observed = {state: value for (state, _), value in zip(self.observe, values[size:])}
        reset = values[-1] if self.reset_by else FALSE
        self._happened = [FALSE] * len(self._asked)
        return self._engine.step(t, values[:size], reset, observed, waiting=waiting)

    def published(
        self, warn: Callable[[str], object], error: Callable[[str, str, str], object]
    ) -> None:
        """Give the warnings since the last call, and call the functions that are certain."""
        names = {row.text: row.method for row in self.actions if row.kind == "function"}
        while self._pending:
            action = self._pending.popleft()
            where = f"{action.moment} {action.state}"
            if action.kind == "warning":
                perhaps = "" if action.certain else "perhaps "
                warn(f"{perhaps}{action.text} ({where}, priority {action.priority})")
            if action.kind != "function" or not action.certain:
                continue
            warn(f"{action.text} is due ({where})")
            if self._methods is None:
                continue
            name = names[action.text]
            try:
                getattr(self._methods, name)(action)
                if self._failures.pop(name, None):
                    error(name, "", "")
            except Exception as problem:  # noqa: BLE001 - whatever a person's method raises
                state, (_, count) = invalid(problem, None), self._failures.get(name, ("", 0))
                reason = state.text or f"{name} raised {state.reason}"
                self._failures[name] = reason, count + 1
                error(name, reason, state.detail)

    def output_faults(self) -> tuple[str, ...]:
        failed = [f"{reason} ({count} so far)" for reason, count in self._failures.values()]
        return (*self._output_faults, *failed)

    # What it gives.

    def as_json(self, output: StateMachineOutput) -> Json:
        rows: Any = [action._asdict() for action in output.raised]
        return {**output._asdict(), "raised": rows}

    def series(self, output: StateMachineOutput) -> Mapping[str, Value]:
        states = {name: _VERDICTS[verdict] for name, verdict in output.in_state.items()}
        state, failed = " or ".join(output.possible), _VERDICTS[output.failed]
        return {"state": state, "failed": failed, **states, **output.evidence}

    def message(self, output: object) -> Tree:
        given = output if type(output) is StateMachineOutput else None
        self._output_faults = () if given else ("the output is no result of this monitor",)
        given = given or self._moved._replace(raised=()).without_claims("output")
        states = [
            ("StateVerdict", {"id": name, "verdict": verdict, "active": verdict == TRUE})
            for name, verdict in given.in_state.items()
        ]
        pairs = given.evidence.items()
        fields: dict[str, Any] = {
            **given._asdict(),
            "possible": [*given.possible],
            "in_state": states,
            "evidence": [("StateMachineEvidence", {"id": k, "active": on}) for k, on in pairs],
            "raised": [("StateMachineAction", action._asdict()) for action in given.raised],
            "unknown_inputs": [*given.unknown_inputs],
            "reason": ", ".join(given.reasons),
            "accepted": [*self.accepted()],
        }
        del fields["reasons"]
        return "StateMachineOutput", fields

    def accepted(self) -> tuple[str, ...]:
        excused = [f"{self.triggers[k].text}: absent: true" for k in self._engine.excused]
        silent = [self.inputs[k].id for k in sorted(self._silent)]
        return (*super().accepted(), *excused, *[f"{id_}: max_age: none" for id_ in silent])

    # Why.

    def _whys(self) -> Iterator[tuple[str, int, Iterable[Cause]]]:
        result, good = self._result, {state.id for state in self.states if not state.fail}
        for claim in self.evidence:
            inside = {self.states[k].id for k in claim.states}
            since = self._lasting(self._engine.good_since.get(claim.id))
            hold = Cause((), "hold", TEXTS["hold"], since=since, limit=claim.hold / 1e9)
            verdict = max([result.in_state[name] for name in inside], default=FALSE)
            verdict = TRUE if result.evidence[claim.id] else min(verdict, UNKNOWN)
            yield claim.id, verdict, self._causes(inside) or [hold]
        yield "failed", TRUE - result.failed, self._causes(good)
        for name, verdict in result.in_state.items():
            yield name, verdict, self._causes({name})

    def _causes(self, inside: set[str]) -> list[Cause]:
        """Return why the system is not known to be in one of these states."""
        reasons, possible = self._result.reasons, self._result.possible
        sure, perhaps = inside.isdisjoint(possible), "" if len(possible) == 1 else "perhaps "
        withheld = () if sure else [name for name in _WITHHELD if name in reasons]
        causes = [Cause((), "invalid", _WITHHELD[name]) for name in withheld]
        if "waiting" in reasons and not sure:
            late = self._of_unknown([self.inputs[n] for n in sorted(self._late)], {})
            filled = self._lasting(self.since or None)
            causes += late or [Cause((), "window", TEXTS["window"], since=filled)]
        for state, stay in self._engine.occupied.items() if not causes else ():
            if self.states[state].id in inside:
                continue
            since = self._lasting(stay.earliest if perhaps else stay.latest)
            text = f"{perhaps}in {self.states[state].id} for {{since}}"
            ways = sorted(stay.ways, key=lambda way: -way.verdict)
            unknown = self._unknown_of(*[way.trigger for way in ways if way.verdict == UNKNOWN])
            if sure or not unknown:
                text += f", because {self._because(ways[0])}" if ways else ""
                causes.append(Cause((), "false" if sure else "window", text, since=since))
            else:
                detail = text.replace("{since}", seconds(since))
                causes += self._of_unknown(unknown, self.faults(), detail)
        return causes

    def _unknown_of(self, *triggers: int) -> list[InputSpec]:
        needs = {n for k in triggers if k >= 0 for n in self.triggers[k].needs}
        return [self.inputs[n] for n in sorted(needs) if not self._usable[n]]

    def _because(self, way: Way) -> str:
        """Return what let a transition fire."""
        row, doubt = self.transitions[way.transition], way.verdict == UNKNOWN
        if way.trigger >= 0:
            return f"{self.triggers[way.trigger].text}{' was not known' if doubt else ''}"
        stay = f"{length((row.after or 0) / 1e9)} in {self.states[row.source].id}"
        return f"it {'may have been' if doubt else 'was'} {stay}"

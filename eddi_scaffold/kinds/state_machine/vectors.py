"""Test vectors of a state machine: each transition from its source, and what may happen there.

What comes out is by definition: the states in which the machine may be. A run ends where these are
several. Of windows and what else conditions remember, little is told: then it is not complete.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import chain, combinations, product
from typing import TYPE_CHECKING, Any

from eddi_scaffold.conditions.definition import STATEFUL, History, Sample, sample_of
from eddi_scaffold.conditions.samples import Drawing
from eddi_scaffold.evidence import vectors

if TYPE_CHECKING:
    from eddi_scaffold.kinds.state_machine.machine import StateMachine
    from eddi_scaffold.kinds.state_machine.options import Settings
    from eddi_scaffold.program.input_expressions import BoundInput

_F, _U, _T = range(3)
_TRUTHS, _NAMES = (False, None, True), ("false", "unknown", "true")
_ORDERS: Sequence[Any] = ([], [None], [True])  # messages that give a truth
_MOST_STATES, _MOST_STEPS, _MOST_WAYS = 200, 200, 1000
Given = Mapping[str, Any]  # input -> value
Steps = list[tuple[int, Given]]  # after how many nanoseconds, and what is given


class Definition:
    """The states in which a machine may be; something is given for each input from the start."""

    def __init__(
        self, machine: StateMachine, settings: Settings, factors: Mapping[str, Any]
    ) -> None:
        self.machine, self.settings, self.factors = machine, settings, factors
        gap = max(1.0, 2.5 / settings.rate) if settings.max_gap is None else settings.max_gap
        self.max_gap, self.is_unknown = round(gap * 1e9), settings.start == "unknown"
        asked: dict[Any, Any] = dict(zip(machine.triggers, settings.values, strict=True))
        self.raises = {key.text: key for key, of in asked.items() if of.is_raised}
        self.absent = [key for key, of in asked.items() if of.is_absent]
        self.momentary = {key for key in asked if key.is_external or key.text in self.raises}
        self.held = {key: _U * self.is_unknown for key in asked if key.is_persistent}
        asked |= {None: settings.reset} if settings.reset else {}
        self.orders = {key: of.input for key, of in asked.items() if of.input}
        self.conditions = {key: of.condition for key, of in asked.items() if of.condition}
        self.early = self.momentary if self.is_unknown else {*self.conditions}
        self.conditions |= settings.observe
        self.samples, self.raised = list[Sample](), set[str]()  # texts of actions of the last step
        self.good_since: dict[str, int] = {}  # by claim
        self.possible = set[tuple[str, float]]()  # states, and when they were entered
        self.is_certain, self.work = True, 0

    def step(self, t: int, given: Given) -> dict[str, Any]:
        """Return the results; nothing follows a step that is not certain."""
        states, last = self.machine.state, self.samples[-1].t if self.samples else t
        anywhere = {*product(states, (-math.inf, t))}
        initial: set[tuple[str, float]] = {(of, t) for of in states if states[of].is_initial}
        if not self.samples:
            self.possible = anywhere if self.is_unknown else initial
        self.samples.append(Sample(t, given, {}))
        is_gap, raised, self.raised = t - last > self.max_gap, self.raised, set()
        if t < last:
            self.possible |= {(of, -math.inf) for of, _ in self.possible}
        elif is_gap:  # all may have fired, and nothing is sure to have
            self.held, self.good_since = {of: max(held, _U) for of, held in self.held.items()}, {}
            self._move(dict.fromkeys(self.machine.triggers, _U), last, t)
        values, is_waiting = self._read(is_new=t >= last and not is_gap)
        values |= {key: (_T - is_gap) * (text in raised) for text, key in self.raises.items()}
        values |= {key: _F for key in self.absent if values[key] == _U}
        reset = values.get(None, _F)
        for key, held in self.held.items():
            values[key] = self.held[key] = max(values[key], min(held, _T - reset))
        if reset != _F:
            self.possible = initial | (set() if reset == _T else self.possible)
        self._move(values, t)
        allowed = {of for of in states if values.get(of, _T) != _F}
        occupied = {(of, since) for of, since in self.possible if of in allowed}
        self.possible = occupied or {pair for pair in anywhere if pair[0] in (allowed or states)}
        self.is_certain = self.is_certain and len(self.possible) == 1
        is_withheld, names = is_waiting or t < last or not occupied, {of for of, _ in self.possible}

        def verdict(*inside: str) -> int:
            return _T if names <= {*inside} else _U if names & {*inside} else _F

        results: dict[str, Any] = {"state": " or ".join(filter(names.__contains__, states))}
        results |= {of: _TRUTHS[_U if is_withheld else verdict(of)] for of in states}
        results["failed"] = _TRUTHS[max(verdict(*self.machine.fail), _U * is_withheld)]
        for claim in self.settings.evidence:
            is_good = not is_withheld and names <= {*claim.states}
            begun = self.good_since.pop(claim.id, t)
            self.good_since |= {claim.id: begun} if is_good else {}
            results[claim.id] = is_good and t - begun >= round(claim.hold * 1e9)
        return results

    def _read(self, *, is_new: bool) -> tuple[dict[Any, int], bool]:
        """Return the truths, FALSE where not known since the start, and whether it waits so."""
        values, is_waiting, raws = dict[Any, int](), False, self.samples[-1].values
        for key, name in self.orders.items():
            rows = raws[name] if isinstance(raws[name], list) else [raws[name]]
            values[key] = max(map(_TRUTHS.index, rows), default=_F)
        for key, program in self.conditions.items():
            verdicts = [of for (of,) in History(program, self.samples, self.factors).results()]
            values[key] = _TRUTHS.index(verdicts[-1])
            known = (sample_of(of, raws, self.factors.get(of.name)) for of in program.reads)
            if is_new and {*verdicts} == {None} and None not in known and key in self.early:
                values[key], is_waiting = _F, is_waiting or key not in self.momentary
        return values, is_waiting

    def _move(self, values: Mapping[Any, int], *moments: int) -> None:
        """Follow each possible state until nothing fires; what is UNKNOWN does, and does not.

        ``moments``: when states are entered; two are the ends of a gap.
        """
        begun, self.possible, is_gap = self.possible, set(), len(moments) > 1

        def walk(since: Sequence[float], *passed: str) -> None:
            state, is_first = self.machine.state[passed[-1]], len(passed) == 1
            self.work += 1
            if self.work > _MOST_WAYS:
                raise vectors.TooMuchError
            for each in self.machine.leaving[state.name]:
                once = () if is_first or is_gap else self.momentary - self.held.keys()
                verdict = max([values[of] for of in each.triggers if of not in once], default=_F)
                if each.after is not None:
                    overs = [moments[-1] - of >= round(each.after * 1e9) for of in since]
                    over = _T if all(overs) else _U * any(overs)
                    verdict = min(verdict, over) if each.triggers else over
                verdict = min(verdict, _T - is_gap)
                if verdict == _F:
                    continue
                self.is_certain = self.is_certain and verdict == _T
                due = [*state.exit, *self.machine.state[each.target].entry]
                self.raised |= {of.text for of in due if of.is_event}
                if each.target not in passed:
                    walk(moments, *passed, each.target)
                else:  # each state of the circle, which may be a single one, is possible
                    self.possible |= {*product(passed[passed.index(each.target) :], moments)}
                if verdict == _T:
                    return
            self.possible |= {*product([state.name], since)}

        for state in {of for of, _ in begun}:
            walk([since for of, since in begun if of == state], state)


class _Vectors:
    """Runs of a machine."""

    def __init__(
        self, machine: StateMachine, settings: Settings, inputs: Sequence[BoundInput]
    ) -> None:
        factors = {of.id: of.factor for of in inputs if of.factor is not None}
        self.parts, self.machine, self.settings = (machine, settings, factors), machine, settings
        self.definition = of = Definition(*self.parts)
        self.period, self.is_complete = round(1e9 / settings.rate), True
        self.usual, self.lasting = dict[Any, int](), dict[Any, int]()  # of conditions
        self.drawn: dict[Any, list[Given]] = {}  # condition -> inputs, also wrong ones
        orders = of.orders.values()
        self.calm: dict[str, Any] = {k.id: [] if k.id in orders else None for k in inputs}
        for key, program in of.conditions.items():
            drawing, rows = Drawing(program, 0, factors), program.operations
            given = {repr(of.values): of.values for run in drawing.runs() for of in run.steps}
            self.drawn[key], self.lasting[key] = [*given.values()], max(row.window for row in rows)
            self.calm |= next(iter(given.values()), {})
            self.usual[key] = _T if key in settings.observe else _F
            self.calm = next(self.made(key, self.usual[key]), self.calm)
            is_plain = not any(row.window or row.op in STATEFUL for row in rows)
            self.is_complete = self.is_complete and is_plain and not drawing.missed

    def truth(self, key: Any, given: Given) -> int:
        """Return the truth of a condition of inputs that were calm, and then do not change."""
        program = self.definition.conditions[key]._replace(period=1 << 61)
        samples = [Sample(k << 60, row, {}) for k, row in enumerate((self.calm, given))]
        return _TRUTHS.index(History(program, samples, self.definition.factors).results()[-1][0])

    def made(self, key: Any, truth: int) -> Iterator[dict[str, Any]]:
        """Yield inputs with which a trigger has a truth, and others are as usual, if there are."""
        order = {of: _ORDERS[truth] for k, of in self.definition.orders.items() if k == key}
        wants = {k: truth if k == key else usual for k, usual in self.usual.items()}
        rows = ({**self.calm, **order, **of} for of in self.drawn.get(key, [{}]))
        given = next((r for r in rows if all(self.truth(k, r) == wants[k] for k in wants)), None)
        self.is_complete = self.is_complete and given is not None
        yield from [given] if given is not None else []

    def spread(self, wait: int, given: Given) -> Steps:
        """Return steps as close as windows need."""
        longest = min(5 * self.period // 2, self.definition.max_gap)
        rest = [(wait % longest, given)] if wait % longest else []
        return [(longest, given)] * (wait // longest) + rest

    def until(self, way: Steps, since: str, seconds: float, given: Given) -> Steps:
        """Return steps until just before a state or claim has lasted for a time, and then."""
        self.run("", way)
        begun = {**dict(self.definition.possible), **self.definition.good_since}.get(since, 0)
        wait = round(max(begun, 0) + seconds * 1e9) - sum(of for of, _ in way) - 1
        return [*way, *self.spread(max(wait, 1), given), (1, given)]

    def run(self, name: str, steps: Steps) -> list[vectors.Run]:
        """Return the run, up to a step after which several states are possible."""
        self.definition, rows, t = Definition(*self.parts), list[vectors.Step](), 0
        before: Sequence[Given] = {}, {}
        with suppress(vectors.TooMuchError):
            for wait, given in steps[:_MOST_STEPS]:
                t += wait
                raws = {id_: vectors.as_json(raw) for id_, raw in given.items()}
                now = raws, self.definition.step(t, given)
                rows.append(vectors.Step(t, *map(vectors.changed, before, now)))
                before = now
                if not self.definition.is_certain:
                    break
        self.is_complete = self.is_complete and len(rows) == len(steps)
        return [vectors.Run(name, rows)] if rows else []

    def lines(self, inputs: Sequence[BoundInput]) -> Iterator[Any]:
        """Yield ages and runs; raise an error at the end where something is left out."""
        of, p = self.definition, self.period
        given = self.calm | dict.fromkeys(of.orders.values(), False)
        yield from vectors.age_rows(inputs, given, lambda row: Definition(*self.parts).step(0, row))
        is_reset = of.is_unknown and self.settings.reset
        first: Steps = [(p, given) for given in self.made(None, _T if is_reset else _F)]
        first += self.spread(max([p, *self.lasting.values()]), self.calm)
        yield from self.run("start", first)
        first = first if self.definition.is_certain else []
        possible = {state for state, _ in self.definition.possible}
        ways = {state: first for state in self.machine.state if state in possible}
        for state in (open_ := [*ways]):
            for name, steps in self.taken(state, ways[state]):
                yield from self.run(name, steps)
                reached = [of for of, _ in self.definition.possible if of not in ways]
                if self.definition.is_certain and reached:
                    open_ += reached
                    ways[reached[0]] = steps
        further = chain.from_iterable(map(self.events, ways, ways.values()))
        for name, steps in chain(further, self.guards(ways)):
            yield from self.run(name, steps)
        if not self.is_complete or len(ways) < len(self.machine.states):
            raise vectors.TooMuchError

    def taken(self, state: str, way: Steps) -> Iterator[tuple[str, Steps]]:
        """Yield each transition from a state, by each trigger: not known, then known; timeouts."""
        for each in self.machine.leaving[state]:
            for key, truth in product(each.triggers or [None], (_U, _T) if each.triggers else [_T]):
                for given in self.made(key, truth) if each.triggers else [self.calm]:
                    steps = [*way, (self.period, given)]
                    steps += self.spread(self.lasting.get(key, 0), given)
                    if each.after is not None:
                        steps = self.until(way, state, each.after, given)
                    name = f"{self.machine.called[each]} of line {each.place.line}"
                    yield f"{_NAMES[truth]}:{name}", steps

    def events(self, state: str, way: Steps) -> Iterator[tuple[str, Steps]]:
        """Yield what else may happen in a state."""
        p, calm, called = self.period, self.calm, self.machine.called
        for each, other in combinations(self.machine.leaving[state], 2):
            keys = [*each.triggers[:1], *other.triggers[:1]]
            rows = [given for key in keys for given in self.made(key, _T)]
            both = {k: v for row in rows for k, v in row.items() if v is not calm[k]}
            yield f"precedence:{called[each]}, {called[other]}", [*way, (p, {**calm, **both})]
        gap = self.definition.max_gap
        yield f"gap:{state}", [*way, (gap, calm), (gap + 1, calm)]
        yield f"clock:{state}", [*way, (-p, calm)]
        tries = [(None, _U), (None, _T)] if self.settings.reset else []
        for key, truth in [*tries, *((key, _F) for key in self.settings.observe if key == state)]:
            for given in self.made(key, truth):
                yield f"{_NAMES[truth]}:{key or 'reset'} in {state}", [*way, (p, given)]
        for claim in self.settings.evidence:
            if claim.hold and state == claim.states[0]:
                yield f"claim:{claim.id}", self.until(way, claim.id, claim.hold, calm)

    def guards(self, ways: Mapping[str, Steps]) -> Iterator[tuple[str, Steps]]:
        """Yield inputs of each condition at its limits and of wrong types, from one state."""
        for key, drawn in self.drawn.items():
            rows = [(self.period, {**self.calm, **of}) for of in drawn]
            false = [row for row in rows if self.truth(key, row[1]) == _F]
            sources = [each.source for each in self.machine.transitions if key in each.triggers]
            for way in [ways[of] for of in sources if of in ways][:1]:
                for steps in (false, *([row] for row in rows if row not in false)):
                    yield f"guard:{key.text}", [*way, *steps]


def state_machine_vectors(
    machine: StateMachine,
    settings: Settings,
    inputs: Sequence[BoundInput],
    about: Mapping[str, str],
) -> str:
    """Return the content of ``vectors.json``, empty where it would be too much."""
    if len(inputs) > vectors.MOST_INPUTS or len(machine.states) > _MOST_STATES:
        return ""
    rows = _Vectors(machine, settings, inputs).lines(inputs)
    return vectors.fitting_file(about, inputs, rows, complete=True)

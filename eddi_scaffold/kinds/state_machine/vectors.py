"""Test vectors of a state machine, by its definition: the set of states in which it may be."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from itertools import islice, product
from typing import TYPE_CHECKING, Any, NamedTuple

from eddi_scaffold.common.identifiers import attribute, free_name
from eddi_scaffold.conditions.definition import History, Sample, sample_of
from eddi_scaffold.evidence.vectors import MOST_BYTES, Run, Step, age_row, text, vectors_file

if TYPE_CHECKING:
    from eddi_scaffold.kinds.state_machine.machine import StateMachine, Transition, Trigger
    from eddi_scaffold.kinds.state_machine.options import Settings
    from eddi_scaffold.program.input_expressions import BoundInput
    from eddi_scaffold.program.instructions import Program, Read

_F, _U, _T = range(3)
_TRUTHS = (False, None, True)
_MOST_STEPS, _MOST_CASES, _MOST_INPUTS, _MOST_STATES = 200, 1000, 60, 200
_NO_JSON = {"nan": math.nan, "inf": math.inf, "object": object()}
_WRONG = tuple({"is": name} for name in (*_NO_JSON, "absent"))
_FIELDS = ("state", "moment", "kind", "text", "target", "priority")
Due = tuple[tuple[Any, ...], ...]  # actions with the names of `_FIELDS`
Stay = tuple[float, float, Due]  # entered between these times, and what is not performed yet
Given = Mapping[str, Any]  # input -> value, as in the file
Steps = list[tuple[Any, ...]]  # ns, truths that are wanted, perhaps inputs


class _CutError(Exception):
    """A run ends before a step that cannot be, or would be too much."""


class Definition:
    """One system of which each possible state is followed on each way."""

    def __init__(
        self, machine: StateMachine, settings: Settings, inputs: Sequence[BoundInput]
    ) -> None:
        self.machine, self.settings = machine, settings
        self.factors = {input_.id: input_.factor or (1, 1) for input_ in inputs}
        gap = max(1.0, 2.5 / settings.rate) if settings.max_gap is None else settings.max_gap
        self.max_gap = round(gap * 1e9)
        pairs: list[Any] = [*zip(machine.triggers, settings.values, strict=True)]
        of_reset = [] if settings.reset is None else [(None, settings.reset)]
        asked = dict([*pairs, *of_reset])
        self.conditions: dict[Any, Program] = {
            **{key: of.condition for key, of in asked.items() if of.condition is not None},
            **settings.observe,
        }
        self.orders = {key: of.input for key, of in asked.items() if of.input}
        self.reads: dict[str, Read] = {
            read.name: read for of in self.conditions.values() for read in of.reads
        }
        self.raises = {key.text: key for key, of in pairs if of.is_raised}
        self.absent = {key for key, of in pairs if of.is_absent}
        self.limited = {of.id for of in inputs if isinstance(of.max_age, int | float)}
        self.sporadic = {*self.orders.values()} - self.limited  # those that need never come
        self.samples: list[Sample] = []
        self.came: set[str] = set()
        self.settled: set[Any] = set()  # conditions that have been known, or were wrong
        begun = _U if settings.start == "unknown" else _F
        self.held = {of: begun for of in machine.triggers if of.is_persistent}
        self.raised: dict[Any, int] = {}  # trigger -> its value by the actions of the last step
        self.possible: dict[str, Stay] = {}
        self.good_since: dict[str, int] = {}

    def step(self, t: int, given: Given) -> dict[str, Any]:
        """Return the results."""
        last = self.samples[-1].t if self.samples else t
        self.samples.append(Sample(t, {k: self.raw(k, value) for k, value in given.items()}, {}))
        self.touched = set[tuple[Any, ...]]()
        states = self.machine.state
        anywhere: dict[str, Stay] = dict.fromkeys(states, (-math.inf, t, ()))
        initial: dict[str, Stay] = {of: (t, t, ()) for of in states if states[of].is_initial}
        if len(self.samples) == 1:
            self.possible = dict(initial if self.settings.start == "initial" else anywhere)
        if not 0 <= t - last <= self.max_gap:
            self.settled |= {*self.conditions, *self.orders}
        if t < last:
            self.possible = {of: (-math.inf, t, due) for of, (_, _, due) in self.possible.items()}
        elif t - last > self.max_gap:
            self.held = {of: max(held, _U) for of, held in self.held.items()}
            self.raised = dict.fromkeys(self.raised, _U)
            self.values: dict[Any, int] = dict.fromkeys(self.machine.triggers, _U)
            self._move(last, t, missed=True)
            self.good_since = {}
        self.values = values = self._read()
        reset = values.get(None, _F)
        values |= {key: _F for key in self.absent if values[key] == _U}
        for key, held in self.held.items():
            values[key] = self.held[key] = max(values[key], min(held, _T - reset))
        kept = {} if reset == _T else self.possible
        if reset != _F:
            self.possible = {**kept, **{of: _met(now, kept.get(of)) for of, now in initial.items()}}
        self._move(t, t)
        allowed = [of for of in states if values.get(of, _T) != _F]
        occupied = {of: self.possible[of] for of in allowed if of in self.possible}
        withheld = self.waiting or t < last or not occupied
        self.possible = occupied or {of: anywhere[of] for of in allowed or states}
        first, *others = [due for _, _, due in self.possible.values()]
        done = tuple(row for row in first if all(row in due for due in others))
        done = () if self.livelock else done
        for of, (low, high, due) in self.possible.items():
            self.possible[of] = low, high, tuple(row for row in due if row not in done)
        maybe = sorted(self.touched - {*done})
        events = {action.text for action in self.machine.actions() if action.is_event}
        self.raised = {
            self.raises[row[3]]: truth
            for rows, truth in ((maybe, _U), (done, _T))
            for row in rows
            if row[2] == "warning" and row[3] in events & self.raises.keys()
        }
        shown = [dict(zip((*_FIELDS, "certain"), (*row, True), strict=True)) for row in done]
        shown += [dict(zip((*_FIELDS, "certain"), (*row, False), strict=True)) for row in maybe]
        return {"raised": shown, **self._claims(t, withheld=withheld)}

    def _claims(self, t: int, *, withheld: bool) -> dict[str, Any]:
        possible, raws = {*self.possible}, self.samples[-1].values

        def verdict(*inside: str) -> int:
            return _T if possible <= {*inside} else _U if possible & {*inside} else _F

        results: dict[str, Any] = {"state": " or ".join(self.possible)}
        results["unknown_inputs"] = [name for name in raws if not self._is_usable(name, raws)]
        results["failed"] = _TRUTHS[max(verdict(*self.machine.fail), _U if withheld else _F)]
        results |= {of: _TRUTHS[_U if withheld else verdict(of)] for of in self.machine.state}
        for of in self.settings.evidence:
            good = not withheld and possible <= {*of.states}
            begun = self.good_since.pop(of.id, t)
            self.good_since |= {of.id: begun} if good else {}
            results[of.id] = good and t - begun >= round(of.hold * 1e9)
        return results

    def raw(self, name: str, value: Any) -> Any:
        """Return the value of an input in the unit of the model."""
        value = _NO_JSON.get(value["is"]) if isinstance(value, dict) else value
        num, den = self.factors[name]
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        return value * num / den if is_number and num != den else value

    def _is_usable(self, name: str, raws: Given) -> bool:
        if raws[name] is None:
            return name in self.sporadic and name not in self.came
        return name not in self.reads or sample_of(self.reads[name], raws) is not None

    def _read(self) -> dict[Any, int]:
        """Return the truths; what is not known since the start is FALSE, and nothing is claimed."""
        raws, self.waiting = self.samples[-1].values, False
        self.came |= {name for name, raw in raws.items() if raw is not None}
        values: dict[Any, int] = {of: self.raised.get(of, _F) for of in self.raises.values()}
        for key in {**self.conditions, **self.orders}:
            if key in self.orders:
                names = {self.orders[key]}
                rows = raws[self.orders[key]] if names <= self.came else []
                rows = rows if isinstance(rows, list) else [rows]
                truths = [_TRUTHS.index(row) if isinstance(row, bool) else _U for row in rows]
                value = max(truths, default=_F)
            else:
                names = {read.name for read in self.conditions[key].reads}
                value = _TRUTHS.index(History(self.conditions[key], self.samples).results()[-1][0])
            wrong = any(name in self.came and not self._is_usable(name, raws) for name in names)
            never, is_once = names - self.came, self._is_once(key)
            if wrong or (value != _U and not never):
                self.settled.add(key)
            early = value == _U and not wrong and bool(never or key not in self.settled)
            late = bool(never & self.limited if is_once else never)
            is_order = key is None and key in self.orders
            if key in self.settings.observe or is_order:
                early, late = early and is_order, False
            elif self.settings.start == "unknown" and (late or not is_once):
                early = late = False
            values[key] = _F if early else value
            self.waiting |= late or (early and not is_once and not is_order)
        return values

    def _is_once(self, key: Any) -> bool:
        """Return whether a trigger counts in one step, for the first hop."""
        return getattr(key, "is_external", False) or key in self.raises.values()

    def _move(self, low: int, high: int, *, missed: bool = False) -> None:
        """Follow each possible state until nothing fires."""
        begun, self.between, self.missed = self.possible, (low, high), missed
        self.possible, self.ways, self.livelock = {}, 0, False
        for state in self.machine.state:
            if state in begun:
                self._walk(state, begun[state], {state: _T})
        self.possible = {of: self.possible[of] for of in self.machine.state if of in self.possible}

    def _walk(self, state: str, stay: Stay, way: Mapping[str, int]) -> None:
        """Go on from a state; ``way``: those passed, each with the verdict of what led there."""
        self.ways += 1
        if self.ways > _MOST_CASES:
            raise _CutError
        for transition in self.machine.leaving[state]:
            verdict, target = self._fires(transition, *stay[:2], len(way) == 1), transition.target
            if verdict == _F:
                continue
            due = self._hop(stay[2], state, target)
            if target == state:  # ends the move
                self._end(state, (*self.between, due))
            elif target in way:  # all of the circle is possible
                circle = [*way][[*way].index(target) :]
                self.livelock |= verdict == _T and all(way[of] == _T for of in circle[1:])
                for of, then in zip(circle, [*circle[1:], target], strict=True):
                    self._end(of, (*self.between, due))
                    due = self._hop(due, of, then)
            else:
                self._walk(target, (*self.between, due), {**way, target: verdict})
            if verdict == _T:
                return
        self._end(state, stay)

    def _end(self, state: str, stay: Stay) -> None:
        self.possible[state] = _met(stay, self.possible.get(state))

    def _hop(self, due: Due, state: str, target: str) -> Due:
        """Return what is due after a transition: each action once, at its latest place."""
        ends = self.machine.state
        rows = [_row(state, "exit", action) for action in ends[state].exit]
        rows += [_row(target, "entry", action) for action in ends[target].entry]
        self.touched.update(rows)
        return (*(row for row in due if row not in rows), *rows)

    def _fires(self, transition: Transition, low: float, high: float, is_first: bool) -> int:
        lasts = is_first or self.missed
        counts = [
            of for of in transition.triggers if lasts or of.is_persistent or not self._is_once(of)
        ]
        verdict, now = max((self.values[of] for of in counts), default=_F), self.between[1]
        if transition.after is not None:
            after = round(transition.after * 1e9)
            over = _T if now - high >= after else _F if now - low < after else _U
            verdict = min(verdict, over) if transition.triggers else over
        return min(verdict, _U) if self.missed else verdict


def _met(stay: Stay, other: Stay | None) -> Stay:
    low, high, due = other or stay
    return min(stay[0], low), max(stay[1], high), tuple(row for row in due if row in stay[2])


def _row(state: str, moment: str, action: Any) -> tuple[Any, ...]:
    target, is_call, _ = action.text.partition("=")
    target = (target if is_call else "") if action.kind == "function" else action.source
    return (state, moment, action.kind, action.text, target, action.priority)


class _Plan(NamedTuple):
    """How a run goes on from a state."""

    name: str
    state: str  # empty: it begins there
    steps: Steps
    since: str = ""  # the first time counts from when this is so
    is_settled: bool = False  # windows are full before
    is_brief: bool = False  # only states count


class _Play:
    """A run in the making."""

    def __init__(self, definition: Definition, plan: _Plan, longest: int) -> None:
        self.definition, self.longest, self.t = definition, longest, 0
        self.plan, self.is_gap = plan, plan.name.startswith("gap:")
        self.given: dict[str, Any] = dict.fromkeys(definition.factors)
        self.results: dict[str, Any] = {}
        self.steps: list[Any] = []

    def step(self, wait: int, given: Given) -> None:
        """Add steps as close as windows need, the last one with other inputs."""
        while wait > self.longest and not (self.is_gap and self.steps):
            self.step(self.longest, given if not self.steps else self.given)
            wait -= self.longest
        of = self.definition
        if len(of.samples) == _MOST_STEPS:
            raise _CutError
        silent = {name for name in of.sporadic if given[name] == [] and name not in of.came}
        given = {**given, **dict.fromkeys(silent)}
        results = of.step(self.t + wait, given) if wait else {"raised": []}
        if wait and self.plan.state and (self.definition.waiting or self.plan.is_brief):
            names = ("state", "unknown_inputs", *([] if self.plan.is_brief else ["raised"]))
            results = {name: results[name] for name in names}
        changes = [
            {key: of for key, of in new.items() if repr(of) != repr(before.get(key, "nothing"))}
            for new, before in ((given, self.given), (results, self.results))
        ]
        self.t += wait
        self.given |= given
        self.results |= results
        if any(changes) or not wait:
            self.steps.append(Step(self.t, *changes))
        elif self.steps[-1][1:] == (wait,):
            self.steps[-1] = (self.t, wait)
        else:  # steps until then in which nothing changes
            self.steps.append((self.t, wait))


class _Player:
    """Chooses what runs are given."""

    def __init__(self, *parts: Any) -> None:
        self.parts, self.machine, self.settings = parts, parts[0], parts[1]
        self.definition = of = Definition(*parts)
        self.period = round(1e9 / self.settings.rate)
        self.longest = min(5 * self.period // 2, of.max_gap)
        self.needs = {
            key: [read.name for read in of.conditions[key].reads] for key in of.conditions
        }
        self.windows = {
            key: [(row.window, row.op) for row in program.operations if row.window]
            for key, program in of.conditions.items()
        }
        limits = {name: self._limits(name, *of.conditions) for name in of.reads}
        self.domain = {name: [*self._domain(*limits[name])] for name in of.reads}
        self.missed: set[str] = (
            set()
        )  # runs of which the state is not reached, though there is a way
        self.spoilt: set[str] = set()  # inputs that had a value of a wrong type
        self.wanted = {key: _T if key in self.settings.observe else _F for key in of.conditions}
        nothing = {name: list[Any]() for name in of.orders.values()}
        self.calm: dict[str, Any] = dict.fromkeys(of.factors) | nothing
        self.calm |= {key: values[0] for key, values in self.domain.items()}
        for key, truth in self.wanted.items():
            self.calm |= self.search({key: truth}) or {}

    def _limits(self, name: str, *keys: Any) -> list[float]:
        """Return the constants that an input may be compared with, in its own unit."""
        num, den = self.definition.factors[name]
        programs = [self.definition.conditions[key] for key in keys if name in self.needs[key]]
        rows = [row for of in programs for row in of.operations if row.op == "number"]
        known = {Fraction(row.value) for row in rows if row.value is not None}
        is_number = self.definition.reads[name].type == "number"
        return sorted({float(of * den / num) for of in known} or {0.0}) if is_number else []

    def _domain(self, *limits: float) -> Iterator[Any]:
        """Yield values of an input from which each of its comparisons has all its results."""
        if not limits:
            yield from (False, True)
            return
        yield limits[0] - 1.0
        for low, high in zip(limits, [*limits[1:], limits[-1] + 2.0], strict=True):
            yield from (low, low / 2 + high / 2)

    def truth(self, key: Any, given: Given) -> int:
        """Return the truth of a condition of inputs that were at rest, and then do not change."""
        program = self.definition.conditions[key]._replace(period=1 << 61)
        raws = [
            {name: self.definition.raw(name, row[name]) for name in self.needs[key]}
            for row in (self.calm, given)
        ]
        samples = [Sample(k << 60, row, {}) for k, row in enumerate(raws)]
        return _TRUTHS.index(History(program, samples).results()[-1][0])

    def cases(self, *keys: Any) -> Iterator[dict[str, Any]]:
        """Yield all inputs of conditions, with the others at rest."""
        names = dict.fromkeys(name for key in keys for name in self.needs[key])
        values = product(*([*self.domain[name], None] for name in names))
        for row in islice(values, _MOST_CASES):
            yield {**self.calm, **dict(zip(names, row, strict=True))}

    def search(self, wanted: Mapping[Any, int]) -> dict[str, Any] | None:
        """Return inputs with which conditions have these truths, and others as at rest."""
        want, best = {**self.wanted, **wanted}, None
        for given in self.cases(*wanted):
            wrong = [key for key, truth in want.items() if self.truth(key, given) != truth]
            if wanted.keys().isdisjoint(wrong) and (best is None or len(wrong) < best[0]):
                best = len(wrong), given
        return best and best[1]

    def made(self, wants: Mapping[Any, int]) -> dict[str, Any]:
        """Return inputs with which triggers have a truth; what is raised needs none."""
        of, rows = self.definition, (list[Any](), [None], [True])
        orders = {of.orders[key]: rows[truth] for key, truth in wants.items() if key in of.orders}
        given = self.search({key: truth for key, truth in wants.items() if key in of.conditions})
        if given is None:
            raise _CutError
        return {**given, **orders}

    def ages(self, inputs: Sequence[BoundInput]) -> Iterator[list[object]]:
        """Yield the row of each input with an age limit and a source of its own."""
        for input_ in inputs:
            keys = [key for key, needs in self.needs.items() if input_.id in needs]
            orders = dict.fromkeys(self.definition.orders.values(), False)
            given = {**(self.search(dict.fromkeys(keys[:1], _T)) or self.calm), **orders}
            others = [set(other.requires) for other in inputs if other is not input_]
            with suppress(_CutError):
                late = {**given, input_.id: _WRONG[0]}
                results = [Definition(*self.parts).step(0, of) for of in (given, late)]
                row = age_row(input_, given, *results)
                if row and all(other.isdisjoint(input_.requires) for other in others):
                    yield row

    def reach(self, play: _Play, plan: _Plan) -> None:
        """Bring a run into a state."""
        of = play.definition
        if not plan.state:
            return
        play.step(self.period, self.calm)
        while plan.is_settled and of.waiting:
            play.step(self.longest, self.calm)
        if len(of.possible) > 1 and self.settings.reset is not None:
            play.step(self.period, self.made({None: _T}))
        ways: dict[str, list[Transition]] = {state: [] for state in of.possible}
        for source in (open_ := [*ways]):
            for each in self.machine.leaving[source]:
                can_fire = each.triggers or each.after is not None
                if can_fire and each.target not in ways:
                    ways[each.target] = [*ways[source], each]
                    open_.append(each.target)
        if plan.state in ways:
            self.missed.add(plan.name)
        for each in ways.get(plan.state, []):
            if each.after is not None:
                over = of.possible[each.source][1] + round(each.after * 1e9)
                play.step(max(int(over) - play.t, self.period), self.calm)
            keys = sorted(
                each.triggers, key=lambda key: sum(w for w, _ in self.windows.get(key, ()))
            )
            play.step(self.period, given := self.made(dict.fromkeys(keys[:1], _T)))
            while [*of.possible] == [each.source] != [each.target]:
                play.step(self.longest, given)
        if [*of.possible] != [plan.state] and self.settings.start == "initial":
            raise _CutError  # else it is one of those where it may be
        self.missed.discard(plan.name)

    def run(self, plan: _Plan) -> Run | None:
        """Return the run, ``None`` where its state is not reached."""
        play, reached = _Play(Definition(*self.parts), plan, self.longest), 0
        try:
            self.reach(play, plan)
            reached = len(play.steps) + 1
            begun = play.definition.good_since | {
                of: int(stay[1])
                for of, stay in play.definition.possible.items()
                if plan.since == of
            }
            for wait, wants, *given in plan.steps:
                late = begun.pop(plan.since, play.t) - play.t
                play.step(wait + late, {**self.made(wants), **(given[0] if given else {})})
        except _CutError:
            return Run(plan.name, play.steps) if len(play.steps) >= reached > 0 else None
        return Run(plan.name, play.steps)

    def guards(self, trigger: Trigger) -> Iterator[tuple[str, dict[str, Any]]]:
        """Yield inputs where one decides (MC/DC), at each limit of it and of a wrong type."""
        for name in self.needs.get(trigger, ()):
            changes = (
                given
                for given in self.cases(trigger)
                if self.truth(trigger, given) == _T
                for value in self.domain[name]
                if self.truth(trigger, {**given, name: value}) == _F
            )
            case, limits = next(changes, None), self._limits(name, trigger)
            near = [math.nextafter(of, to) for of in limits for to in (-math.inf, math.inf)]
            values = [*limits, *near] or self.domain[name]
            wrong = [*_WRONG, "1", True if limits else 1][: 1 if name in self.spoilt else None]
            for value in [None, *values, *wrong] if case else ():
                self.spoilt.add(name)
                yield f"{name} = {text(value)}", {**(case or {}), name: value}

    def plans(self) -> Iterator[_Plan]:
        """Yield what is tried, the most telling first."""
        of, p, settings, leaving = self.definition, self.period, self.settings, self.machine.leaving
        rows = [each for state in leaving for each in leaving[state]]
        names = {each: f"{self.machine.called[each]} of line {each.place.line}" for each in rows}
        stays = {
            trigger: [p, *[w for w, op in self.windows.get(trigger, ()) if op != "once"][:1]]
            for trigger in self.machine.triggers
        }
        for each in rows:
            name, state, one = names[each], each.source, dict.fromkeys(each.triggers[:1], _T)
            for key, (kind, truth) in product(each.triggers, (("taken", _T), ("unknown", _U))):
                steps = [*((wait, {key: truth}) for wait in stays[key]), (p, {}), (0, {})]
                yield _Plan(f"{kind}:{name}, {key.text}", state, steps)
            if each.after is not None:
                over = round(each.after * 1e9)
                yield _Plan(f"timeout:{name}", state, [(over - 1, one), (1, one)], state)
            for other in leaving[state][leaving[state].index(each) + 1 :]:
                both = one | dict.fromkeys(other.triggers[:1], _T)
                yield _Plan(f"precedence:{name}, {names[other]}", state, [(p, both), (p, {})])
        for claim in settings.evidence:
            held: Steps = [(round(claim.hold * 1e9) - 1, {}), (1, {})]
            yield _Plan(f"claim:{claim.id}", claim.states[0], held, claim.id, is_settled=True)
        for state in leaving:
            gaps: Steps = [(of.max_gap, {}), (of.max_gap + 1, {})]
            yield _Plan(f"gap:{of.max_gap} ns in {state}", state, gaps)
            yield _Plan(f"clock:back in {state}", state, [(-p, {}), (p, {})])
            if settings.reset is not None:
                yield _Plan(f"reset:in {state}", state, [(p, {None: _U}), (p, {None: _T}), (p, {})])
            if state in settings.observe:
                yield _Plan(f"observed:not {state}", state, [(p, {state: _F}), (p, {})])
        for width in sorted({width for rows in self.windows.values() for width, _ in rows}):
            steps = [(p, {}), (width - p - 1, {}), (1, {})]
            yield _Plan(f"window:{width} ns is full", "", steps)
            gaps = [(wait, {}) for wait in (p, 0, self.longest, self.longest + 1, p)]
            yield _Plan(f"gap:of window {width} ns", next(iter(leaving)), gaps, is_settled=True)
        for key in dict.fromkeys(key for each in rows for key in each.triggers):
            each = next(each for each in rows if key in each.triggers)
            back = [
                key
                for way in leaving[each.target]
                if way.target == each.source
                for key in way.triggers
            ]
            ends = dict.fromkeys(back[:1] if settings.reset is None else [None], _T)
            for width, early, truth in product(dict(self.windows.get(key, ())), (1, 0), (_T, _U)):
                steps = [(p, {key: truth}), (p, {}), (width - p - early, ends), (1, {})]
                yield _Plan(f"window:{names[each]}, {key.text}", each.source, steps)
            for shown, given in self.guards(key):
                tries: Steps = [(wait, {}, given) for wait in stays[key]]
                if shown.endswith(("null", '"nan"}')):  # not known from the start on, or wrong
                    longest = [w for rows in self.windows.values() for w, _ in rows] or [p]
                    late = [(p, {}, given), (max(longest), {}, given), (p, {})]
                    yield _Plan(f"start:{key.text}, {shown}", "", late)
                is_full = bool(self.windows[key]) and self.truth(key, given) == _F
                name = f"guard:{names[each]}, {shown}"
                is_brief = '"nan"' not in shown
                yield _Plan(name, each.source, tries, "", is_full, is_brief)


def state_machine_vectors(
    machine: StateMachine,
    settings: Settings,
    inputs: Sequence[BoundInput],
    about: Mapping[str, str],
) -> str:
    """Return the content of ``vectors.json``, empty where it would be too much."""
    if len(inputs) > _MOST_INPUTS or len(machine.states) > _MOST_STATES:
        return ""
    player = _Player(machine, settings, inputs)
    lists: dict[str, list[Any]] = {
        "tables": [("actions", _actions(player.definition))],
        "ages": [*player.ages(inputs)],
        "runs": [],
    }
    size = len(vectors_file(about, inputs, lists, complete=False))
    for run in filter(None, map(player.run, player.plans())):
        size += len(text(run).encode()) + 4
        if size > MOST_BYTES:
            break
        lists["runs"].append(run)
    complete = not player.missed and size <= MOST_BYTES
    return vectors_file(about, inputs, lists, complete=complete) if lists["runs"] else ""


def _actions(of: Definition) -> list[list[Any]]:
    """Return the actions as the monitor has them, with what they raise and their methods."""
    methods: dict[str, str] = {}
    rows: list[list[Any]] = []
    for action in of.machine.actions():
        is_function, name = action.kind == "function", re.sub(r"[^A-Za-z0-9]+", "_", action.text)
        if is_function and action.text not in methods:
            name = f"action_{attribute(name.strip('_'))}"
            methods[action.text] = free_name(name, methods.values())
        key = of.raises.get(action.text) if action.is_event else None
        raised = -1 if key is None else of.machine.triggers.index(key)
        rows.append(
            [*_row("", "", action)[2:], raised, methods[action.text] if is_function else ""]
        )
    return rows

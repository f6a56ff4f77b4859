"""Test vectors of a reliability model, of which each result follows from the definitions.

Where an input was unknown they say whether a result is valid and what is active, no numbers.
Propulsion, processors, heat, missions with an end, gates of other types and large models have none.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from decimal import Context, localcontext
from itertools import pairwise
from operator import mul
from typing import TYPE_CHECKING, Any

from eddi_scaffold.evidence.emitted import UnprovedError
from eddi_scaffold.evidence.sums import variables
from eddi_scaffold.evidence.vectors import (
    Judge,
    Run,
    Step,
    TooMuchError,
    age_rows,
    changed,
    fitting_file,
    merged,
)
from eddi_scaffold.kinds.reliability import exact
from eddi_scaffold.kinds.reliability.exact import D
from eddi_scaffold.kinds.reliability.system import (
    Chain,
    ComponentModel,
    FaultTree,
    ReliabilitySystem,
    input_id,
)

if TYPE_CHECKING:
    from eddi_scaffold.kinds import ModelInput
    from eddi_scaffold.program.input_expressions import BoundInput

Values = Mapping[str, Any]
Known = Mapping[str, D | None]  # model -> the probability that it fails
Pattern = Mapping[str, tuple[Any, Any]]  # input -> its value as it is given, and as it is believed
Steps = Sequence[tuple[int, Pattern]]  # with times in nanoseconds
_PATTERNS, _MOST_TERMS, _MOST_STEPS = 81, 1_024, 2_000
_LATE = 36_000 * 10**9
_HOUR = D(3_600_000_000_000)
_UNKNOWN = None, None
_LEFT_OUT = ("propulsion", "processor")
_WRONG: Sequence[Any] = (*({"is": of} for of in ("nan", "inf", "object", "absent")), "x", [], None)


class _Mission:
    """The models of a system from the start of a mission on."""

    def __init__(self, system: ReliabilitySystem) -> None:
        self.models, self.horizon = system.used_models(), D(system.horizon)
        self.memory: dict[str, Any] = {}
        self.passed = self.age = D(0)  # hours since the last step, and since the start
        self.is_consistent = True
        if any(of.type in _LEFT_OUT or "t_ref" in of.values for of in self.models):
            raise TooMuchError

    def step(self, given: Values, passed: D) -> Known:
        """Return the probability that each model fails; ``None`` where it is not known."""
        self.passed, self.age, self.is_consistent = passed, self.age + passed, True
        known: dict[str, D | None] = {}
        for of in self.models:  # each behind those that it uses
            known[of.name] = getattr(self, f"_{of.type}")(of, given, known)
        return known

    def _ahead(self, chain: exact.Markov) -> Sequence[D]:
        return exact.after(chain, self.horizon, frozenset(chain.fail))

    def _series(self, model: ComponentModel, _: Values, known: Known) -> D | None:
        works = [1 - p for name in model.uses if (p := known[name]) is not None]
        return 1 - math.prod(works, start=D(1)) if len(works) == len(model.uses) else None

    def _k_out_of_n(self, model: ComponentModel, given: Values, _: Known) -> D | None:
        n, k = given[input_id(model.name, "available")], model.values["k"]
        works = (-D(model.values["rate"]) * self.horizon).exp()
        if n is None or n < k:
            return None if n is None else D(1)
        n = int(n)
        return sum((math.comb(n, i) * works**i * (1 - works) ** (n - i) for i in range(k)), D(0))

    def _battery(self, model: ComponentModel, given: Values, _: Known) -> D | None:
        level, repair = given[input_id(model.name, "level")], model.values.get("repair")
        band, missed = self.memory.get(model.name, (0, False))
        now = band if level is None else sum(level <= edge for edge in (75, 50, 25))
        is_vague = missed and now < band and not repair  # a rise is not believed
        if level is None:
            missed = band < 3
        elif now >= band or repair:
            band, missed = now, False
        self.memory[model.name] = band, missed
        ahead = self._ahead(exact.battery(model.values))
        return None if level is None or is_vague else ahead[2 * band]

    def _markov(self, model: ComponentModel, given: Values, _: Known) -> D | None:
        of, name = model.content, model.name
        assert isinstance(of, Chain)
        chain, number, states = exact.markov(of), of.states.index, range(len(of.states))
        told = [(number(seen.state), given[seen.input], seen.negated) for seen in of.observe]
        kept = {*states} - {state for state, value, negated in told if value is negated}
        ends = [frozenset({state}) for state in states]
        if name not in self.memory:
            start = number(of.initial[0])
            self.memory[name] = [exact.after(chain, D(of.age), end)[start] for end in ends]
        belief = self.memory[name]
        moved = belief and [
            sum(map(mul, belief, exact.after(chain, self.passed, end)), D(0)) * (state in kept)
            for state, end in enumerate(ends)
        ]
        is_missing = any(value is None for _, value, _ in told)
        has_failed = belief and not any(p for k, p in enumerate(belief) if k not in chain.fail)
        if told and has_failed and (of.repair or is_missing or not kept & {*chain.fail}):
            raise TooMuchError  # it works again, or may
        ahead = self._ahead(chain)
        if is_missing:
            belief = None
        elif moved and any(moved):
            belief = [p / sum(moved) for p in moved]
        elif moved or len(kept) == 1:
            self.is_consistent = not moved
            worst = max(kept or chain.fail, key=lambda state: (ahead[state], -state))
            belief = [D(state == worst) for state in states]
        else:
            raise TooMuchError  # what was missed still counts
        self.memory[name] = belief
        return belief and sum(map(mul, belief, ahead), D(0))

    def _fault_tree(self, model: ComponentModel, given: Values, known: Known) -> D | None:
        tree, name = model.content, model.name
        assert isinstance(tree, FaultTree)
        if name not in self.memory:
            events = {key: variables([exact.variable(tree, key)])[0] for key in tree.events}
            self.memory[name] = exact.structure(tree, events)
        terms, chances = self.memory[name], dict[str, D | None]()
        if len(terms) > _MOST_TERMS or tree.approximate:
            raise TooMuchError
        for key in tree.reached()[0]:
            if (event := tree.events.get(key)) is None or (law := event.law) is None:
                continue
            age = self.age + D(tree.age if event.age is None else event.age)
            start, end = age if event.observed else D(0), age + self.horizon
            p = known[law.model] if law.model else exact.chance(law, start, end)
            if event.observed:
                id_ = input_id(name, key)
                value = (not tree.repair and self.memory.get(id_)) or given[id_]
                self.memory[id_] = value
                p = None if value is None else D(1) if value else p
            chances[exact.variable(tree, key)] = p
        if None in chances.values():
            return None
        rows = (
            [D(number.numerator), *(chances[key] or D(0) for key in of)]
            for of, number in terms.items()
        )
        return sum((math.prod(row, start=D(1)) for row in rows), D(0))


class _Vectors:
    """Runs of a monitor."""

    def __init__(self, system: ReliabilitySystem, bound: Sequence[BoundInput]) -> None:
        self.system, self.steps = system, 0
        self.quantum_ns, self.gap_ns = round(system.quantum * 1e9), round(system.usual_gap * 1e9)
        about = {of.id: of for of in system.inputs()}
        units = (of for of in system.used_models() if of.type == "k_out_of_n")
        self.needed = {input_id(of.name, "available"): of.values["k"] for of in units}
        own = [of for of in bound if of.id in about]
        self.inputs = {of.id: self._values(about[of.id], of.factor) for of in own}
        self.base = {id_: known[0] for id_, (known, _) in self.inputs.items()}

    def _values(self, about: ModelInput, factor: tuple[int, int] | None) -> Sequence[list[Any]]:
        """Return values of an input that are known, the usual one first, and that are not."""
        usual: Any = about.sample
        wrong = [*_WRONG, 1 if about.type == "bool" else True]
        if about.type == "bool":
            known = [usual, not usual]
        elif about.id in self.needed:
            k = self.needed[about.id]
            known, wrong = [usual, k - 1, k, float(k), 0], [*wrong, 20_000, 2.5, -1]
        else:
            edges = [of for edge in (75.0, 50.0, 25.0) for of in (math.nextafter(edge, 100), edge)]
            known, wrong = [usual, *edges, 0.0, 60], [*wrong, 101.0, -1.0]
        pairs = [(of, of) for of in known]
        if factor is not None:  # rounding is not to decide at an edge
            pairs = [(of * 0.999 * factor[1] / factor[0], of * 0.999) for of in known]
        return pairs, [(of, None) for of in wrong]

    def run(self, name: str, steps: Steps) -> Run:
        """Return the steps with what comes out, up to one that is not known."""
        system, mission, run = self.system, _Mission(self.system), list[Step]()
        judges = [Judge(of.activate, of.release, of.hold) for of in system.thresholds]
        is_known = all(of is not None for _, pattern in steps for _, of in pattern.values())
        inputs, results = dict[str, Any](), dict[str, Any]()
        start = last = steps[0][0]
        for now, pattern in steps:
            quanta = (start - last) // self.quantum_ns - (start - now) // self.quantum_ns
            given = {id_: of for id_, (_, of) in pattern.items()}
            try:
                p = mission.step(given, quanta * self.quantum_ns / _HOUR)[system.top]
            except (TooMuchError, UnprovedError):
                break
            number = None if p is None else float(p)
            left = 1 - p if p is not None and 1 - p > D("1e-30") else D(0)  # the rest is rounding
            if any(of.is_near(number) for of in judges) or 0 < left < D("1e-6"):
                break  # rounding decides
            is_steady = mission.is_consistent and now - last <= self.gap_ns
            expected: dict[str, Any] = {"valid": is_steady and p is not None}
            for of, judge in zip(system.thresholds, judges, strict=True):
                if is_known or not system.worst_case:  # else bounds decide
                    expected[of.id] = judge.step(now, number if is_steady else None)
            if is_known and p is not None:
                keys = ("p_fail", "p_fail_low", "p_fail_high")
                expected |= dict.fromkeys(keys, float(f"{p:.12g}"))
                expected["reliability"] = float(f"{left:.12g}")
            raw = {id_: of for id_, (of, _) in pattern.items()}
            run.append(Step(now, changed(inputs, raw), changed(results, expected)))
            inputs, results, last = raw, expected, now
        self.steps += len(steps)
        return Run(name, run)

    def at_start(self, pattern: Pattern) -> Values | None:
        """Return the results of a first step, ``None`` where they are not known."""
        return next((step.results for step in self.run("", [(0, pattern)]).steps), None)

    def patterns(self) -> tuple[list[Pattern], bool]:
        """Return observations: all, or those that differ from the usual ones in one input."""
        values = self.inputs.items()
        columns = [[{id_: of} for of in (*known, _UNKNOWN)] for id_, (known, _) in values]
        is_all = math.prod(map(len, columns)) <= _PATTERNS
        rows = [*itertools.product(*columns)] if is_all else [[of] for row in columns for of in row]
        return [merged([self.base, *row]) for row in rows], is_all

    def runs(self, patterns: Sequence[Pattern]) -> Iterator[tuple[str, Steps]]:
        """Yield the name of each run and its steps."""
        base, q, gap = self.base, self.quantum_ns, self.gap_ns
        times = [0, 1, q, q + 1, q + 1 + gap, q + 2 + 2 * gap, q + 2 + 3 * gap, _LATE, _LATE + q]
        yield "time", [(now, base) for now in times]
        yield from (("start", [(0, pattern)]) for pattern in patterns)
        for id_, (known, wrong) in self.inputs.items():
            usual, other = known[:2]
            rows = {
                "value": [*known, usual],
                "wrong": [usual, *wrong],
                "missed": [usual, _UNKNOWN, usual, other, _UNKNOWN, usual],
            }
            for name, row in rows.items():
                yield f"{name}:{id_}", [(k * q, {**base, id_: of}) for k, of in enumerate(row)]
            later = [(now, {**base, id_: other}) for now in (58 * q, 58 * q + gap, _LATE)]
            yield f"later:{id_}", [(0, base), *later]
        starts = [(of, self.at_start(of) or {}) for of in patterns]
        chances = [(of, results["p_fail"]) for of, results in starts if "p_fail" in results]
        for threshold in self.system.thresholds:
            hold, ends = round(threshold.hold * 1e9), (-1, threshold.activate, threshold.release, 1)
            until = [*range(0, hold - 1, gap), hold - 1, hold] if hold else [0]
            if len(until) > _PATTERNS:
                raise TooMuchError
            good, band, bad = (
                [row for row, p in chances if low < p <= high][:1] for low, high in pairwise(ends)
            )
            kept = [(now, row) for row in good for now in until]
            falls = enumerate([*band, *good, *band, *bad, *band], hold + 1)
            again = [(hold + 6 + now, row) for now, row in kept]
            runs = [*kept, *falls, *again], [(now, row) for row in band for now in until]
            yield from ((f"threshold:{threshold.id}", steps) for steps in runs if steps)

    def lines(self, inputs: Sequence[BoundInput]) -> Iterator[Run | list[object]]:
        """Yield the lines of the file; raise an error at the end where some are missing."""
        patterns, is_all = self.patterns()
        for name, steps in self.runs(patterns):
            run = self.run(name, steps)
            is_all = is_all and len(run.steps) == len(steps)
            yield from [run] if run.steps else []
            if self.steps > _MOST_STEPS:
                raise TooMuchError

        def results(given: Values) -> Values | None:
            unknown = {id_: _UNKNOWN for id_, raw in given.items() if raw is None}
            return self.at_start({**self.base, **unknown})

        yield from age_rows(inputs, {id_: raw for id_, (raw, _) in self.base.items()}, results)
        if not is_all:
            raise TooMuchError


def system_vectors(
    system: ReliabilitySystem, inputs: Sequence[BoundInput], about: Mapping[str, str]
) -> str:
    """Return the content of ``vectors.json``; empty for a system that is not covered."""
    with localcontext(Context(prec=50)), suppress(TooMuchError, UnprovedError):
        if not system.mission_end:
            lines = _Vectors(system, inputs).lines(inputs)
            return fitting_file(about, inputs, lines, complete=True)
    return ""

"""Test vectors of a reliability model, of which each result follows from the definitions.

Nothing changes in a run; where an input is unknown only follows that the result is not valid. What
has none is for `verify`: propulsion, processors, heat, missions whose end is an input, chains that
are observed over time, repair, and what is missed.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from decimal import Context, localcontext
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
Pattern = Mapping[str, tuple[Any, Any]]  # input -> its value as it is given, and as it is believed
_PATTERNS, _MOST_TERMS, _MOST_RUNS = 81, 1_024, 1_000
_LATE = 36_000 * 10**9
_HOUR = D(3_600_000_000_000)
_UNKNOWN = None, None
_NUMBERS = ("p_fail", "p_fail_low", "p_fail_high")
_WRONG: Sequence[Any] = (*({"is": of} for of in ("nan", "inf", "object", "absent")), "x", [], None)


class _Definition:
    """The models of a system, of which nothing changed since the start of the mission."""

    def __init__(self, system: ReliabilitySystem, given: Values, age: D) -> None:
        self.given, self.age, self.horizon = given, age, D(system.horizon)  # hours
        self.known: dict[str, D | None] = {}  # model -> that it fails; None where it is not valid
        for model in system.used_models():  # each behind those that it uses
            self.known[model.name] = getattr(self, f"_{model.type}")(model)

    def _ahead(self, chain: exact.Markov) -> Sequence[D]:
        return exact.after(chain, self.horizon, frozenset(chain.fail))

    def _series(self, model: ComponentModel) -> D | None:
        works = [1 - p for name in model.uses if (p := self.known[name]) is not None]
        return 1 - math.prod(works, start=D(1)) if len(works) == len(model.uses) else None

    def _k_out_of_n(self, model: ComponentModel) -> D | None:
        n, k = self.given[input_id(model.name, "available")], model.values["k"]
        works = (-D(model.values["rate"]) * self.horizon).exp()
        if n is None or n < k:
            return None if n is None else D(1)
        n = int(n)
        return sum((math.comb(n, i) * works**i * (1 - works) ** (n - i) for i in range(k)), D(0))

    def _battery(self, model: ComponentModel) -> D | None:
        level = self.given[input_id(model.name, "level")]
        ahead = self._ahead(exact.battery(model.values))
        return None if level is None else ahead[2 * sum(level <= edge for edge in (75, 50, 25))]

    def _markov(self, model: ComponentModel) -> D | None:
        of = model.content
        assert isinstance(of, Chain)
        chain, number = exact.markov(of), of.states.index
        told = [(number(seen.state), self.given[seen.input], seen.negated) for seen in of.observe]
        excluded = {state for state, value, negated in told if value is negated}
        hours, start = D(of.age) + self.age, number(of.initial[0])
        belief = {
            state: exact.after(chain, hours, frozenset({state}))[start]
            for state in range(chain.size)
            if state not in excluded
        }
        if any(value is None for _, value, _ in told) or not any(belief.values()):
            return None  # not known, or inconsistent
        ahead = self._ahead(chain)
        failed = sum((p * ahead[state] for state, p in belief.items()), D(0))
        return failed / sum(belief.values())

    def _fault_tree(self, model: ComponentModel) -> D | None:
        tree, chances = model.content, dict[str, D | None]()
        assert isinstance(tree, FaultTree)
        names = {key: exact.variable(tree, key) for key in exact.leaves(tree)}
        terms = exact.structure(tree, {key: variables([of])[0] for key, of in names.items()})
        if len(terms) > _MOST_TERMS or tree.approximate:
            raise TooMuchError
        for key, name in names.items():
            if (event := tree.events.get(key)) is None:
                chain, until = exact.ordered(tree, key), D(tree.age) + self.age + self.horizon
                chances[name] = exact.after(chain, until, frozenset(chain.fail))[0]
                continue
            assert event.law is not None, "a checked tree has the law of each event"
            age = self.age + D(tree.age if event.age is None else event.age)
            start, end = age if event.observed else D(0), age + self.horizon
            law, value = (
                event.law,
                self.given[input_id(model.name, key)] if event.observed else False,
            )
            p = self.known[law.model] if law.model else exact.chance(law, start, end)
            chances[name] = None if value is None else D(1) if value else p
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
        self.system = system
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

    def run(self, name: str, pattern: Pattern, times: Sequence[int] = (0,)) -> Run:
        """Return steps in which nothing changes, with what comes out."""
        system, run, results, last = self.system, list[Step](), dict[str, Any](), 0
        judges = [Judge(of.activate, of.release, of.hold) for of in system.thresholds]
        given = {id_: of for id_, (_, of) in pattern.items()}
        raw = {id_: of for id_, (of, _) in pattern.items()}
        for now in times:
            hours = -(-now // self.quantum_ns) * self.quantum_ns / _HOUR
            try:
                p = _Definition(system, given, hours).known[system.top]
            except (TooMuchError, UnprovedError):
                break
            number = None if p is None else float(p)
            if any(of.is_near(number) for of in judges):
                break  # rounding decides
            is_steady = now - last <= self.gap_ns
            expected: dict[str, Any] = {"valid": is_steady and p is not None}
            for of, judge in zip(system.thresholds, judges, strict=True):
                if None not in given.values() or not system.worst_case:  # else bounds decide
                    expected[of.id] = judge.step(now, number if is_steady else None)
            if p is not None:
                expected |= dict.fromkeys(_NUMBERS, float(f"{p:.12g}"))
            run.append(Step(now, {} if run else raw, changed(results, expected)))
            results, last = expected, now
        return Run(name, run)

    def patterns(self) -> tuple[list[Pattern], bool]:
        """Return observations: all, or those that differ from the usual ones in one input."""
        values = self.inputs.items()
        columns = [[{id_: of} for of in (*known, _UNKNOWN)] for id_, (known, _) in values]
        is_all = math.prod(map(len, columns)) <= _PATTERNS
        rows = [*itertools.product(*columns)] if is_all else [[of] for row in columns for of in row]
        return [merged([self.base, *row]) for row in rows], is_all

    def lines(self, inputs: Sequence[BoundInput]) -> Iterator[Run | list[object]]:
        """Yield the lines of the file; raise an error at the end where some are missing."""
        base, q, gap = self.base, self.quantum_ns, self.gap_ns
        patterns, is_all = self.patterns()
        runs: list[tuple[Any, ...]] = [("start", pattern) for pattern in patterns]
        contents = [of.content for of in self.system.used_models()]
        if not any(isinstance(of, Chain) and of.observe for of in contents):
            times = [
                0,
                1,
                q,
                q + 1,
                q + 1 + gap,
                q + 2 + 2 * gap,
                q + 2 + 3 * gap,
                _LATE,
                _LATE + q,
            ]
            runs = [("time", pattern, times) for pattern in patterns[:3]] + runs
        for id_, (_, wrong) in self.inputs.items():
            runs += [(f"wrong:{id_}", {**base, id_: of}) for of in wrong]
        is_all = is_all and len(runs) <= _MOST_RUNS
        for row in runs[:_MOST_RUNS]:
            run = self.run(*row)
            is_all = is_all and len(run.steps) == len(row[2] if row[2:] else "0")
            yield from [run] if run.steps else []

        def results(given: Values) -> Values | None:
            unknown = {id_: _UNKNOWN for id_, raw in given.items() if raw is None}
            return next((step.results for step in self.run("", {**base, **unknown}).steps), None)

        yield from age_rows(inputs, {id_: raw for id_, (raw, _) in base.items()}, results)
        if not is_all:
            raise TooMuchError


def system_vectors(
    system: ReliabilitySystem, inputs: Sequence[BoundInput], about: Mapping[str, str]
) -> str:
    """Return the content of ``vectors.json``; empty for a system that is not covered."""
    with localcontext(Context(prec=50)), suppress(TooMuchError, UnprovedError):
        used = system.used_models()
        has_heat = any("t_ref" in of.values for of in used)  # of batteries, processors
        if not (system.mission_end or has_heat or any(of.type == "propulsion" for of in used)):
            lines = _Vectors(system, inputs).lines(inputs)
            return fitting_file(about, inputs, lines, complete=True)
    return ""

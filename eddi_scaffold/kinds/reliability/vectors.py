"""Test vectors of a reliability model, of which each result follows from the definitions.

They are those of the start of a mission; where an input is unknown, only that the result is not
valid. All else is for `verify`: propulsion, processors, heat, missions whose end is an input, time.
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
    Run,
    Step,
    TooMuchError,
    age_rows,
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
_UNKNOWN = None, None
_NUMBERS = ("p_fail", "p_fail_low", "p_fail_high")
_WRONG: Sequence[Any] = (*({"is": of} for of in ("nan", "inf", "object", "absent")), "x", [], None)


class _Definition:
    """The models of a system at the start of a mission."""

    def __init__(self, system: ReliabilitySystem, given: Values) -> None:
        self.given, self.horizon = given, D(system.horizon)  # hours
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
        start = number(of.initial[0])
        belief = {
            state: exact.after(chain, D(of.age), frozenset({state}))[start]
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
                chain, until = exact.ordered(tree, key), D(tree.age) + self.horizon
                chances[name] = exact.after(chain, until, frozenset(chain.fail))[0]
                continue
            assert event.law is not None, "a checked tree has the law of each event"
            age = D(tree.age if event.age is None else event.age)
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
    """First steps of a monitor."""

    def __init__(self, system: ReliabilitySystem, bound: Sequence[BoundInput]) -> None:
        self.system = system
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

    def results(self, pattern: Pattern) -> Values | None:
        """Return what comes out of a first step; ``None`` where it is not known."""
        given = {id_: of for id_, (_, of) in pattern.items()}
        try:
            p = _Definition(self.system, given).known[self.system.top]
        except (TooMuchError, UnprovedError):
            return None
        expected: dict[str, Any] = {"valid": p is not None}
        for of in self.system.thresholds:
            if p is None and not self.system.worst_case:  # else bounds decide
                expected[of.id] = False
            elif p is not None and not math.isclose(p, of.activate):  # else rounding decides
                expected[of.id] = p <= of.activate and not of.hold
        return expected if p is None else expected | dict.fromkeys(_NUMBERS, float(f"{p:.12g}"))

    def patterns(self) -> tuple[list[Pattern], bool]:
        """Return observations: all, or those that differ from the usual ones in one input."""
        values = self.inputs.items()
        columns = [[{id_: of} for of in (*known, _UNKNOWN)] for id_, (known, _) in values]
        is_all = math.prod(map(len, columns)) <= _PATTERNS
        rows = [*itertools.product(*columns)] if is_all else [[of] for row in columns for of in row]
        return [merged([self.base, *row]) for row in rows], is_all

    def lines(self, inputs: Sequence[BoundInput]) -> Iterator[Run | list[object]]:
        """Yield the lines of the file; raise an error at the end where some are missing."""
        patterns, is_all = self.patterns()
        rows = [("start", pattern) for pattern in patterns]
        for id_, (_, wrong) in self.inputs.items():
            rows += [(f"wrong:{id_}", {**self.base, id_: of}) for of in wrong]
        is_all = is_all and len(rows) <= _MOST_RUNS
        for name, pattern in rows[:_MOST_RUNS]:
            if (expected := self.results(pattern)) is None:
                is_all = False
            else:
                yield Run(
                    name, [Step(0, {id_: raw for id_, (raw, _) in pattern.items()}, expected)]
                )

        def results(given: Values) -> Values | None:
            unknown = {id_: _UNKNOWN for id_, raw in given.items() if raw is None}
            return self.results({**self.base, **unknown})

        yield from age_rows(inputs, {id_: raw for id_, (raw, _) in self.base.items()}, results)
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

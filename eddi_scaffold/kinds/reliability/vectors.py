"""Test vectors of a reliability model, of which each result follows from the definitions.

They are those of the start of a mission; where an input is unknown, only that the result is not
valid. All else is for `verify`: propulsion, processors, heat, missions whose end is an input, time.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from decimal import Context, localcontext
from functools import reduce
from operator import or_
from typing import TYPE_CHECKING, Any

from eddi_scaffold.evidence.emitted import UnprovedError
from eddi_scaffold.evidence.vectors import (
    Run,
    Step,
    TooMuchError,
    age_rows,
    fitting_file,
)
from eddi_scaffold.kinds.reliability import exact
from eddi_scaffold.kinds.reliability.exact import D
from eddi_scaffold.kinds.reliability.sums import variables
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


def _known(
    about: ModelInput, needed: Mapping[str, int], factor: tuple[int, int] | None
) -> list[tuple[Any, Any]]:
    """Return values of an input, the usual one first, as given and as believed."""
    usual: Any = about.sample
    if about.type == "bool":
        return [(usual, usual), (not usual, not usual)]
    edges = [of for edge in (75.0, 50.0, 25.0) for of in (math.nextafter(edge, 100), edge)]
    if about.id in needed:
        edges = [needed[about.id] - 1, needed[about.id]]
    rest = 1 if factor is None else 0.999  # rounding is not to decide at an edge
    number, divisor = factor or (1, 1)
    return [(of * rest * divisor / number, of * rest) for of in (usual, *edges, 0)]


def _results(system: ReliabilitySystem, pattern: Pattern) -> Values | None:
    """Return what comes out of a first step; ``None`` where it is not known."""
    try:
        p = _Definition(system, {id_: of for id_, (_, of) in pattern.items()}).known[system.top]
    except (TooMuchError, UnprovedError):
        return None
    expected: dict[str, Any] = {"valid": p is not None}
    for of in system.thresholds:
        if p is None and not system.worst_case:  # else bounds decide
            expected[of.id] = False
        elif p is not None and not math.isclose(p, of.activate):  # else rounding decides
            expected[of.id] = p <= of.activate and not of.hold
    return expected if p is None else expected | dict.fromkeys(_NUMBERS, float(f"{p:.12g}"))


def system_vectors(
    system: ReliabilitySystem, inputs: Sequence[BoundInput], about: Mapping[str, str]
) -> str:
    """Return the content of ``vectors.json``; empty for a system that is not covered."""
    used, own = system.used_models(), {of.id: of for of in system.inputs()}
    has_heat = any("t_ref" in of.values for of in used)  # of batteries, processors
    if system.mission_end or has_heat or any(of.type == "propulsion" for of in used):
        return ""
    units = (of for of in used if of.type == "k_out_of_n")
    needed = {input_id(of.name, "available"): of.values["k"] for of in units}
    known = {of.id: _known(own[of.id], needed, of.factor) for of in inputs if of.id in own}
    base: dict[str, tuple[Any, Any]] = {id_: values[0] for id_, values in known.items()}
    columns = [[{id_: of} for of in (*values, _UNKNOWN)] for id_, values in known.items()]
    is_all = math.prod(map(len, columns)) <= _PATTERNS
    rows = itertools.product(*columns) if is_all else ([of] for row in columns for of in row)
    patterns = [("start", reduce(or_, row, base)) for row in rows]
    patterns += [(f"wrong:{id_}", {**base, id_: (of, None)}) for id_ in base for of in _WRONG]

    def results(given: Values) -> Values | None:
        pairs = {id_: _UNKNOWN if raw is None else base[id_] for id_, raw in given.items()}
        return _results(system, pairs)

    def lines() -> Iterator[Run | list[object]]:
        is_complete = is_all and len(patterns) <= _MOST_RUNS
        for name, pattern in patterns[:_MOST_RUNS]:
            expected = _results(system, pattern)
            is_complete = is_complete and expected is not None
            raws = {id_: raw for id_, (raw, _) in pattern.items()}
            yield from [] if expected is None else [Run(name, [Step(0, raws, expected)])]
        yield from age_rows(inputs, {id_: raw for id_, (raw, _) in base.items()}, results)
        if not is_complete:
            raise TooMuchError

    with localcontext(Context(prec=50)):
        return fitting_file(about, inputs, lines(), complete=True)

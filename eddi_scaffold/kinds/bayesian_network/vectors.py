"""Test vectors of a network: values of its inputs, and posteriors by definition.

They leave out what `verify` compares as data: thresholds, and nodes that methods set. What an input
remembers (hysteresis, the last value) is left out, too: then each step is a run of its own.
"""

from __future__ import annotations

import itertools
import math
import random
from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from eddi_scaffold.common.graphs import reached
from eddi_scaffold.evidence import vectors
from eddi_scaffold.evidence.emitted import UnprovedError
from eddi_scaffold.kinds.bayesian_network.elimination import factors_of, summed
from eddi_scaffold.kinds.bayesian_network.network import Network

if TYPE_CHECKING:
    from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions
    from eddi_scaffold.program.input_expressions import BoundInput

Weights = tuple[float, ...]  # of the states of a node
Values = Mapping[str, Any]  # input -> value as in the file
_MOST_CASES, _DRAWN, _STEPS = 512, 200, 32  # of evidence; drawn where it is more; of a run
_LEAST = 1e-250  # of the probability of evidence: below it, sums may have lost terms to underflow
_CASE = -1  # an axis for cases of evidence, beside the nodes
_IS = {"nan": math.nan, "inf": math.inf, "-inf": -math.inf}


class _Source(NamedTuple):
    """What an input says of a node."""

    input: BoundInput
    states: Sequence[str]
    of: Any  # its discretisation, `None`: it gives states or likelihoods

    def read(self, given: Any, virtual: bool) -> Weights | None:
        """Return likelihoods, `None` for not observed."""
        raw = _IS.get(given["is"], ()) if isinstance(given, dict) else given
        if self.of is None:
            sure = [float(state == raw) for state in self.states] if isinstance(raw, str) else raw
            return _likelihoods(sure, len(self.states), virtual)
        state = self._state(raw)
        if state is None and self.of.policy == "default":
            state = self._state(self.input.default)
        return None if state in (None, len(self.states)) else _one(state, len(self.states))

    def _state(self, raw: Any) -> int | None:
        of = self.of
        for special, state in of.special:
            if type(special) is type(raw) and special == raw:
                return int(state)
        if of.edges is None or type(raw) not in (int, float) or math.isnan(raw):
            return None
        (low, high), number = of.limits, float(raw)
        if of.clamp and math.isfinite(number):
            number = min(max(number, low), high)
        if not (of.allow_inf if math.isinf(number) else low <= number <= high):
            return int(of.missing)
        number = number * of.scale + of.offset if of.scaled else number
        return int(of.order[(bisect_left if of.closed_right else bisect_right)(of.edges, number)])

    def values(self) -> Iterator[Any]:
        """Yield values of each state, at each edge and limit, around them, and those of none."""
        of, count = self.of, len(self.states)
        yield from (True, False, *self.states, None, "", 0, 1, 1.5)
        yield from ({"is": name} for name in ("nan", "object", "absent", "inf", "-inf"))
        if of is None:
            yield from ([2, *[0] * (count - 1)], [0.0] * count, [1.0] * (count + 1), [-1.0] * count)
            yield [0.25 + k for k in range(count)]
            return
        yield from (value for value, _ in of.special)
        numbers = [(edge - of.offset) / of.scale for edge in of.edges or ()]
        for number in dict.fromkeys([*numbers, *filter(math.isfinite, of.limits)]):
            yield from (round(number), number - 1.0, number + 1.0)
            yield from (number + k * math.ulp(number) for k in (-2, -1, 0, 1, 2))


def _one(state: int | None, count: int) -> Weights:
    return tuple(float(k == state) for k in range(count))


def _likelihoods(numbers: Any, count: int, virtual: bool) -> Weights | None:
    """Return what numbers say of the states of a node, `None` for nothing."""
    if not isinstance(numbers, list) or len(numbers) != count or not any(numbers):
        return None
    if min(numbers) < 0.0 or not (virtual or sorted(numbers)[-2:] == [0.0, 1.0][-count:]):
        return None
    return tuple(number / max(numbers) for number in numbers)


def _cases(fed: Mapping[str, Sequence[Any]]) -> list[Values]:
    """Return all combinations of values, or some where these are too many."""
    if math.prod(map(len, fed.values())) <= _MOST_CASES:
        return [dict(zip(fed, case, strict=True)) for case in itertools.product(*fed.values())]
    draw = random.Random(1)  # noqa: S311 - the same every time
    pairs = [(id_, value) for id_, values in fed.items() for value in values]
    drawn = ({id_: draw.choice(values) for id_, values in fed.items()} for _ in range(_DRAWN))
    none = {id_: values[-1] for id_, values in fed.items()}
    few = ({**none, **dict(two)} for two in itertools.combinations(pairs, 2))
    return [none, *drawn, *itertools.islice(few, _MOST_CASES - _DRAWN)]


class _Posteriors:
    """What a network gives, by definition."""

    def __init__(
        self, network: Network, options: NetworkOptions, inputs: Sequence[BoundInput]
    ) -> None:
        self.options, self.nodes, names = options, network.nodes, network.names()
        reader_of = {entry.node: entry.reader for entry in options.declarations}
        input_of = {input_.id: input_ for input_ in inputs}
        self.sources = {
            k: _Source(input_of[id_], node.states, reader_of.get(node.id))
            for k, node in enumerate(network.nodes)
            if (id_ := options.input_of(node.id)) is not None
        }
        self.outputs = [*map(names.index, options.outputs)]
        self._factors = factors_of(network)
        parents = dict(enumerate(axes[:-1] for axes, _ in self._factors))
        self._relevant = sorted(reached(parents, [*self.outputs, *self.sources]))

    def results(self, cases: Sequence[Values]) -> list[dict[str, Any] | None]:
        """Return what comes out; `None` where that depends on rounding or on the last result."""
        if not cases:
            return []
        factors = [self._factors[k] for k in self._relevant]
        factors.append(((_CASE,), np.ones(len(cases))))
        for k, source in self.sources.items():
            read = (source.read(of.get(source.input.id), self.options.virtual) for of in cases)
            none = (1.0,) * len(source.states)
            factors.append(((_CASE, k), np.array([none if of is None else of for of in read])))
        possible = summed([(axes, (of > 0.0).astype(float)) for axes, of in factors], [_CASE]) > 0.0
        given: list[dict[str, Any] | None] = [{} for _ in cases]
        for k in self.outputs:
            for number, row in enumerate(summed(factors, [_CASE, k])):
                whole, of = math.fsum(row), given[number]
                is_clear = whole > _LEAST if possible[number] else self._is_silent()
                if of is None or not is_clear:
                    given[number] = None
                    continue
                for state, p in zip(self.nodes[k].states, row, strict=True):
                    value = float(f"{p / whole:.10g}") if possible[number] else None
                    of[f"{self.nodes[k].id}={state}"] = value
        return given

    def _is_silent(self) -> bool:
        return self.options.on_inconsistent == "silent"

    def runs(self, name: str, cases: Sequence[Values], length: int) -> Iterator[vectors.Run]:
        """Yield runs of some steps each."""
        known = [
            pair for pair in zip(cases, self.results(cases), strict=True) if pair[1] is not None
        ]
        for start in range(0, len(known), length):
            steps, values, told = list[vectors.Step](), dict[str, Any](), dict[str, Any]()
            for second, (given, results) in enumerate(known[start : start + length]):
                before, after = vectors.changed(values, given), vectors.changed(told, results or {})
                steps.append(vectors.Step(second * 10**9, before, after))
                values, told = {**values, **given}, {**told, **(results or {})}
            yield vectors.Run(name, steps)


def network_vectors(
    network: Network,
    options: NetworkOptions,
    inputs: Sequence[BoundInput],
    about: Mapping[str, str],
) -> str:
    """Return the content of ``vectors.json``; empty for a network that is too wide."""
    of, fed = _Posteriors(network, options, inputs), dict[str, list[Any]]()
    for source in of.sources.values():
        kinds = dict[Weights | None, Any]()  # of each reading, a value
        for value in source.values():
            kinds.setdefault(source.read(value, options.virtual), value)
        none = [kinds.pop(None, None)]
        fed[source.input.id] = [*kinds.values(), *fed.get(source.input.id, none)]
    first, cases = {id_: values[0] for id_, values in fed.items()}, _cases(fed)
    remembers = any(
        entry.reader.hysteresis or entry.reader.policy == "hold" for entry in options.declarations
    )
    length = 1 if remembers else _STEPS

    def rows() -> Iterator[vectors.Run | list[object]]:
        yield from vectors.age_rows(inputs, first, lambda given: of.results([given])[0])
        yield from of.runs("evidence", cases[:_STEPS], length)
        for source in of.sources.values():
            values = [{**first, source.input.id: value} for value in source.values()]
            yield from of.runs(f"value:{source.input.id}", values, length)
        yield from of.runs("further evidence", cases[_STEPS:], length)

    is_complete = len(cases) == math.prod(map(len, fed.values())) and not remembers
    is_complete = is_complete and options.on_inconsistent == "silent"  # else impossible ones lack
    try:
        return vectors.fitting_file(about, inputs, rows(), complete=is_complete)
    except UnprovedError:
        return ""

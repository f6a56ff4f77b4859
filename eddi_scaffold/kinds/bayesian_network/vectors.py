"""Test vectors of a network: values of inputs, thresholds, what methods observe, evidence.

Results follow from the definition: posteriors are sums over the product of the nodes' tables. What
an input remembers (hysteresis, the last value) is left out: then each step is a run of its own.
"""

from __future__ import annotations

import itertools
import math
import random
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from eddi_scaffold.common.graphs import reached
from eddi_scaffold.evidence import vectors
from eddi_scaffold.kinds.bayesian_network.network import Network, node_attributes

if TYPE_CHECKING:
    from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions
    from eddi_scaffold.program.input_expressions import BoundInput

Weights = tuple[float, ...]  # of the states of a node
Evidence = Mapping[int, Weights]  # node -> likelihoods of what is seen of it
Table = tuple[tuple[int, ...], dict[tuple[int, ...], float]]  # nodes; their states -> a factor
Values = Mapping[str, Any]  # input, or `node_<attribute>()` for a method -> value as in the file
_MOST_NODES, _MOST_WORK = 60, 400_000  # of a network; entries of tables that are made
_MOST_CASES, _DRAWN, _STEPS = 512, 200, 32  # of evidence; drawn where it is more; of a run
_MOST_COMPLETIONS = 1024  # of what is not known, up to which thresholds are judged
_SMALL = 100_000  # entries of a joint table of which methods can observe and ask for every node
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
        yield from (text.swapcase() for text in self.states)
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


class _Vectors:
    """Runs of a network, by definition."""

    def __init__(
        self, network: Network, options: NetworkOptions, inputs: Sequence[BoundInput]
    ) -> None:
        self.options, self.nodes, names = options, network.nodes, network.names()
        self.cards, self.tables = [len(node.states) for node in network.nodes], list[Table]()
        for node in network.nodes:
            axes = (*map(names.index, node.parents), names.index(node.id))
            states = itertools.product(*(range(self.cards[k]) for k in axes))
            self.tables.append((axes, dict(zip(states, node.table, strict=True))))
        self.work, self.known = 0, dict[object, Weights]()
        self.method = [f"node_{name}()" for name in node_attributes(network).values()]
        self.observable = [*map(names.index, options.observable)]
        self.outputs = [*map(names.index, options.outputs)]
        of = {entry.node: entry.reader for entry in options.declarations}
        input_of = {input_.id: input_ for input_ in inputs}
        fed = [(k, network.nodes[k], options.input_of(names[k])) for k in self.observable]
        self.sources = {
            k: _Source(input_of[name], node.states, of.get(node.id))
            for k, node, name in fed
            if name is not None
        }
        self.remembers = any(of.hysteresis or of.policy == "hold" for of in of.values())
        # id, limits, node, states, and a sign by which it is an upper one
        self.thresholds = list[tuple[str, tuple[float, float, float], int, list[int], int]]()
        for row in () if self.remembers else options.thresholds:
            k, sign = names.index(row.node), -1 if row.at_least else 1
            of_node = [*map(network.nodes[k].states.index, row.states)]
            limits = sign * row.limit, sign * row.release, row.hold
            self.thresholds.append((row.id, limits, k, of_node, sign))

    def posteriors(self, evidence: Evidence, nodes: Iterable[int]) -> dict[int, Weights]:
        """Return node -> the probabilities of its states; none where the evidence is impossible."""
        rows = {node: self._posterior(evidence, node) for node in nodes}
        return rows if all(rows.values()) else {}

    def _posterior(self, evidence: Evidence, node: int) -> Weights:
        key = node, *sorted(evidence.items())
        if key not in self.known:
            relevant = reached({of[-1]: of for of, _ in self.tables}, [node, *evidence])
            tables, left = [of for of in self.tables if of[0][-1] in relevant], relevant - {node}
            tables += (((k,), {(s,): p for s, p in enumerate(of)}) for k, of in evidence.items())
            states = [[*range(card)] for card in self.cards]  # that are possible
            for k, of in evidence.items():
                states[k] = [state for state, p in enumerate(of) if p]
            while left:
                self.work += len(left) * len(tables) // 20
                unions = {k: {m for of, _ in tables if k in of for m in of} for k in left}
                sizes = {k: math.prod(len(states[m]) for m in of) for k, of in unions.items()}
                left.remove(least := min(left, key=lambda k: (sizes[k], k)))
                summed = self._summed(
                    [table for table in tables if least in table[0]], least, states
                )
                tables = [*(table for table in tables if least not in table[0]), summed]
            _, sums = self._summed(tables, -1, states)
            row = [sums.get((state,), 0.0) for state in range(self.cards[node])]
            whole = math.fsum(row)
            self.known[key] = tuple(p / whole for p in row) if whole else ()
        return self.known[key]

    def _summed(self, tables: Sequence[Table], node: int, states: Sequence[Sequence[int]]) -> Table:
        """Return the product of tables, summed over a node."""
        nodes = sorted({k for of, _ in tables for k in of})
        kept, sums = tuple(k for k in nodes if k != node), dict[tuple[int, ...], float]()
        for case in itertools.product(*(states[k] for k in nodes)):
            self.work += 1
            if self.work > _MOST_WORK:
                raise vectors.TooMuchError
            at = dict(zip(nodes, case, strict=True))
            key = tuple(at[k] for k in kept)
            p = math.prod(rows[tuple(at[k] for k in of)] for of, rows in tables)
            sums[key] = sums.get(key, 0.0) + p
        largest = max(sums.values()) or 1.0  # so that none becomes too small
        return kept, {key: p / largest for key, p in sums.items()}

    def run(self, name: str, changes: Iterable[tuple[int, Values]]) -> vectors.Run:
        """Return the steps with what comes out.

        Without those that depend on rounding, or on what is done with impossible evidence.
        """
        judges = [vectors.Judge(*limits) for _, limits, *_ in self.thresholds]
        steps = list[vectors.Step]()
        values, told = dict[str, Any](), dict[str, Any]()
        for now, new in changes:
            inputs = {**values, **new}
            evidence, worst = self.seen(inputs)
            methods = [inputs.get(method, (False, {})) for method in self.method]
            asked = [k for k, (is_asked, _) in enumerate(methods) if is_asked or k in self.outputs]
            rows = self.posteriors(evidence, asked)
            is_silent = self.options.on_inconsistent == "silent"
            if any(map(vectors.Judge.is_near, judges, worst)) or not (rows or is_silent):
                continue
            results: dict[str, Any] = {
                f"{self.nodes[k].id}={state}": float(f"{rows[k][number]:.12g}") if rows else None
                for k in asked
                for number, state in enumerate(self.nodes[k].states)
            }
            for (id_, *_), judge, value in zip(self.thresholds, judges, worst, strict=True):
                results[id_] = judge.step(now, value)
            before, after = vectors.changed(values, inputs), vectors.changed(told, results)
            steps.append(vectors.Step(now, before, after))
            values, told = inputs, results
        return vectors.Run(name, steps)

    def seen(self, values: Values) -> tuple[Evidence, list[float | None]]:
        """Return the evidence, and what each threshold judges in the worst case of the rest."""
        evidence, unknown, virtual = dict[int, Weights](), list[int](), self.options.virtual
        for k, method in enumerate(self.method):
            source = self.sources.get(k)
            weights = source.read(values.get(source.input.id), virtual) if source else None
            is_prior = source is not None and source.of is not None and source.of.policy == "prior"
            is_open = (k in self.observable or method in values) and not is_prior
            if any(numbers := [*values.get(method, (0, {}))[1].values()]):
                weights, is_open = _likelihoods(numbers, self.cards[k], virtual), True
            if weights is not None:
                evidence[k] = weights
            elif is_open:
                unknown.append(k)
        cases, nodes = list[dict[int, Weights]](), {of[2] for of in self.thresholds}
        if nodes and math.prod(self.cards[k] for k in unknown) <= _MOST_COMPLETIONS:
            for states in itertools.product(*(range(self.cards[k]) for k in unknown)):
                pairs = zip(unknown, states, strict=True)
                sure = {k: _one(state, self.cards[k]) for k, state in pairs}
                rows = self.posteriors({**evidence, **sure}, nodes)
                cases += [rows] if rows else []
        return evidence, [
            max((sign * math.fsum(rows[k][s] for s in of) for rows in cases), default=None)
            for _, _, k, of, sign in self.thresholds
        ]

    def runs(self, first: Values, cases: Sequence[Values]) -> Iterator[vectors.Run]:
        """Yield runs, those that tell most of the least first."""
        judged = [(self.seen(case)[1], case) for case in cases[:_STEPS]]
        for k, (id_, limits, *_) in enumerate(self.thresholds):
            known = [(worst[k], case) for worst, case in judged]
            yield self.run(f"threshold:{id_}", vectors.held(vectors.Judge(*limits), known))
        lists: dict[str, Sequence[Values]] = {
            f"value:{of.input.id}": [{**first, of.input.id: value} for value in of.values()]
            for of in self.sources.values()
        }
        lists = {
            "evidence": cases[:_STEPS],
            "methods": [*self._methods(asks=False)],
            "results of all nodes": [*self._methods(asks=True)],
            **lists,
        }
        lists["further evidence"] = cases[_STEPS:]
        length = 1 if self.remembers else _STEPS
        for name, values in lists.items():
            for k in range(0, len(values), length):
                each = enumerate(values[k : k + length])
                yield self.run(name, [(second * 10**9, of) for second, of in each])

    def _methods(self, *, asks: bool) -> Iterator[Values]:
        """Yield what methods of nodes may say of them: nothing, a state, likelihoods."""
        draw = random.Random(2)  # noqa: S311 - the same every time
        is_small = math.prod(self.cards) <= _SMALL
        for _ in range(_STEPS):
            given = {}
            for k in range(len(self.cards)) if is_small else self.observable:
                row = _one(int(draw.random() * 2 * self.cards[k]), self.cards[k])
                if draw.random() < 0.3:
                    row = tuple(round(0.05 + draw.random(), 3) for _ in row)
                node = self.nodes[k]
                is_asked = asks and is_small and node.id not in self.options.inferred
                given[self.method[k]] = is_asked, dict(zip(node.states, row, strict=True))
            yield given


def _cases(sources: Sequence[Sequence[tuple[str, Any]]]) -> list[Values]:
    """Return all evidence, or some where it is too much."""
    if math.prod(map(len, sources)) <= _MOST_CASES:
        return [*map(dict, itertools.product(*sources))]
    draw = random.Random(1)  # noqa: S311 - the same every time
    drawn = ([of[int(draw.random() * len(of))] for of in sources] for _ in range(_DRAWN))
    every, none = [pair for of in sources for pair in of], [of[-1] for of in sources]
    rows = itertools.chain(zip(every), drawn, itertools.combinations(every, 2))
    return [dict([*none, *row]) for row in itertools.islice(rows, _MOST_CASES)]


def network_vectors(
    network: Network,
    options: NetworkOptions,
    inputs: Sequence[BoundInput],
    about: Mapping[str, str],
) -> str:
    """Return the content of ``vectors.json``; empty for a network that is too large."""
    if len(network.nodes) > _MOST_NODES or sum(len(of.table) for of in network.nodes) > _MOST_WORK:
        return ""
    of, fed = _Vectors(network, options, inputs), dict[str, list[tuple[str, Any]]]()
    for source in of.sources.values():
        id_, kinds = source.input.id, dict[Weights | None, Any]()  # of each reading, a value
        for value in source.values():
            kinds.setdefault(source.read(value, options.virtual), value)
        none = [(id_, kinds.pop(None, None))]
        fed[id_] = [*((id_, value) for value in kinds.values()), *fed.get(id_, none)]
    first, cases = dict(pairs[0] for pairs in fed.values()), _cases([*fed.values()])

    def at_start(given: Values) -> Values | None:
        return next((step.results for step in of.run("", [(0, given)]).steps), None)

    ages = vectors.age_rows(inputs, first, at_start)
    rows = itertools.chain[vectors.Run | list[object]](ages, of.runs(first, cases))
    is_complete = len(cases) == math.prod(map(len, fed.values())) and not of.remembers
    is_complete = is_complete and options.on_inconsistent == "silent"  # else impossible ones lack
    return vectors.fitting_file(about, inputs, rows, complete=is_complete)

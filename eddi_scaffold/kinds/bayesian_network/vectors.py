"""Test vectors of a network: evidence, edges of bins, thresholds, what methods may observe.

Results follow from the definition: posteriors are sums over the product of the nodes' tables.
"""

from __future__ import annotations

import copy
import itertools
import math
import random
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import reduce
from typing import TYPE_CHECKING, Any

from eddi_scaffold.evidence.vectors import (
    Judge,
    Run,
    Step,
    TooMuchError,
    age_rows,
    changed,
    fitting_file,
    held,
    merged,
)
from eddi_scaffold.kinds.bayesian_network.network import Network, node_attributes

if TYPE_CHECKING:
    from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions, Threshold
    from eddi_scaffold.program.input_expressions import BoundInput

Weights = tuple[float, ...]  # of the states of a node: the likelihoods of what is seen of it
Evidence = Mapping[int, Weights]
Possible = Mapping[int, Sequence[int]]  # states of nodes that are not known
Key = tuple[int, ...]
Table = tuple[Key, dict[Key, float]]  # nodes; their states with a probability that is not zero
Values = Mapping[str, Any]  # input, or `node_<attribute>()` for a method -> value as in the file
Changes = Sequence[tuple[int, Values]]  # steps: time in nanoseconds, what changes
_MOST_NODES, _MOST_WORK = 100, 200_000  # of a network; entries of tables that are made
_MOST_CASES, _DRAWN, _STEPS = 512, 200, 64  # of evidence; drawn where it is more; of a run
_MOST_COMPLETIONS = 1024  # of what is not known, up to which thresholds are judged
_SMALL = 4096  # entries of a joint table of which every node can be observed and asked for
_NEAR = -1e-6, 1e-6  # by which a posterior is off a limit, relative
_IS = {"nan": math.nan, "inf": math.inf, "-inf": -math.inf}


class _Reader:
    """How values of an input become states of a node."""

    def __init__(self, of: Any, states: Sequence[str], input_: BoundInput, virtual: bool) -> None:
        self.of = of  # its discretisation, ``None``: it gives states or likelihoods
        self.states, self.input, self.virtual = states, input_, virtual
        self.hold_ns = int(input_.max_age * 1e9) if isinstance(input_.max_age, float) else 0
        self.bins = frozenset(range(len(of.order) if of else 0))
        # the last bin, the bins of which one is right; the last state, its time, what else may be
        self.memory: Any = None, self.bins, (None, 0, ())

    def read(self, given: Any, now: int) -> tuple[Weights | None, Sequence[int]]:
        """Return likelihoods, ``None`` for not observed, and the states that are possible."""
        raw, of = _IS.get(given["is"], ()) if isinstance(given, dict) else given, self.of
        if of is None:
            sure = [float(state == raw) for state in self.states] if isinstance(raw, str) else raw
            return _likelihoods(sure, len(self.states), virtual=self.virtual), ()
        before, may_be, last = self.memory
        state, number = self._judged(raw)
        possible: Sequence[int] = ()
        if number is not None:
            place = self._bin(number, before)
            bins = frozenset(self._bin(number, other) for other in may_be) | {place}
            state = of.order[place]
            if of.hysteresis:
                before, may_be = place, bins
                possible = [of.order[k] for k in sorted(bins)] if len(bins) > 1 else ()
        elif state is not None:
            before, may_be = None, self.bins if state == of.missing else frozenset()
        else:
            self.memory = None, self.bins, last
            if of.policy == "hold" and 0 <= now - last[1] <= self.hold_ns:
                return self._sure(last[0]), last[2]
            state, number = self._judged(self.input.default if of.policy == "default" else None)
            return self._sure(state if number is None else of.order[self._bin(number)]), ()
        self.memory = before, may_be, (state, now, possible)
        return self._sure(state), possible

    def _sure(self, state: int | None) -> Weights | None:
        return None if state in (None, len(self.states)) else _one(state, len(self.states))

    def _judged(self, raw: Any) -> tuple[int | None, float | None]:
        """Return the state, or a number for the bins, or neither."""
        of = self.of
        for special, state in of.special:
            if type(special) is type(raw) and special == raw:
                return state, None
        if of.edges is None or type(raw) not in (int, float) or math.isnan(raw):
            return None, None
        (low, high), value = of.limits, float(raw)
        if of.clamp and math.isfinite(value):
            value = min(max(value, low), high)
        if not (of.allow_inf if math.isinf(value) else low <= value <= high):
            return of.missing, None
        return None, value * of.scale + of.offset if of.scaled else value

    def _bin(self, number: float, before: int | None = None) -> int:
        """Return the bin of a number: that before while it is not beyond the band."""
        edges = self.of.edges
        bare: int = (bisect_left if self.of.closed_right else bisect_right)(edges, number)
        if before is None or before == bare:
            return bare
        beyond = number - edges[before] if bare > before else edges[before - 1] - number
        return before if beyond <= self.of.hysteresis else bare

    def usual(self) -> list[Any]:
        """Return a value for each state."""
        of = self.of
        if of is None:
            return [*self.states]
        values = [value for value, state in of.special if state != of.missing]
        if of.edges is not None:
            low, high = sorted(limit * of.scale + of.offset for limit in of.limits)
            edges, width = of.edges or (0.0,), max(1.0, 4.0 * of.hysteresis, *map(abs, of.edges), 0)
            ends = [max(low, edges[0] - width), *of.edges, min(high, edges[-1] + width)]
            middles = (a / 2.0 + b / 2.0 for a, b in itertools.pairwise(ends))
            values += [(middle - of.offset) / of.scale for middle in middles]
        return values

    def odd(self) -> Iterator[Any]:
        """Yield values at each edge and limit, from both sides, and those that are none."""
        of, usual, count = self.of, self.usual(), len(self.states)
        yield from (usual[0], None, *({"is": name} for name in ("nan", "object", "absent")))
        yield from (usual[-1], True, False, "", "true", 0, 1, 1.5, usual[0], None)
        yield from (str(value).swapcase() for value in usual)
        if of is None:
            yield from ([0.25 + k for k in range(count)], [0.0] * count, [1.0] * (count + 1), [])
            yield from ([1.0, *[0.0] * (count - 1)], [2, *[0] * (count - 1)], [-1.0] * count)
            return
        yield from (value for value, _ in of.special)
        edges = [e + band for e in of.edges or () for band in (-of.hysteresis, 0.0, of.hysteresis)]
        numbers = [(edge - of.offset) / of.scale for edge in edges]
        for number in dict.fromkeys([*numbers, *filter(math.isfinite, of.limits)]):
            near = [number + k * math.ulp(number) for k in (-2, -1, 0, 1, 2)]
            yield from (usual[0], *near, usual[-1], *near[::-1], None, number, round(number))
        yield from ({"is": "inf"}, usual[-1], {"is": "-inf"})


def _one(state: int | None, count: int) -> Weights:
    return tuple(float(k == state) for k in range(count))


def _likelihoods(numbers: Any, count: int, *, virtual: bool) -> Weights | None:
    """Return what numbers say of the states of a node, ``None`` for nothing."""
    if not isinstance(numbers, list) or len(numbers) != count or not any(numbers):
        return None
    if min(numbers) < 0.0 or not (virtual or sorted(numbers)[-2:] == [0.0, 1.0][-count:]):
        return None
    if sum(map(bool, numbers)) == 1:
        return tuple(float(bool(number)) for number in numbers)
    return tuple(number / max(numbers) for number in numbers)


class _Vectors:
    """Runs of a network, by definition."""

    def __init__(
        self, network: Network, options: NetworkOptions, inputs: Sequence[BoundInput]
    ) -> None:
        self.options, self.nodes, self.inputs = options, network.nodes, inputs
        number = {name: k for k, name in enumerate(network.names())}
        self.cards = [len(node.states) for node in network.nodes]
        self.small = math.prod(self.cards) <= _SMALL
        self.method = [f"node_{name}()" for name in node_attributes(network).values()]
        self.observable = [number[name] for name in options.observable]
        self.outputs = [number[name] for name in options.outputs]
        # node and states of each threshold, and a sign by which it is an upper one
        self.thresholds: list[tuple[Threshold, int, list[int], float]] = []
        for of in options.thresholds:
            states = [network.node(of.node).states.index(state) for state in of.states]
            self.thresholds.append((of, number[of.node], states, -1.0 if of.at_least else 1.0))
        self.work, self.posteriors = 0, dict[object, Weights | None]()
        self.tables: list[Table] = []
        for node in network.nodes:
            nodes = (*(number[parent] for parent in node.parents), number[node.id])
            keys = itertools.product(*(range(self.cards[k]) for k in nodes))
            self.tables.append((nodes, {k: p for k, p in zip(keys, node.table, strict=True) if p}))
        self.judged_only = {k for _, k, *_ in self.thresholds} - {*self.outputs}
        self.kept = {*self.observable, *(number[name] for name in options.inferred)}
        self.fewer = self.summed(self.tables, self.kept)

    def rows(self, evidence: Evidence, nodes: Iterable[int]) -> dict[int, Weights] | None:
        """Return node -> its posterior, ``None`` where the evidence is impossible."""
        rows, key = {}, tuple(sorted(evidence.items()))
        for node in nodes:
            if (node, key) not in self.posteriors:
                tables = self.fewer if self.kept >= {node, *evidence} else self.tables
                self.posteriors[node, key] = self._posterior(tables, evidence, node)
            row = self.posteriors[node, key]
            if row is None:
                return None
            rows[node] = row
        return rows

    def _posterior(self, tables: Sequence[Table], evidence: Evidence, node: int) -> Weights | None:
        seen: list[Table] = [
            ((k,), {(state,): p for state, p in enumerate(of) if p}) for k, of in evidence.items()
        ]
        _, rows = reduce(self._product, self.summed([*seen, *tables], {node}))
        row = [rows.get((state,), 0.0) for state in range(self.cards[node])]
        whole = math.fsum(row)
        return tuple(p / whole for p in row) if whole else None

    def summed(self, tables: Sequence[Table], kept: set[int]) -> list[Table]:
        """Return tables of which the product is the sum of this one over all nodes not kept."""
        left, rest = {node for nodes, _ in tables for node in nodes} - kept, [*tables]
        while left:
            unions = {n: {m for nodes, _ in rest if n in nodes for m in nodes} for n in left}
            sizes = {n: math.prod(self.cards[m] for m in of) for n, of in unions.items()}
            left.remove(node := min(left, key=lambda n: (sizes[n], n)))
            nodes, rows = reduce(self._product, [table for table in rest if node in table[0]])
            rest = [table for table in rest if node not in table[0]]
            place, sums = nodes.index(node), dict[Key, float]()
            for states, p in rows.items():
                key = states[:place] + states[place + 1 :]
                sums[key] = sums.get(key, 0.0) + p
            largest = max(sums.values(), default=1.0)  # so that none becomes too small
            others = nodes[:place] + nodes[place + 1 :]
            rest.append((others, {key: p / largest for key, p in sums.items()}))
        return rest

    def _product(self, one: Table, other: Table) -> Table:
        shared = [node for node in other[0] if node in one[0]]
        mine, theirs = ([of[0].index(node) for node in shared] for of in (one, other))
        new = [place for place, node in enumerate(other[0]) if node not in shared]
        groups: dict[Key, list[tuple[Key, float]]] = {}
        for states, p in other[1].items():
            group = groups.setdefault(tuple(states[place] for place in theirs), [])
            group.append((tuple(states[place] for place in new), p))
        rows = {
            states + more: p * q
            for states, p in one[1].items()
            for more, q in groups.get(tuple(states[place] for place in mine), ())
        }
        self._spend(20 + len(rows) + len(one[1]) + len(other[1]))
        return (*one[0], *(other[0][place] for place in new)), rows

    def _spend(self, work: int) -> None:
        self.work += work
        if self.work > _MOST_WORK:
            raise TooMuchError

    def readers(self) -> dict[int, _Reader]:
        """Return new readers of the nodes that inputs feed."""
        of = {entry.node: entry.reader for entry in self.options.declarations}
        inputs, virtual = {input_.id: input_ for input_ in self.inputs}, self.options.virtual
        names = {k: self.options.input_of(self.nodes[k].id) for k in self.observable}
        return {
            k: _Reader(of.get(self.nodes[k].id), self.nodes[k].states, inputs[name], virtual)
            for k, name in names.items()
            if name is not None
        }

    def judges(self) -> list[Judge]:
        """Return new judges of the thresholds."""
        return [Judge(s * of.limit, s * of.release, of.hold) for of, *_, s in self.thresholds]

    def run(self, name: str, changes: Changes) -> Run:
        """Return the steps with what comes out, without those that depend on rounding."""
        readers, judges, good = self.readers(), self.judges(), None
        values, told, steps = dict[str, Any](), dict[str, Any](), []
        for now, new in changes:
            trial, inputs = {k: copy.copy(of) for k, of in readers.items()}, {**values, **new}
            evidence, possible = self._seen(trial, inputs, now)
            flagged = {k for k, of in enumerate(self.method) if inputs.get(of, "-")[0] is True}
            asked = sorted(flagged.union(self.outputs))
            rows, worst = self.rows(evidence, asked), self._worst(evidence, possible)
            # where nothing is given, nodes that thresholds alone are about have no names
            nameless = rows is None and not self.judged_only.isdisjoint(flagged)
            if nameless or any(map(Judge.is_near, judges, worst)):
                continue
            readers, good = trial, rows or good
            if rows is None and self.options.on_inconsistent != "silent":
                rows = good if self.options.on_inconsistent == "hold" else self.rows({}, asked)
            results: dict[str, Any] = {
                f"{self.nodes[k].id}={state}": rows and float(f"{rows[k][number]:.12g}")
                for k in asked
                for number, state in enumerate(self.nodes[k].states)
            }
            for (of, *_), judge, value in zip(self.thresholds, judges, worst, strict=True):
                results[of.id] = judge.step(now, value)
            steps.append(Step(now, changed(values, inputs), changed(told, results)))
            values, told = inputs, results
        return Run(name, steps)

    def _seen(
        self, readers: Mapping[int, _Reader], values: Values, now: int
    ) -> tuple[Evidence, Possible]:
        """Return what is seen of nodes, and the states that others may have."""
        evidence: dict[int, Weights] = {}
        possible: dict[int, Sequence[int]] = {}
        for k, (card, method) in enumerate(zip(self.cards, self.method, strict=True)):
            weights, several = None, range(card if k in self.observable or method in values else 0)
            states: Sequence[int] = several
            if k in readers:
                weights, states = readers[k].read(values.get(readers[k].input.id), now)
                is_open = readers[k].of is None or readers[k].of.policy != "prior"
                states = several if weights is None and is_open else states
            if any(numbers := [*values.get(method, (0, {}))[1].values()]):
                weights = _likelihoods(numbers, card, virtual=self.options.virtual)
                states = several if weights is None else ()
            if weights is not None:
                evidence[k] = weights
            if states and (weights is None or k in readers):
                possible[k] = states
        return evidence, possible

    def _worst(self, evidence: Evidence, possible: Possible) -> list[float | None]:
        """Return what each threshold judges, in the worst case; negative for ``at_least``."""
        cases, nodes = [], sorted({k for _, k, *_ in self.thresholds})
        if nodes and math.prod(map(len, possible.values())) <= _MOST_COMPLETIONS:
            for states in itertools.product(*possible.values()):
                self._spend(10)
                pairs = zip(possible, states, strict=True)
                sure = {k: _one(state, self.cards[k]) for k, state in pairs}
                cases += [*filter(None, [self.rows({**evidence, **sure}, nodes)])]
        return [
            max((sign * math.fsum(rows[k][s] for s in of) for rows in cases), default=None)
            for _, k, of, sign in self.thresholds
        ]

    def sources(self) -> Iterator[list[Values]]:
        """Yield for each input values that differ, last none."""
        for input_ in self.inputs:
            fed = [k for k, reader in self.readers().items() if reader.input is input_]
            seen: dict[str, Values] = {}
            for value in (value for k in fed for value in self.readers()[k].usual()):
                new = self.readers()
                states = str([new[k].read(value, 0) for k in fed])
                seen.setdefault(states, {input_.id: value})
            yield from [[*seen.values(), {input_.id: None}]] if fed else []

    def at_start(self, values: Values) -> Values | None:
        """Return the results of a first step."""
        return next((step.results for step in self.run("", [(0, values)]).steps), None)

    def cases(self, sources: Sequence[Sequence[Values]]) -> list[Values]:
        """Return all evidence, or some where it is too much."""
        if math.prod(map(len, sources)) <= _MOST_CASES:
            return [*map(merged, itertools.product(*sources))]
        draw = random.Random(1)  # noqa: S311 - the same every time
        none = merged(of[-1] for of in sources)
        some = [of[int(draw.random() * len(of))] for _ in range(_DRAWN) for of in sources]
        drawn = (some[k : k + len(sources)] for k in range(0, len(some), len(sources)))
        one = [value for of in sources for value in of]
        pairs = itertools.combinations(one, 2)
        rows = itertools.chain([[of[0] for of in sources]], drawn, zip(one), pairs)
        return [merged([none, *row]) for row in itertools.islice(rows, _MOST_CASES)]

    def changes(self, first: Values, cases: Sequence[Values]) -> Iterator[tuple[str, Changes]]:
        """Yield the name of each run and what changes in it, first those that tell most."""
        yield "evidence", _each_second(cases[:_STEPS])
        for reader in self.readers().values():
            name = reader.input.id
            yield f"value:{name}", _each_second([{**first, name: of} for of in reader.odd()])
            if reader.of is not None and reader.of.policy == "hold":
                times = [(0, reader.usual()[0]), (reader.hold_ns, None), (reader.hold_ns + 1, None)]
                yield f"hold:{name}", [(now, {**first, name: value}) for now, value in times]
        judged = [self._worst(*self._seen(self.readers(), of, 0)) for of in cases[:_STEPS]]
        for number, (judge, (of, *_)) in enumerate(
            zip(self.judges(), self.thresholds, strict=True)
        ):
            rows = ((row[number], k) for k, row in enumerate(judged))
            known = sorted((w, k) for w, k in rows if w is not None)
            good = [cases[k] for w, k in known if w <= judge.activate][-1:]
            band = [cases[k] for w, k in known if judge.activate < w <= judge.release][:1]
            bad = [cases[k] for w, k in known if w > judge.release][:1]
            yield f"threshold:{of.id}", held(judge.hold_ns, good, band, bad)
            yield f"limits:{of.id}", held(judge.hold_ns, *self._near(number, cases))
        yield "evidence", _each_second(cases[_STEPS:])
        yield "methods", _each_second(self._methods(self.observable))
        if self.small:
            everything = self._methods(range(len(self.nodes)), asked=True)
            yield "methods of all nodes", _each_second(everything)

    def _methods(self, nodes: Sequence[int], *, asked: bool = False) -> Iterator[Values]:
        """Yield what methods of nodes may say of them; the results of all can be asked for."""
        draw = random.Random(2)  # noqa: S311 - the same every time
        hard = [[_one(state, self.cards[k]) for state in range(self.cards[k] + 1)] for k in nodes]

        def drawn(share: float) -> list[Weights]:
            return [
                tuple(round(0.05 + draw.random(), 3) for _ in of[0])
                if draw.random() < share
                else of[int(draw.random() * len(of))]
                for of in hard
            ]

        none, rows = [of[-1] for of in hard], [drawn(share) for share in (1.0, 1.0, 1.0, 0.5, 0.5)]
        rows += [[*none[:k], rows[0][k], *none[k + 1 :]] for k in range(len(nodes))]
        if asked and math.prod(map(len, hard)) <= _STEPS:
            rows += map(list, itertools.product(*hard))
        else:
            rows += [drawn(0.0) for _ in range(_STEPS // 2 * asked)]
        for row in rows if nodes else ():
            pairs = zip(nodes, row, strict=True)
            yield merged(self._gives(k, weights, asked=asked) for k, weights in pairs)

    def _gives(self, node: int, weights: Weights, *, asked: bool = False) -> Values:
        """Return what the method of a node gives."""
        outcomes = dict(zip(self.nodes[node].states, weights, strict=True))
        return {self.method[node]: [asked, outcomes]}

    def _near(self, number: int, cases: Iterable[Values]) -> Iterator[list[Values]]:
        """Yield what is just within the limits, in between, and beyond, by likelihoods."""
        of, node, states, sign = self.thresholds[number]
        limits = [limit * (1.0 + sign * by) for limit in (of.limit, of.release) for by in _NEAR]
        values: list[Values] = []
        for case in cases if self.small and min(limits) > 0.0 and max(limits) < 1.0 else ():
            evidence, possible = self._seen(self.readers(), case, 0)
            rows = None if possible or node in evidence else self.rows(evidence, [node])
            p = math.fsum(rows[node][state] for state in states) if rows else 0.0
            if 0.0 < p < 1.0:
                for q in limits:
                    ratio = q * (1.0 - p) / (p * (1.0 - q))
                    row = (ratio if k in states else 1.0 for k in range(self.cards[node]))
                    values.append({**case, **self._gives(node, tuple(row))})
                break
        yield from (values[:1], values[2:0:-1] if of.limit != of.release else [], values[3:])


def _each_second(values: Iterable[Values]) -> Changes:
    return [(k * 10**9, of) for k, of in enumerate(values)]


def network_vectors(
    network: Network,
    options: NetworkOptions,
    inputs: Sequence[BoundInput],
    about: Mapping[str, str],
) -> str:
    """Return the content of ``vectors.json``; empty for a network that is too large."""
    try:
        if len(network.nodes) > _MOST_NODES:
            return ""
        vectors = _Vectors(network, options, inputs)
    except TooMuchError:
        return ""
    sources = [*vectors.sources()]
    first, cases = merged(of[0] for of in sources), vectors.cases(sources)
    runs = (
        vectors.run(name, all_[k : k + _STEPS])
        for name, all_ in vectors.changes(first, cases)
        for k in range(0, len(all_), _STEPS)
    )
    ages = age_rows(inputs, first, vectors.at_start)
    complete = len(cases) == math.prod(map(len, sources))
    rows = itertools.chain[Run | list[object]](ages, runs)
    return fitting_file(about, inputs, rows, complete=complete)

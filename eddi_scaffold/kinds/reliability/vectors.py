"""Test vectors of a reliability model: observations, failures of parts, time, unknown inputs.

Results follow from the definitions, in decimal numbers of 50 digits: uniformisation (Jensen 1953),
products over independent failures, trees by the cases of the events that several gates share.
"""

from __future__ import annotations

import itertools
import math
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from decimal import Context, Decimal, localcontext
from functools import lru_cache, partial
from itertools import combinations
from typing import TYPE_CHECKING, Any, NamedTuple

from eddi_scaffold.common.graphs import reached, reversed_graph
from eddi_scaffold.evidence.vectors import (
    Judge,
    Run,
    Step,
    TooMuchError,
    age_rows,
    changed,
    fitting_file,
    merged,
    text,
)
from eddi_scaffold.kinds.reliability.system import (
    DYNAMIC,
    MISSION_END,
    Chain,
    ComponentModel,
    FaultTree,
    ReliabilitySystem,
    input_id,
)

if TYPE_CHECKING:
    from eddi_scaffold.program.input_expressions import BoundInput

D, INF = Decimal, Decimal("inf")
Arcs = Sequence[tuple[int, int, Decimal]]
Numbers = Sequence[Decimal]
Values = Mapping[str, Any]
Changes = Sequence[tuple[int, Values]]  # steps: time in nanoseconds, what is given
_MOST_STATES, _MOST_JUMPS, _MOST_CASES, _PATTERNS = 90, 400, 4096, 81
_MOST_WORK = 40_000  # gates and chains, for all steps
_BATTERY = ("failure_rate", "alpha", "beta", "degradation")
_GRID = 256  # horizons, where the mission's end is an input
_LATE = 36_000 * 10**9
_DUST, _NEAR = D("1e-30"), D("1e-6")
"""What is left of one by rounding, and below which its digits are not known."""
_MAX, _ANY = sys.float_info.max, (0.0, 0.0, 0.0)
_NUMBERS = ("p_fail", "p_fail_low", "p_fail_high", "reliability", "mttf")
_IS = {"nan": math.nan, "inf": math.inf}
_ODD: list[Any] = [*({"is": of} for of in ("nan", "inf", "object", "absent")), "x", []]
_RINGS = {
    "PNPN": [{0}, {1}, {2}, {3}],
    "PNPNPN": [{k, (k + 1) % 6} for k in range(6)],
    "PPNNPN": [{4}, {5}, {0, 1}, {2, 3}],
    "PPNNPPNN": [{k, k + 1} for k in (0, 2, 4, 6)],
}
"""Motors of which the loss is fatal; P and N may be exchanged."""


class Moment(NamedTuple):
    """When a step is; all in hours."""

    passed: Decimal  # since the last step, in whole quanta
    age: Decimal  # since the first
    horizon: Decimal


class Estimate(NamedTuple):
    """What lies ahead of a model."""

    low: Decimal  # that it fails, at best
    high: Decimal
    alive: Decimal
    life: Decimal | None
    unknown: bool = False  # an input that counts is not known
    wrong: bool = False  # it cannot be trusted for another reason


def _sum(numbers: Iterable[Decimal]) -> Decimal:
    return sum(numbers, D(0))


def _product(numbers: Iterable[Decimal]) -> Decimal:
    return math.prod(numbers, start=D(1))


def _sure(p: Decimal, life: Decimal) -> Estimate:
    return Estimate(p, p, 1 - p, life)


def _moved(vector: Numbers, arcs: Arcs, hours: Decimal, *, ahead: bool) -> list[Decimal]:
    """Return a belief some hours later, or, ahead, what is expected then of each state."""
    exits = [D(0) for _ in vector]
    for source, _, rate in arcs:
        exits[source] += rate
    fastest = max(exits) or D(1)
    jumps = fastest * hours
    if jumps > _MOST_JUMPS:
        raise TooMuchError
    shares = [(*((b, a) if ahead else (a, b)), rate / fastest) for a, b, rate in arcs]
    shares += [(k, k, 1 - out / fastest) for k, out in enumerate(exits)]
    weight, now = (-jumps).exp(), [*vector]
    total, count = [weight * p for p in now], 0
    while jumps and (count < jumps + len(vector) + 10 or weight > D("1e-45")):
        count += 1
        weight *= jumps / count
        after = [D(0) for _ in vector]
        for source, target, share in shares:
            after[target] += now[source] * share
        now = after
        for k, p in enumerate(now):
            total[k] += weight * p
    return total


@lru_cache(maxsize=256)
def _ahead(count: int, fail: frozenset[int], arcs: Arcs, hours: Decimal) -> Numbers:
    failed = _moved([D(k in fail) for k in range(count)], arcs, hours, ahead=True)
    return [D(1) if k in fail else p for k, p in enumerate(failed)]


@lru_cache(maxsize=256)
def _lives(count: int, fail: frozenset[int], arcs: Arcs) -> Numbers:
    """Return the mean hours to failure from each state; infinite where it is not certain."""
    below: dict[object, list[object]] = {k: [] for k in range(count)}
    rows = {k: {m: D(0) for m in (*range(count), -1)} for k in range(count)}
    for a, b, rate in arcs:
        below[a] += [b] if rate else []
        rows[a][a] += rate
        rows[a][b] -= rate
    never = {*range(count)} - reached(reversed_graph(below), fail)
    endless = reached(reversed_graph(below), never)
    left = [k for k in range(count) if k not in endless and k not in fail]
    for k in left:
        rows[k][-1] = D(1)  # of such equations the last column is the result
    for k in left:
        for other in left:
            if other != k and (factor := rows[other][k] / rows[k][k]):
                rows[other] = {m: p - factor * rows[k][m] for m, p in rows[other].items()}
    lives = {k: rows[k][-1] / rows[k][k] for k in left}
    return [D(0) if k in fail else lives.get(k, INF) for k in range(count)]


class _Chain:
    """The beliefs that there may be over the states of a chain."""

    def __init__(self, count: int, fail: Iterable[int], arcs: Arcs, first: int, age: float) -> None:
        if count > _MOST_STATES:
            raise TooMuchError
        self.count, self.fail = count, frozenset(fail)
        self.arcs = tuple(arc for arc in arcs if arc[0] not in self.fail and arc[0] != arc[1])
        self.lives = _lives(count, self.fail, self.arcs)
        self.beliefs = [_moved(self.sure_of(first), self.arcs, D(age), ahead=False)]

    def sure_of(self, state: int) -> list[Decimal]:
        return [D(k == state) for k in range(self.count)]

    def ahead(self, hours: Decimal) -> Numbers:
        """Return for each state how probable a failure within some hours is."""
        return _ahead(self.count, self.fail, self.arcs, hours)

    def look(self, belief: Numbers, hours: Decimal) -> Estimate:
        lives = (b * life for b, life in zip(belief, self.lives, strict=True) if b)
        return _sure(_sum(map(D.__mul__, belief, self.ahead(hours))), _sum(lives))

    def step(self, moment: Moment, completions: Sequence[set[int]], longest: Decimal) -> bool:
        """Let time pass and keep what is consistent; return whether nothing was."""
        later = [_moved(belief, self.arcs, moment.passed, ahead=False) for belief in self.beliefs]
        self.beliefs, wrong = [], True
        for states in completions:
            kept = [[p * (k in states) for k, p in enumerate(belief)] for belief in later]
            left = [[p / _sum(belief) for p in belief] for belief in kept if any(belief)]
            worst = max(states or self.fail, key=lambda k: (self.ahead(longest)[k], -k))
            self.beliefs += left or [self.sure_of(worst)]
            wrong = wrong and not left
        if all(belief == self.beliefs[0] for belief in self.beliefs):
            del self.beliefs[1:]
        return wrong


@lru_cache(maxsize=16)
def _rotors(
    name: str, positions: tuple[int, ...], rates: tuple[float, ...]
) -> tuple[dict[frozenset[int], int], _Chain]:
    """Return the sets of motors that may fail in flight, and the chain over them and the loss."""
    ring = _RINGS.get(name) or _RINGS[name.translate(str.maketrans("PN", "NP"))]
    count = len(rates)
    downs = (frozenset(row) for n in range(count) for row in combinations(range(count), n))
    flies = [down for down in downs if not any(fatal <= down for fatal in ring)]
    flying = {down: k for k, down in enumerate(flies)}
    arcs = [
        (k, flying.get(down | {place}, len(flying)), D(rate))
        for down, k in flying.items()
        for place, rate in zip(positions, rates, strict=True)
        if place not in down
    ]
    return flying, _Chain(len(flying) + 1, {len(flying)}, arcs, 0, 0.0)


def _bounds(rows: Sequence[Estimate], *, unknown: bool = False, wrong: bool = False) -> Estimate:
    """Return what lies ahead if any row may be right."""
    lows, highs, alive, lives, *_ = zip(*rows, strict=True)
    return Estimate(min(lows), max(highs), min(alive), min(lives), unknown, wrong)


Known = Mapping[str, Estimate]  # model -> what lies ahead of it


class _Mission:
    """The models of a system from the start of a mission on."""

    def __init__(self, system: ReliabilitySystem) -> None:
        self.system, self.models = system, system.used_models()
        self.longest = D(system.horizon)
        self.memory: dict[object, Any] = {}

    def grows(self) -> bool:
        """Return whether a failure only gets more probable with the horizon, for all one knows."""
        trees = [of.content for of in self.models if isinstance(of.content, FaultTree)]
        return all(gate.type not in {"NOT", "XOR"} for of in trees for gate in of.gates.values())

    def step(self, values: Values, moment: Moment) -> dict[str, Estimate]:
        """Return what lies ahead of each model."""
        known: dict[str, Estimate] = {}
        for model in self.models:
            look: Callable[..., Estimate] = getattr(self, f"_{model.type}")
            known[model.name] = look(model, values, moment, known)
        return known

    def _series(self, model: ComponentModel, _: Values, __: Moment, known: Known) -> Estimate:
        parts = [known[name] for name in model.uses]
        low = _gate("OR", None, [part.low for part in parts])
        high = _gate("OR", None, [part.high for part in parts])
        life = parts[0].life if len(parts) == 1 else None
        flags = any(part.unknown for part in parts), any(part.wrong for part in parts)
        return Estimate(low, high, _product(part.alive for part in parts), life, *flags)

    def _k_out_of_n(self, model: ComponentModel, given: Values, at: Moment, _: Known) -> Estimate:
        k, rate, most = model.values["k"], D(model.values["rate"]), model.values["max"]
        works = (-rate * at.horizon).exp()

        def failure(n: int) -> Decimal:
            cases = (math.comb(n, i) * works**i * (1 - works) ** (n - i) for i in range(k))
            return _sum(cases) if n >= k else D(1)

        n = given[input_id(model.name, "available")]
        if n is None:
            return Estimate(failure(most) if most else D(0), D(1), D(0), D(0), unknown=True)
        return _sure(
            failure(int(n)), _sum(1 / (i * rate) if rate else INF for i in range(k, int(n) + 1))
        )

    def _most(self, id_: str, value: float | None, limit: float) -> tuple[Decimal, bool]:
        """Return a value, or the worst that it may be, and whether it is known."""
        if value is None:
            return self.memory.get(id_, D(limit)), False
        self.memory[id_] = max(D(value), D(limit))
        return D(value), value <= limit

    def _heat(self, model: ComponentModel, given: Values) -> tuple[Decimal, bool]:
        """Return how many times faster it ages, and whether that is known (Arrhenius)."""
        of = model.values
        if "t_ref" not in of:
            return D(1), True
        id_ = input_id(model.name, "temperature")
        warm, is_known = self._most(id_, given[id_], of["t_max"])
        warmer = 1 / (D(of["t_ref"]) + D("273.15")) - 1 / (warm + D("273.15"))
        exponent = D(of["activation_energy"]) / D("8.617333262e-5") * warmer
        return min(exponent, D(700)).exp(), is_known

    def _battery(self, model: ComponentModel, given: Values, at: Moment, _: Known) -> Estimate:
        of, repair = model.values, bool(model.values.get("repair"))
        fails, alpha, beta, lower = (D(of[key]) for key in _BATTERY)
        arcs = [
            (b + x, b + x + y, rate)
            for b in (0, 2, 4)
            for x, y, rate in ((0, 1, alpha), (1, -1, beta), (0, 2, lower))
        ]
        arcs += [(b, 7, fails) for b in (0, 2, 4)]
        chain = _Chain(8, (6, 7), arcs, 0, 0.0)
        level = given[input_id(model.name, "level")]
        band, missed = self.memory.get((model.name, "band"), (4, False))
        seen = None if level is None else 1 + sum(level > edge for edge in (25, 50, 75))
        if seen is None:
            missed = band > 1
        elif seen > band and not repair:
            level = None if missed else level
        else:
            band, missed = seen, False
        self.memory[model.name, "band"] = band, missed
        factor, is_warm = self._heat(model, given)
        first = {4: 0, 3: 2, 2: 4}.get(band, 6)
        possible = [first] if level is not None else range(0 if repair else first, 8)
        failed = chain.ahead(factor * at.horizon)
        rows = [_sure(failed[k], chain.lives[k] / factor) for k in possible]
        if not is_warm:  # it may be so cold that nothing ages
            rows.append(rows[0]._replace(low=D(possible[0] >= 6)))
        return _bounds(rows, unknown=level is None or not is_warm)

    def _processor(self, model: ComponentModel, given: Values, at: Moment, _: Known) -> Estimate:
        of, shape = model.values, D(model.values["shape"])
        factor, is_warm = self._heat(model, given)
        id_ = input_id(model.name, "utilisation")
        load, is_load = self._most(id_, given[id_], of["u_max"])
        unknown, stress = not (is_warm and is_load), load * factor
        scale = D(of["mttf_ref"]) / D(f"{math.gamma(1.0 + 1.0 / of['shape']):.14g}")
        least, largest = self.memory.get(model.name, (D(of.get("age", 0.0)), D(of.get("age", 0.0))))
        largest += stress * at.passed
        least += stress * at.passed * (not unknown)
        self.memory[model.name] = least, largest
        ahead = stress * at.horizon
        ends = [((x + ahead) / scale) ** shape - (x / scale) ** shape for x in (least, largest)]
        low = D(0) if unknown else 1 - (-min(ends)).exp()
        is_steady = shape == 1 or not largest
        life = INF if not stress else D(of["mttf_ref"]) / stress if is_steady else None
        return Estimate(low, 1 - (-max(ends)).exp(), (-max(ends)).exp(), life, unknown)

    def _propulsion(self, model: ComponentModel, given: Values, at: Moment, _: Known) -> Estimate:
        of, name = model.values, model.values["configuration"]
        failed, before = dict[int, bool | None](), self.memory.get(model.name, {})
        for motor, place in enumerate(of["positions"]):
            key = "status" if of["status"] == "list" else f"motor_{motor}"
            value = given[input_id(model.name, key)]
            value = value[motor] if isinstance(value, list) else value
            is_down = before.get(place) is True and not of.get("repair")
            failed[place] = is_down or (None if value is None else not value)
        self.memory[model.name] = failed
        flying, chain = _rotors(name, tuple(of["positions"]), tuple(of["rates"]))
        sure, maybe = ({k for k, value in failed.items() if value is of_} for of_ in (True, None))
        rows = (sure.union(row) for n in range(len(maybe) + 1) for row in combinations(maybe, n))
        states = {flying.get(frozenset(down), len(flying)) for down in rows}
        ahead = chain.ahead(at.horizon)
        return _bounds([_sure(ahead[k], chain.lives[k]) for k in states], unknown=bool(maybe))

    def _markov(self, model: ComponentModel, given: Values, at: Moment, _: Known) -> Estimate:
        of = model.content
        assert isinstance(of, Chain)
        number = {state: k for k, state in enumerate(of.states)}
        chain: _Chain = self.memory.get(model.name) or _Chain(
            len(number),
            map(number.__getitem__, of.fail),
            [(number[arc.source], number[arc.target], D(arc.rate)) for arc in of.arcs],
            number[of.initial[0]],
            of.age,
        )
        self.memory[model.name] = chain

        def consistent(told: Values) -> set[int]:
            out = {number[seen.state] for seen in of.observe if told[seen.input] is seen.negated}
            return {*number.values()} - out

        missing = [*dict.fromkeys(seen.input for seen in of.observe if given[seen.input] is None)]
        rows = itertools.product((False, True), repeat=len(missing))
        sets = [consistent({**given, **dict(zip(missing, row, strict=True))}) for row in rows]
        every = consistent(given)
        if self.memory.get((model.name, "lost")):  # what is repaired is not in these vectors
            if of.repair:
                raise TooMuchError
            return _sure(D(1), D(0))._replace(wrong=bool(every) and not every & chain.fail)
        wrong, count = chain.step(at, sets, self.longest), len(chain.beliefs)
        self.memory[model.name, "lost"] = bool(every) and every <= chain.fail
        if count > 1 and (of.repair or count > sum(map(any, zip(*chain.beliefs, strict=True)))):
            raise TooMuchError  # only bounds of these are followed
        if not missing:
            beliefs = [chain.look(belief, at.horizon) for belief in chain.beliefs]
            return _bounds(beliefs, wrong=wrong)
        states = [chain.look(chain.sure_of(state), at.horizon) for state in sorted(every)]
        if not every or (not every & chain.fail and not all(sets)):  # else it has failed
            states.append(Estimate(states[0].low if states else D(1), D(1), D(0), D(0)))
        return _bounds(states, unknown=True, wrong=wrong)

    def _fault_tree(
        self, model: ComponentModel, given: Values, at: Moment, known: Known
    ) -> Estimate:
        of = model.content
        assert isinstance(of, FaultTree)
        tree: _Tree = self.memory.setdefault(model.name, _Tree(of))
        low: dict[str, Decimal] = {}
        high: dict[str, Decimal] = {}
        unknown = wrong = False
        for key in tree.events:
            event = of.events.get(key)
            if event is None:
                chain = self.memory.get((model.name, key)) or tree.order_chain(key)
                self.memory[model.name, key] = chain
                chain.step(at, [{*range(chain.count)}], self.longest)
                low[key] = high[key] = chain.look(chain.beliefs[0], at.horizon).high
                continue
            assert event.law is not None
            age = at.age + D(of.age if event.age is None else event.age)
            start, end = (age if event.observed else D(0)), age + at.horizon
            kind, numbers = event.law.kind, [*map(D, event.law.values)]
            if kind == "model":
                part = known[event.law.model]
                low[key], high[key] = part.low, part.high
                unknown, wrong = unknown or part.unknown, wrong or part.wrong
            else:
                shape = numbers[1] if kind == "weibull" else D(1)
                scale = numbers[0] if kind == "weibull" else 1 / numbers[0] if numbers[0] else INF
                low[key] = 1 - ((start / scale) ** shape - (end / scale) ** shape).exp()
                low[key] = high[key] = numbers[0] if kind == "fixed" else low[key]
            if event.observed:
                place, value = (model.name, key), given[input_id(model.name, key)]
                value = (self.memory.get(place) is True and not of.repair) or value
                self.memory[place], unknown = value, unknown or value is None
                low[key] = D(1) if value else low[key]
                high[key] = high[key] if value is False else D(1)
        if low != high and not tree.coherent:
            raise TooMuchError  # bounds of such trees depend on the order of the events
        best, worst = tree.failure(low), tree.failure(high)
        return Estimate(best, worst, 1 - worst, None, unknown, wrong)


class _Tree:
    """The probability of a fault tree, for each case of the events that several gates share."""

    def __init__(self, of: FaultTree) -> None:
        self.of, self.top = of, of.top
        keys = [key for key in of.reached()[0] if key in of.gates]
        self.gates = [key for key in keys if of.gates[key].type not in DYNAMIC]
        self.coherent = all(of.gates[key].type in ("OR", "AND", "VOTE") for key in self.gates)
        counts = Counter([of.top])
        for key in reversed(self.gates):
            for below in of.gates[key].of:
                counts[below] += counts[key]
        # the failure of a model is one event, however many events stand for it
        self.same = {
            key: f"model {event.law.model}"
            if event.law and event.law.model and not event.observed
            else key
            for key, event in of.events.items()
        }
        self.events = [key for key in counts if key not in self.gates]
        uses = Counter[str]()
        for key in self.events:
            uses[self.same.get(key, key)] += counts[key]
        self.shared = [key for key, count in uses.items() if count > 1]
        self.weight = len(self.gates) << len(self.shared)  # gates of all cases
        if of.approximate or self.weight > _MOST_CASES:
            raise TooMuchError

    def failure(self, chances: Mapping[str, Decimal]) -> Decimal:
        """Return the probability of the top event."""
        by_event = {self.same.get(key, key): p for key, p in chances.items()}
        total = D(0)
        for row in itertools.product((D(0), D(1)), repeat=len(self.shared)):
            case = dict(zip(self.shared, row, strict=True))
            sure = (by_event[key] if of else 1 - by_event[key] for key, of in case.items())
            if weight := math.prod(sure, start=D(1)):
                value = {key: {**by_event, **case}[self.same.get(key, key)] for key in chances}
                for key in self.gates:
                    gate = self.of.gates[key]
                    value[key] = _gate(gate.type, gate.k, [value[below] for below in gate.of])
                total += weight * value[self.top]
        return total

    def order_chain(self, key: str) -> _Chain:
        """Return the chain over the orders in which events below a dynamic gate happen."""
        gate = self.of.gates[key]
        laws = [self.of.events[below].law for below in gate.of]
        rates, last = [D(law.values[0]) for law in laws if law], len(laws)
        arcs = [(k, k + 1, rate) for k, rate in enumerate(rates)]
        arcs += [(k, last + 1, rate) for k in range(last) for rate in rates[k + 1 :]]
        if gate.type == "POR":
            arcs, last = [(0, 1, rates[0]), *((0, 2, rate) for rate in rates[1:])], 1
        if gate.type == "SAND":  # independent events are never at the same instant
            arcs = []
        return _Chain(len(laws) + 2, {last}, arcs, 0, self.of.age)


def _gate(kind: str, k: int | None, below: Sequence[Decimal]) -> Decimal:
    """Return how probable the output of a gate is, whose inputs are independent."""
    if kind == "AND" and below:
        return _product(below)
    if kind == "OR" and (p := 1 - _product(1 - p for p in below)) > _DUST:
        return p
    happened = [D(1)]  # so many of those so far
    for p in below:
        pairs = zip([*happened, D(0)], [D(0), *happened], strict=True)
        happened = [(1 - p) * same + p * fewer for same, fewer in pairs]
    if not below:
        return D(0)
    if kind == "XOR":
        return _sum(happened[1::2])
    if kind == "NOT":
        return happened[0]
    return _sum(happened[k or 1 :])


class _Input(NamedTuple):
    """An input: what is believed of it, and values that tell something, usual ones first."""

    type: str
    usual: Any
    tried: Sequence[Any]
    factor: tuple[int, int] | None
    limits: tuple[float, float, float] = (0.0, 0.0, 0.0)  # low, high, slack; length of a list

    def taken(self, raw: Any) -> Any:
        """Return the value that is believed, ``None`` for nothing."""
        raw = _IS.get(raw["is"]) if isinstance(raw, dict) else raw
        low, high, slack = self.limits
        if self.type == "bool[]":
            is_list = isinstance(raw, list) and len(raw) == high
            return [of if isinstance(of, bool) else None for of in raw] if is_list else None
        if self.type == "bool" or isinstance(raw, bool):
            return raw if self.type == "bool" and isinstance(raw, bool) else None
        if not isinstance(raw, int | float) or math.isnan(raw):
            return None
        number = raw * self.factor[0] / self.factor[1] if self.factor else float(raw)
        if not low - slack <= number <= high + slack or (self.type == "int" and number % 1.0):
            return None
        return min(max(number, low), high)

    def given(self, value: Any) -> Any:
        """Return a value in the unit of the message; where it is converted, not at an edge."""
        return value if self.factor is None else value * 0.999 * self.factor[1] / self.factor[0]


def _above(number: float) -> float:
    return math.nextafter(number, math.inf)


def _inputs(system: ReliabilitySystem, bound: Sequence[BoundInput]) -> dict[str, _Input]:
    end = system.horizon * 3600.0
    known: dict[str, tuple[list[Any], tuple[float, float, float]]] = {
        MISSION_END: ([end * 1.01, end / 2.0, 0.0, -5.0, end / 300.0], (-1e12, 1e12, 0.0))
    }
    for model in system.used_models():
        of, id_ = model.values, partial(input_id, model.name)
        if model.type == "k_out_of_n":
            k, most = of["k"], of["max"] or 10_000
            tried: list[Any] = [k, k - 1, min(most, k + 100), most + 1, float(k), 2.5, 0, -1]
            known[id_("available")] = tried, (0.0, float(most), 0.0)
        elif model.type == "battery":
            tried = [
                _above(100.5),
                100.5,
                *(f(e) for e in (75.0, 50.0, 25.0) for f in (_above, float)),
            ]
            tried += [0.0, -0.5, math.nextafter(-0.5, -1.0), 90, 60.0]
            known[id_("level")] = tried, (0.0, 100.0, 0.5)
        elif model.type == "propulsion":
            count = len(of["rates"])
            tried = [[k != motor for k in range(count)] for motor in range(count)]
            tried += [[None] + [True] * (count - 1), [True] * (count + 1)]
            known[id_("status")] = tried, (0.0, float(count), 0.0)
        elif model.type == "processor":
            most = of["u_max"]
            known[id_("utilisation")] = (
                [most, most / 2.0, _above(most), 0.0, -0.1],
                (0.0, _MAX, 0.0),
            )
        if "t_ref" in of:
            most = of["t_max"]
            tried = [most, _above(most), most + 10.0, of["t_ref"] - 20.0, -199.0, -201.0]
            known[id_("temperature")] = tried, (-200.0, _MAX, 0.0)
    about, inputs = {of.id: of for of in system.inputs()}, {}
    for input_ in bound:
        if (item := about.get(input_.id)) is not None:
            tried, limits = known.get(item.id, ([not item.sample], (0.0, 0.0, 0.0)))
            inputs[item.id] = _Input(item.type, item.sample, tried, input_.factor, limits)
    return inputs


class _Vectors:
    """Runs of a monitor."""

    def __init__(self, system: ReliabilitySystem, bound: Sequence[BoundInput]) -> None:
        self.system, self.inputs = system, _inputs(system, bound)
        self.quantum_ns, self.gap_ns = round(system.quantum * 1e9), round(system.usual_gap * 1e9)
        self.base = {id_: of.given(of.usual) for id_, of in self.inputs.items()}
        trees = (of.content for of in system.used_models() if isinstance(of.content, FaultTree))
        self.weight = 20 * len(system.components) + sum(_Tree(of).weight for of in trees)
        self.work = 0

    def run(self, name: str, changes: Changes) -> Run:
        """Return the steps with what comes out, up to one that depends on rounding."""
        system, mission = self.system, _Mission(self.system)
        judges = [Judge(of.activate, of.release, of.hold) for of in system.thresholds]
        values, told, steps = dict[str, Any](), dict[str, Any](), list[Step]()
        start = last = base = quanta = 0
        end, hours = system.horizon * 3600.0, self.quantum_ns / D(3_600_000_000_000)
        for now, new in changes:
            self.work += self.weight
            inputs = {**values, **new}
            taken = {id_: of.taken(inputs.get(id_)) for id_, of in self.inputs.items()}
            start, last = (start, last) if steps else (now, now)
            wrong = not 0 <= now - last <= self.gap_ns
            start, base = (now, quanta) if now < last else (start, base)
            due = base - (start - now) // self.quantum_ns
            passed, quanta, last, part = due - quanta, due, now, _GRID
            left = taken.get(MISSION_END)
            if left is not None and left > end * (1.0 + 1e-9):
                wrong, left = True, None
            elif left is not None:
                part = min(_GRID, max(0, math.ceil(left / end * _GRID - 1e-9)))
            moment = Moment(passed * hours, quanta * hours, D(system.horizon) * part / _GRID)
            try:
                found = mission.step(taken, moment)[system.top]
            except TooMuchError:
                break
            if system.mission_end and left is None:
                found = found._replace(low=D(0), unknown=True)
            high, wrong = float(found.high), wrong or found.wrong
            is_vague = system.mission_end and left is None and not mission.grows()
            if is_vague or _DUST < found.alive < _NEAR or any(of.is_near(high) for of in judges):
                break
            alive = found.alive if found.alive > _DUST else D(0)
            life = None if found.life == INF else found.life
            numbers = zip(_NUMBERS, (found.high, found.low, found.high, alive, life), strict=True)
            results: dict[str, Any] = {
                key: None if number is None else float(f"{number:.12g}") for key, number in numbers
            }
            results["valid"] = not (found.unknown or wrong)
            usable = results["valid"] or (system.worst_case and not wrong)
            for of, judge in zip(system.thresholds, judges, strict=True):
                results[of.id] = judge.step(now, high if usable else None)
            steps.append(Step(now, changed(values, inputs), changed(told, results)))
            values, told = inputs, results
        return Run(name, steps)

    def at_start(self, values: Values) -> Values | None:
        """Return the results of a first step."""
        return next((step.results for step in self.run("", [(0, values)]).steps), None)

    def patterns(self) -> tuple[list[Values], bool]:
        """Return observations at the start: all, or those that differ from the usual in one."""
        sources: list[list[Values]] = []
        for id_, of in self.inputs.items():
            seen: dict[str, Values] = {}
            for value in (*map(of.given, (of.usual, *of.tried)), None):
                seen.setdefault(text(self.at_start({**self.base, id_: value})), {id_: value})
            sources.append([*seen.values()])
        rows: Iterable[Sequence[Values]] = itertools.product(*sources)
        is_all = math.prod(map(len, sources)) <= _PATTERNS
        if not is_all:
            rows = ([one] for of in sources for one in of)
        few = itertools.islice(rows, _PATTERNS)
        return [merged([self.base, *row]) for row in few], is_all

    def changes(self, patterns: Sequence[Values]) -> Iterator[tuple[str, Changes]]:
        """Yield the name of each run and what changes in it."""
        base, q, gap = self.base, self.quantum_ns, self.gap_ns
        soon = 58 * q + gap
        times = [0, 1, q, q + 1, q + 1 + gap, q + 2 + 2 * gap, q + 2 + 3 * gap, q, 3 * q]
        yield "time", [(now, base) for now in (*times, _LATE, _LATE + q)]
        yield from (("start", [(0, pattern)]) for pattern in patterns)
        for id_, of in self.inputs.items():
            usual, odd = base[id_], [*map(of.given, of.tried)]
            none = [*_ODD, *((1, 0.5) if "bool" in of.type else ())]
            rows = {
                "value": enumerate(
                    [*(v for of_ in none for v in (usual, of_)), usual, *odd, usual]
                ),
                "missed": enumerate(
                    [
                        usual,
                        None,
                        usual,
                        usual,
                        *(v for of_ in odd for v in (of_, None)),
                        usual,
                        usual,
                    ]
                ),
            }
            for name, row in rows.items():
                yield f"{name}:{id_}", [(k * q, {**base, id_: value}) for k, value in row]
            for later in ([57 * q, 58 * q, soon, soon + _LATE], [_LATE]):
                failed = ((now, {**base, id_: odd[0]}) for now in later)
                yield f"later:{id_}", [(0, base), *failed]
        found = [(self.at_start(row), row) for row in patterns]
        known = [(of["p_fail"], row) for of, row in found if of is not None and of["valid"]]
        known.sort(key=lambda pair: pair[0])
        for threshold in self.system.thresholds:
            activate, release = threshold.activate, threshold.release
            good = [row for p, row in known if p <= activate][-1:]
            band = [row for p, row in known if activate < p <= release][:1]
            bad = [row for p, row in known if p > release][:1]
            hold = round(threshold.hold * 1e9)
            until = [*range(0, hold - 1, gap), hold - 1, hold] if hold else [0]
            if len(until) > _PATTERNS:
                continue
            kept = [(now, row) for row in good for now in until]
            falls = enumerate([*band, *good, *band, *bad, *band], 1)
            again = [(hold + 6 + now, row) for now, row in kept]
            yield (
                f"threshold:{threshold.id}",
                [*kept, *((hold + k, row) for k, row in falls), *again],
            )
            yield f"threshold:{threshold.id}", [(now, row) for row in band for now in until]
            n = self._last_below(activate)
            for ends in (n, n + 1) if n is not None and (n - 2) * q > hold else ():
                steps = ((ends * q - hold + now, base) for now in (-q, *until, hold + q))
                yield f"limits:{threshold.id}", [(0, base), *steps]
        if (n := self._last_below(0.75)) is not None:  # where less than half is alive
            yield "late", [(0, base), (n * q, base)]

    def _last_below(self, limit: float) -> int | None:
        """Return after how many quanta the probability of failure exceeds a limit, if it does."""

        def is_below(n: int) -> bool:
            steps = self.run("", [(0, self.base), (n * self.quantum_ns, self.base)]).steps
            numbers = {key: value for step in steps for key, value in step.results.items()}
            return len(steps) == 2 and numbers["p_fail"] <= limit

        low, high = 0, 2**61 // self.quantum_ns
        if not is_below(low) or is_below(high):
            return None
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if is_below(middle) else (low, middle)
        return low


def system_vectors(
    system: ReliabilitySystem, inputs: Sequence[BoundInput], about: Mapping[str, str]
) -> str:
    """Return the content of ``vectors.json``; empty for a system that is too large."""
    with localcontext(Context(prec=50)), suppress(TooMuchError):
        vectors = _Vectors(system, inputs)

        def rows() -> Iterator[Run | list[object]]:
            patterns, is_all = vectors.patterns()
            for name, changes in vectors.changes(patterns):
                run = vectors.run(name, changes)
                is_all = is_all and len(run.steps) == len(changes)
                yield from [run] if run.steps else []
                if vectors.work > _MOST_WORK:
                    raise TooMuchError
            yield from age_rows(inputs, vectors.base, vectors.at_start)
            if not is_all:
                raise TooMuchError

        return fitting_file(about, inputs, rows(), complete=True)
    return ""

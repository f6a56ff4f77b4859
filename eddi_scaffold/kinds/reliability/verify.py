"""Whether a generated reliability monitor is its chains and fault trees.

Exponentials are found by uniformisation in 50 digits, where nothing cancels (Jensen 1953). Sums of
products are read as events: a sum of disjoint ones, a product of independent ones. Functions of
events are reduced decision diagrams, so equal ones have one number (Bryant 1986).
"""

from __future__ import annotations

import ast
import math
import re
import sys
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext
from functools import reduce
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

from eddi_scaffold.evidence.emitted import Call, Class, Emitted, UnprovedError, data, reading
from eddi_scaffold.evidence.sums import returned, variables
from eddi_scaffold.kinds.reliability.system import (
    DYNAMIC,
    MISSION_END,
    Chain,
    ComponentModel,
    FaultTree,
    Law,
    ReliabilitySystem,
    input_id,
)

if TYPE_CHECKING:
    from eddi_scaffold.program.input_expressions import BoundInput

_CLOSE, _LEAST = Decimal("1e-12"), Decimal("1e-300")
"""Relative and absolute difference of two numbers that are equal."""
_GRID = 256  # parts of the longest horizon
_MOST_STEPS, _MOST_NODES = 2_000, 200_000
_LIMITS: Mapping[str, Mapping[str, float]] = {
    "level": {"high": 100.0, "slack": 0.5},
    "temperature": {"low": -200.0, "high": sys.float_info.max},
    "utilisation": {"high": sys.float_info.max},
    MISSION_END: {"low": -1e12, "high": 1e12},
}
_LARGE = ("large_tree.LargeTree", "large_tree.BoundedTree")
_FATAL = {
    "PNPN": "0 1 2 3",
    "PNPNPN": "01 12 23 34 45 50",
    "PPNNPN": "4 5 01 23",
    "PPNNPPNN": "01 23 45 67",
}
"""Direction of rotation of each motor -> least sets of motors whose loss is fatal."""


class _Chain(NamedTuple):
    """A chain by numbers of states."""

    size: int
    fail: tuple[int, ...]
    arcs: tuple[tuple[int, int, float], ...]  # with rates in 1/h
    first: int = 0
    age: float = 0.0

    def rows(self) -> list[dict[int, Decimal]]:
        """Return the rates from each state; failure is first passage."""
        rows: list[dict[int, Decimal]] = [{} for _ in range(self.size)]
        for source, target, rate in self.arcs:
            if source not in self.fail and source != target and rate > 0.0:
                rows[source][target] = rows[source].get(target, Decimal(0)) + Decimal(rate)
        return rows

    def after(self, hours: float, ends: Container[int]) -> list[Decimal]:
        """Return for each state the probability of being in some states after a time."""
        rows = self.rows()
        fastest = max(sum(row.values(), Decimal(0)) for row in rows) or Decimal(1)
        steps = math.ceil(fastest * Decimal(hours) / 10) or 1
        if steps * self.size > _MOST_STEPS:
            raise UnprovedError(None, "its rates are too high for its horizon")
        mean = fastest * Decimal(hours) / steps
        result = [Decimal(state in ends) for state in range(self.size)]
        for _ in range(steps):
            term, weight, result = result, (-mean).exp(), [Decimal(0)] * self.size
            for k in range(1, self.size + 100):
                result = [a + weight * b for a, b in zip(result, term, strict=True)]
                weight *= mean / k
                term = [
                    sum(
                        (rate / fastest * term[target] for target, rate in row.items()),
                        (1 - sum(row.values()) / fastest) * term[state],
                    )
                    for state, row in enumerate(rows)
                ]
        return result

    def endless(self) -> list[int]:
        """Return the states from which failure is not certain."""

        def reaching(states: Iterable[int]) -> set[int]:
            found = {*states}
            while more := {k for k, row in enumerate(rows) if found & {*row}} - found:
                found |= more
            return found

        rows, states = self.rows(), {*range(self.size)}
        return sorted(reaching(states - reaching(self.fail)) - {*self.fail})

    def lives(self) -> list[Decimal]:
        """Return the mean hours to failure from each state, by elimination."""
        rows, endless = self.rows(), self.endless()
        lives = [Decimal("inf") if k in endless else Decimal(0) for k in range(self.size)]
        states = [k for k in range(self.size) if k not in {*self.fail, *endless}]
        cost = dict.fromkeys(states, Decimal(1))
        for place, state in reversed([*enumerate(states)]):
            for other in states[:place]:
                share = rows[other].pop(state, Decimal(0)) / sum(rows[state].values())
                cost[other] += share * cost[state]
                for target, rate in rows[state].items():
                    if target != other:
                        rows[other][target] = rows[other].get(target, Decimal(0)) + share * rate
        for state in states:
            later = sum(rate * lives[target] for target, rate in rows[state].items())
            lives[state] = (cost[state] + later) / sum(rows[state].values())
        return lives

    def ahead(self, hours: float) -> list[tuple[Decimal, ...]]:
        """Return for each state: failed and alive after a time, mean hours to failure."""
        alive = self.after(hours, {*range(self.size)}.difference(self.fail))
        return [*zip(self.after(hours, self.fail), alive, self.lives(), strict=True)]


class _Diagrams:
    """Functions of events by number; a node is (place of its event, if it happens, if not)."""

    def __init__(self, order: Sequence[int]) -> None:
        self.nodes = [(len(order), 0, 0), (len(order), 1, 1)]
        self._known: dict[tuple[int, int, int], int] = {}
        self._chosen: dict[tuple[int, ...], int] = {}
        self.events = {event: self._node((place, 1, 0)) for place, event in enumerate(order)}

    def _node(self, node: tuple[int, int, int]) -> int:
        if len(self.nodes) > _MOST_NODES:
            raise UnprovedError(None, "its decision diagram is too large")
        if node not in self._known:
            self._known[node] = len(self.nodes)
            self.nodes.append(node)
        return self._known[node]

    def choice(self, *of: int) -> int:
        """Return the function: if the first, then the second, else the third."""
        if of[0] < 2 or of[1] == of[2]:
            return of[1] if of[0] else of[2]
        if of not in self._chosen:
            top = min(self.nodes[k][0] for k in of)
            high, low = (
                self.choice(*(self.nodes[k][at] if self.nodes[k][0] == top else k for k in of))
                for at in (1, 2)
            )
            self._chosen[of] = high if high == low else self._node((top, high, low))
        return self._chosen[of]

    def gate(self, type_: str, of: Sequence[int], k: int = 0) -> int:
        """Return the function of a gate."""
        if type_ == "NOT" and of:
            return self.choice(of[0], 0, 1)
        if type_ == "XOR":
            return reduce(lambda a, b: self.choice(a, self.choice(b, 0, 1), b), of, 0)
        row = [1] + [0] * {"AND": len(of), "VOTE": k}.get(type_, 1)  # at least 0, 1, ... of those
        for one in of:
            row = [1, *(self.choice(one, fewer, many) for fewer, many in pairwise(row))]
        return row[-1]

    def is_monotone(self, function: int) -> bool:
        """Return whether no event makes it false that was true."""
        below, waiting = set[int](), [function]
        while waiting:
            if (of := waiting.pop()) not in below:
                below.add(of)
                waiting += self.nodes[of][1:]
        nodes = (self.nodes[of] for of in below)
        return not any(self.choice(low, self.choice(high, 0, 1), 0) for _, high, low in nodes)


@dataclass(frozen=True)
class _Chance:
    """The probability of a function of independent events, as far as sums allow that."""

    diagrams: _Diagrams
    function: int
    events: frozenset[int] = frozenset()

    def _with(self, other: _Chance, *choice: int) -> _Chance:
        function = self.diagrams.choice(*choice)
        return _Chance(self.diagrams, function, self.events | other.events)

    def __add__(self, other: _Chance) -> _Chance:
        if self.diagrams.choice(self.function, other.function, 0):
            raise UnprovedError(None, "a sum is of events that are not disjoint")
        return self._with(other, self.function, 1, other.function)

    def __sub__(self, other: _Chance) -> _Chance:
        if self.function != 1:
            raise UnprovedError(None, "a difference is not from one")
        return self._with(other, other.function, 0, 1)

    def __mul__(self, other: _Chance) -> _Chance:
        if self.events & other.events:
            raise UnprovedError(None, "a product is of events that are not independent")
        return self._with(other, self.function, other.function, 0)


def verify(system: ReliabilitySystem, emitted: Emitted) -> Iterator[str]:
    """Compare a text with a system; yield what is proved."""
    with localcontext() as context:
        context.prec = 50
        yield from [*_System(system, emitted).proved()]


class _System:
    def __init__(self, system: ReliabilitySystem, emitted: Emitted) -> None:
        self.system, self.emitted = system, emitted
        self.uses: dict[str, list[str]] = {}  # inputs of a model, and of those that it uses
        self.rules: dict[str, Call] = {}
        if system.mission_end:
            self._input("", MISSION_END, "float", **_LIMITS[MISSION_END])

    def proved(self) -> Iterator[str]:
        """Yield what is proved."""
        system, emitted = self.system, self.emitted
        monitor = emitted.monitor("reliability.Reliability")
        lines = monitor.method("_models", "self")
        node = lines.take("return V")["V"]
        lines.end()
        written, models = data(node), {}
        for place, model in enumerate(system.used_models()):
            of = written.get(model.name) if isinstance(written, dict) else None
            args = (of.args if isinstance(of, Call) else None) or ()
            models[model.name] = self._model(place, model, node, args)
        emitted.same("models", node, models)
        inputs = [of for of in emitted.declared.inputs if of.id in self.rules]
        rows = ((of.id, of.activate, of.release, round(of.hold * 1e9)) for of in system.thresholds)
        expected = {
            "rules": {input_.id: self.rules[input_.id] for input_ in inputs},
            "top": system.top,
            "uses": tuple(dict.fromkeys(self.uses[system.top])),
            "horizon": system.horizon,
            "moving": system.mission_end or None,
            "quantum_ns": round(system.quantum * 1e9),
            "max_gap_ns": round(system.usual_gap * 1e9),
            "thresholds": tuple(Call("reliability.Threshold", row) for row in rows) or None,
            "worst_case": system.worst_case or None,
        }
        for name, value in expected.items():
            emitted.attribute(monitor, name, value)
        monitor.body("_read", "self, source", self._read(inputs))
        emitted.end(monitor)
        yield f"{', '.join(models)}: numbers to {_CLOSE}, fault trees as functions; thresholds"

    def _read(self, inputs: Sequence[BoundInput]) -> str:
        """Return the lines that read the inputs, and take usual values as they are."""
        if not inputs:
            return "return {}"
        usual = []
        for k, input_ in enumerate(inputs):
            (type_,), limits = self.rules[input_.id].args or (), self.rules[input_.id].keywords
            usual.append(f"type(v{k}) is {type_}")
            if type_ == "float" and input_.factor is None:
                usual.append(f"{limits.get('low', 0.0)!r} <= v{k} <= {limits['high']!r}")
            elif type_ != "bool":  # its value always has to be looked at
                usual.append("False")
        names = "".join(f"v{k}, " for k in range(len(inputs)))
        read = "".join(f"{reading(input_.attribute)}, " for input_ in inputs)
        known = ", ".join(f"{input_.id!r}: v{k}" for k, input_ in enumerate(inputs))
        lines = f"try:\n    raw = {names} = ({read})\n"
        lines += "except Exception:\n    return super()._read(source)\n"
        if "False" not in usual:
            lines += f"if {' and '.join(usual)}:\n    return {{{known}}}\n"
        return f"{lines}return self._believed(raw)"

    def _input(self, model: str, id_: str, type_: str, **limits: float) -> str:
        self.rules.setdefault(id_, Call("reliability.Rule", (type_,), limits))
        self.uses.setdefault(model, []).append(id_)
        return id_

    def _model(
        self, place: int, model: ComponentModel, node: ast.expr, written: Sequence[Any]
    ) -> Call:
        """Return the call that makes a model; numbers are those written, where they are close."""
        content, values, name, system = model.content, model.values, model.name, self.system
        uses = self.uses.setdefault(name, [])

        def input_(key: str, type_: str, **limits: float) -> str:
            return self._input(name, input_id(name, key), type_, **limits)

        def numbers(*keys: str) -> tuple[float, ...]:
            return tuple(float(values.get(key, 0.0)) for key in keys)

        more: dict[str, Any] = {"repair": True} if values.get("repair") else {}
        if isinstance(content, FaultTree):
            self._tree(place, name, content)
            return Call(f"Tree{place}", ())
        if isinstance(content, Chain):
            number = content.states.index
            for seen in content.observe:
                self._input(name, seen.input, "bool")
            arcs = tuple((number(of.source), number(of.target), of.rate) for of in content.arcs)
            fail, first = tuple(map(number, content.fail)), number(content.initial[0])
            self._chain(
                f"Chain{place}", _Chain(len(content.states), fail, arcs, first, content.age)
            )
            observe = tuple((number(of.state), of.input, of.negated) for of in content.observe)
            more = {"observe": observe} if observe else {}
            more |= {"repair": True} if content.repair else {}
            return Call("observed.MarkovChain", (Call(f"Chain{place}", ()),), more)
        if model.type == "series":
            for used in model.uses:
                uses += self.uses[used]
            return Call("units.Series", model.uses)
        if model.type == "k_out_of_n":
            most = 10_000.0 if values["max"] is None else float(values["max"])
            available = input_("available", "int", high=most)
            return Call("units.KOutOfN", (values["k"], *numbers("rate"), values["max"], available))
        if model.type == "propulsion":
            motors = sorted(range(len(values["rates"])), key=values["positions"].__getitem__)
            chain, sets = _rotors(values["configuration"], [values["rates"][m] for m in motors])
            ahead = Call(f"Chain{place}", ())
            if system.mission_end:
                self._chain(ahead.name, chain)
            else:
                rows = getattr(written[0] if written else None, "args", None)
                self._near(node, f"what lies ahead of {name},", rows, [chain.ahead(system.horizon)])
                ahead = Call("rotors.Rows", rows)
            if values["status"] == "list":
                status = input_("status", "bool[]", length=len(motors))
                inputs: Any = tuple((status, motor) for motor in motors)
            else:
                inputs = tuple((input_(f"motor_{motor}", "bool"), None) for motor in motors)
            return Call("rotors.Propulsion", (ahead, sets, inputs), more)
        level = model.type == "battery" and input_("level", "float", **_LIMITS["level"])
        if "t_ref" in values:
            keys = ("activation_energy", "t_ref", "t_max")
            more["heat"] = Call("laws.Arrhenius", numbers(*keys))
            limits = _LIMITS["temperature"]
            more["temperature"] = input_("temperature", "float", **limits)
        if level:
            chain = _battery(*numbers("failure_rate", "alpha", "beta", "degradation"))
            lives = written[2] if len(written) > 2 else None
            self._near(node, f"mean lives of {name}", lives, chain.lives())
            return Call("battery.Battery", (level, chain.arcs, lives, system.horizon), more)
        more["load"] = (input_("utilisation", "float", **_LIMITS["utilisation"]), values["u_max"])
        more |= {"age": numbers("age")[0]} if numbers("age")[0] else {}
        return Call("processor.Processor", numbers("mttf_ref", "shape"), more)

    def _near(self, node: ast.AST, what: str, written: Any, expected: Any) -> None:
        """Compare a number, or rows of them, that need not be the same to the last digit."""
        if isinstance(expected, list | tuple):
            if not isinstance(written, list | tuple) or len(written) != len(expected):
                raise UnprovedError(node, f"{what} has not {len(expected)} numbers")
            for k, (row, of) in enumerate(zip(written, expected, strict=True), 1):
                self._near(node, f"{what} {k}", row, of)
        elif type(written) is not float or not (
            abs(Decimal(written) - expected) <= _CLOSE * expected + _LEAST
            if expected.is_finite()
            else written == math.inf
        ):
            self.emitted.differs(node, f"{what} is {written!r}, the model says {expected:.15g}")

    def _class(self, name: str, *bases: str) -> Class:
        of = self.emitted.classes.pop(name, None)
        if of is None or of.base not in bases:
            raise UnprovedError(
                getattr(of, "node", None), f"there is no {name} that is {' or '.join(bases)}"
            )
        return of

    def _chain(self, name: str, chain: _Chain) -> None:
        """Take the class of a chain: its numbers, or what the runtime finds them from."""
        of = self._class(name, "chain.Chain", "large_chain.LargeChain")
        horizon, moving = self.system.horizon, self.system.mission_end
        hours, part, states = self.system.quantum / 3600.0, horizon / _GRID, range(chain.size)
        expected: dict[str, Any] = {"fail": chain.fail, "steps": _GRID if moving else None}
        if of.base == "large_chain.LargeChain":
            expected |= {
                "count": chain.size,
                "initial": chain.first or None,
                "endless": tuple(chain.endless()) or None,
                "age": chain.age or None,
                "hours": hours,
                "horizon": part if moving else horizon,
                "arcs": chain.arcs,
            }
        for key, value in expected.items():
            self.emitted.attribute(of, key, value)
        if of.base == "chain.Chain":
            ahead = chain.ahead(0.0 if moving else horizon)
            first = [chain.after(chain.age, [state])[chain.first] for state in states]
            near: dict[str, Any] = {"first": first, "ahead": ahead}
            if moving:
                columns = (chain.after(part, [state]) for state in states)
                near["grid"] = [*zip(*columns, strict=True)]
            for key, value in near.items():
                node = of.attributes.pop(key, ast.Constant(None))
                self._near(node, f"{key} of {name}", data(node), value)
            self._sums(of, "quantum", "", [chain.after(hours, [state]) for state in states])
            failed, alive, lives = zip(*ahead, strict=True)
            lasting = [life if life.is_finite() else Decimal(0) for life in lives]
            ends = [[Decimal(k in those) for k in states] for those in (chain.endless(), states)]
            if not moving:
                self._sums(of, "look", ", at", [failed, alive, lasting, *ends])
        self.emitted.end(of)

    def _sums(self, of: Class, name: str, more: str, expected: Sequence[Sequence[Decimal]]) -> None:
        """Take a method that returns sums of weighted probabilities of the states."""
        function, states = of.methods.pop(name, of.node), range(len(expected[0]))
        sums = returned(function, f"self, belief{more}", {"belief": variables(states)})
        products = {of for terms in sums for of, factor in terms.items() if factor}
        if not products <= {(k,) for k in states}:
            raise UnprovedError(function, "it is no sum over the states")
        written = [[float(of.get((k,), 0)) for k in states] for of in sums]
        self._near(function, f"{name} of {of.node.name}", written, expected)

    def _tree(self, place: int, name: str, tree: FaultTree) -> None:
        """Take the class of a fault tree."""
        of = self._class(f"Tree{place}", "tree.FaultTree", *_LARGE)
        keys, _ = tree.reached()
        dynamic = [key for key in keys if key in tree.gates and tree.gates[key].type in DYNAMIC]
        ordered = {below for key in dynamic for below in tree.gates[key].of}
        number: dict[str, int] = {}  # of what is an event at run time
        shared: dict[str, int] = {}  # model -> the event that it has failed
        certain: dict[int, int] = {}
        rows: dict[str, list[Any]] = {"names": [], "observed": [], "models": [], "orders": []}
        laws: list[str] = []
        for key in (key for key in keys if key in tree.events and key not in ordered):
            event, at = tree.events[key], len(laws)
            law, seen = event.law, event.observed
            assert law is not None, "a checked tree has the law of each event"
            number[key] = shared.setdefault(law.model, at) if law.model and not seen else at
            if number[key] < at:
                continue
            rows["names"].append(event.name)
            laws.append(_law(law, tree.age if event.age is None else event.age, seen))
            if law.model:
                rows["models"].append((at, law.model))
                self.uses[name] += self.uses[law.model]
            if seen:
                id_ = self._input(name, input_id(name, key), "bool")
                rows["observed"].append((at, id_))
            elif law.kind in ("fixed", "exponential") and law.values[0] == 0.0:
                certain[at] = 0
            elif (law.kind, law.values) == ("fixed", (1.0,)):
                certain[at] = 1
        for key in dynamic:
            at, gate = len(laws), tree.gates[key]
            number[key] = at
            rows["names"].append(key)
            laws.append("0.0")
            if gate.type == "SAND":
                certain[at] = 0  # independent events never happen at the same instant
                continue
            rates = [law.values[0] for below in gate.of if (law := tree.events[below].law)]
            self._chain(f"Order{at}of{place}", _order(gate.type, rates, tree.age))
            rows["orders"].append((at, Call(f"Order{at}of{place}")))
        for key, value in rows.items():
            self.emitted.attribute(of, key, tuple(value) or None)
        self.emitted.attribute(of, "repair", tree.repair or None)
        text = f"return [{', '.join(laws)}]"
        for line in ("expm1 = tree.expm1", "until = age + horizon"):
            text = f"{line}\n{text}" if line.split()[0] in text else text
        of.body("laws", "self, age, horizon", text)
        if of.base == "large_tree.BoundedTree":
            certain.clear()
        is_read = bool(rows["observed"] or rows["models"])
        self._function(of, tree, number, certain, is_read=is_read)
        self.emitted.end(of)

    def _function(
        self,
        of: Class,
        tree: FaultTree,
        number: Mapping[str, int],
        certain: Mapping[int, int],
        *,
        is_read: bool,
    ) -> None:
        """Take what gives the probability of the top event: sums, a diagram or cut sets."""
        events = sorted({*number.values()})
        cut_sets, modules = (of.attributes.pop(key, None) for key in ("sets", "modules"))
        nodes = data(modules) if modules is not None else ()
        # Any order gives a diagram; that of the text, from the top down, gives a small one.
        used = [row[0] for module, _ in nodes for row in module]
        for method in of.methods.values():
            used += [int(k) for k in re.findall(r"\bq(\d+)(?! =)", ast.unparse(method))]
        order = dict.fromkeys(k for k in [*reversed(used), *events] if k in events)
        diagrams, values = _Diagrams([*order]), dict[str, int]()
        for key in tree.reached()[0]:
            if key in number:
                values[key] = certain.get(number[key], diagrams.events[number[key]])
            elif key in tree.gates:
                gate = tree.gates[key]
                values[key] = diagrams.gate(gate.type, [values[k] for k in gate.of], gate.k or 0)
        top, grows = values[tree.top], of.attributes.pop("grows", None)
        if grows is None and not diagrams.is_monotone(top):
            self.emitted.differs(of.node, "more failures can be better, and grows is True")
        if grows is not None:
            self.emitted.same("grows", grows, expected=False)
        never, always = (_Chance(diagrams, k) for k in (0, 1))
        chances = [_Chance(diagrams, diagrams.events[k], frozenset({k})) for k in events]
        given: list[tuple[str, ast.AST, Any, int]] = []
        for what, wanted in (("failure", top), ("survival", diagrams.choice(top, 0, 1))):
            if of.base == "tree.FaultTree":
                function, constants = of.methods.pop(what, of.node), {0.0: never, 1.0: always}
                sums = returned(function, "self, q", {"q": [*chances]}, constants.get)
                given.append((what, function, sums, wanted))
        for module, root in nodes:
            rows = [never, always]
            for variable, high, low in module:
                if min(variable, high, low) < 0:
                    raise UnprovedError(modules)
                chance = chances[variable]
                rows.append(chance * rows[high] + (always - chance) * rows[low])
            chances.append(rows[root])
        if modules is not None:
            given.append(("modules", modules, chances[-1], top))
        elif of.base == "large_tree.LargeTree" or (grows is not None and is_read):
            raise UnprovedError(of.node, "its diagram is missing")
        if of.base == "large_tree.BoundedTree":
            cuts = [] if cut_sets is None else data(cut_sets)
            ands = [diagrams.gate("AND", [diagrams.events[k] for k in cut]) for cut in cuts]
            either = _Chance(diagrams, diagrams.gate("OR", ands))
            given.append(("sets", cut_sets or of.node, either, top))
            if any({*a} <= {*b} for a in cuts for b in cuts if a is not b):
                self.emitted.differs(cut_sets, "cut sets are not minimal")
        elif cut_sets is not None:
            raise UnprovedError(cut_sets)
        for what, node, got, wanted in given:
            if getattr(got, "function", None) != wanted:
                text = f"{what} of {of.node.name} is another function of the events"
                self.emitted.differs(node, text)


def _law(law: Law, age: float, is_observed: bool) -> str:
    """Return the probability of an event as Python."""
    values = law.values
    if law.kind == "exponential":
        until = f"({age!r} + until)" if age else "until"
        return f"-expm1({-values[0]!r} * {'horizon' if is_observed else until})"
    if law.kind == "weibull":
        before = f"{age!r} + age" if age else "age"
        times = f"{before}, horizon" if is_observed else f"0.0, {before} + horizon"
        return f"tree.weibull({times}, {values[0]!r}, {values[1]!r})"
    return repr(values[0]) if law.kind == "fixed" else "0.0"


def _battery(failure: float, alpha: float, beta: float, degradation: float) -> _Chain:
    """Return the chain of charge: bands of use and of recovery, empty, failed."""
    arcs = []
    for b in (0, 2, 4):
        arcs += [(b, b + 1, alpha), (b + 1, b, beta), (b, b + 2, degradation), (b, 7, failure)]
    return _Chain(8, (6, 7), tuple(arcs))


def _order(gate: str, rates: Sequence[float], age: float) -> _Chain:
    """Return the chain over the orders in which the inputs of a dynamic gate occur."""
    if gate == "POR":
        return _Chain(3, (1,), ((0, 1, rates[0]), (0, 2, math.fsum(rates[1:]))), age=age)
    lost, arcs = len(rates) + 1, []
    for done, rate in enumerate(rates):
        arcs.append((done, done + 1, rate))
        arcs += [(done, lost, other) for other in rates[done + 1 :]]
    return _Chain(lost + 1, (len(rates),), tuple(arcs), age=age)


def _rotors(
    configuration: str, rates: Sequence[float]
) -> tuple[_Chain, tuple[tuple[int, ...], ...]]:
    """Return the chain over the sets of failed motors with which a frame flies, and these sets."""
    mirrored = configuration.translate(str.maketrans("PN", "NP"))
    fatal = [{*map(int, of)} for of in (_FATAL.get(configuration) or _FATAL[mirrored]).split()]
    sets, arcs = [frozenset[int]()], []
    for failed in sets:
        for motor in {*range(len(rates))} - failed:
            after = failed | {motor}
            if after not in sets and not any(of <= after for of in fatal):
                sets.append(after)
            arcs.append((failed, after, float(rates[motor])))
    number = {of: k for k, of in enumerate(sets)}
    rows = tuple((number[a], number.get(b, len(sets)), rate) for a, b, rate in arcs)
    return _Chain(len(sets) + 1, (len(sets),), rows), tuple(tuple(sorted(of)) for of in sets)

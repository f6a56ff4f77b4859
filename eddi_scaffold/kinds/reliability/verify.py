"""Whether a generated reliability monitor is its chains and fault trees.

Numbers of small chains are compared with exact ones, small fault trees as functions of their
events, all else as data. What is computed in arrays or from tables is not proved.
"""

from __future__ import annotations

import ast
import math
import sys
from collections.abc import Iterator, Sequence
from decimal import localcontext
from typing import TYPE_CHECKING, Any

from eddi_scaffold.evidence.emitted import Call, Class, Emitted, UnprovedError, data, reading
from eddi_scaffold.kinds.reliability import exact
from eddi_scaffold.kinds.reliability.exact import INF, ONE, D, after
from eddi_scaffold.kinds.reliability.sums import Polynomial, returned, variables
from eddi_scaffold.kinds.reliability.system import (
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

_CLOSE, _LEAST = D("1e-12"), D("1e-300")
"""Relative and absolute difference of two numbers that are equal."""
_GRID, _WRITTEN_OUT = 256, 8  # prepared horizons; states of chains whose sums are written out
_LIMITS = {
    "level": {"high": 100.0, "slack": 0.5},
    "temperature": {"low": -200.0, "high": sys.float_info.max},
    "utilisation": {"high": sys.float_info.max},
}


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

    def proved(self) -> Iterator[str]:
        """Yield what is proved."""
        system, emitted = self.system, self.emitted
        monitor = emitted.monitor("reliability.Reliability")
        if system.mission_end:
            limits = {"low": -1e12, "high": 1e12}
            self.rules[MISSION_END] = Call("reliability.Rule", ("float",), limits)
        lines = monitor.method("_models", "self")
        self.node = node = lines.returned()
        lines.end()
        written, models = data(node), {}
        for place, model in enumerate(system.used_models()):
            call = written.get(model.name) if isinstance(written, dict) else None
            args = (call.args if isinstance(call, Call) else None) or ()
            models[model.name] = self._model(place, model, args)
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
        usual: list[str] = []
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
        text = f"try:\n    raw = {names} = ({read})\n"
        text += "except Exception:\n    return super()._read(source)"
        if "False" not in usual:
            text += f"\nif {' and '.join(usual)}:\n    return {{{known}}}"
        return f"{text}\nreturn self._believed(raw)"

    def _input(self, model: str, id_: str, type_: str, **limits: float) -> str:
        self.rules.setdefault(id_, Call("reliability.Rule", (type_,), limits))
        self.uses[model].append(id_)
        return id_

    def _model(self, place: int, model: ComponentModel, written: Sequence[Any]) -> Call:
        """Return the call that makes a model; numbers are those written, where they are close."""
        content, values, name = model.content, model.values, model.name
        self.uses[name] = [id_ for used in model.uses for id_ in self.uses[used]]
        more: dict[str, Any] = {"repair": True} if values.get("repair") else {}

        def input_(key: str) -> str:
            return self._input(name, input_id(name, key), "float", **_LIMITS[key])

        if isinstance(content, FaultTree):
            self._tree(place, name, content)
            return Call(f"Tree{place}", ())
        if isinstance(content, Chain):
            for seen in content.observe:
                self._input(name, seen.input, "bool")
            number = content.states.index
            chain = exact.markov(content)
            self._chain(f"Chain{place}", chain, number(content.initial[0]), content.age)
            rows = tuple((number(of.state), of.input, of.negated) for of in content.observe)
            more = {"observe": rows} if rows else {}
            more |= {"repair": True} if content.repair else {}
            return Call("observed.MarkovChain", (Call(f"Chain{place}", ()),), more)
        if model.type == "series":
            return Call("units.Series", model.uses)
        if model.type == "k_out_of_n":
            most = 10_000.0 if values["max"] is None else float(values["max"])
            available = self._input(name, input_id(name, "available"), "int", high=most)
            rate = float(values["rate"])
            return Call("units.KOutOfN", (values["k"], rate, values["max"], available))
        if model.type == "propulsion":
            return Call("rotors.Propulsion", tuple(self._rotors(place, model, written)), more)
        level = input_("level") if model.type == "battery" else ""
        if "t_ref" in values:
            keys = ("activation_energy", "t_ref", "t_max")
            more["heat"] = Call("laws.Arrhenius", tuple(float(values[key]) for key in keys))
            more["temperature"] = input_("temperature")
        if level:
            chain, means = exact.battery(values), written[2] if len(written) > 2 else None
            self._near(self.node, f"mean lives of {name}", means, exact.lives(chain))
            return Call("battery.Battery", (level, chain.arcs, means, self.system.horizon), more)
        more["load"] = (input_("utilisation"), values["u_max"])
        more |= {"age": float(values["age"])} if values.get("age") else {}
        numbers = float(values["mttf_ref"]), float(values["shape"])
        return Call("processor.Processor", numbers, more)

    def _rotors(self, place: int, model: ComponentModel, written: Sequence[Any]) -> Sequence[Any]:
        """Return the arguments of propulsion."""
        chain, sets = exact.rotors(model.values)
        if self.system.mission_end:
            self._chain(f"Chain{place}", chain)
            ahead = Call(f"Chain{place}", ())
        else:
            rows = written[0].args if written and isinstance(written[0], Call) else None
            self._near(self.node, f"rotors of {model.name}", rows, [self._ahead(chain)])
            ahead = Call("rotors.Rows", rows)
        count = len(model.values["rates"])
        by_place = sorted(range(count), key=model.values["positions"].__getitem__)
        inputs: dict[int, tuple[str, int | None]]
        if model.values["status"] == "list":
            id_ = self._input(model.name, input_id(model.name, "status"), "bool[]", length=count)
            inputs = {motor: (id_, motor) for motor in by_place}
        else:
            ids = ((motor, input_id(model.name, f"motor_{motor}")) for motor in by_place)
            inputs = {motor: (self._input(model.name, id_, "bool"), None) for motor, id_ in ids}
        return ahead, tuple(sets), tuple(inputs[motor] for motor in by_place)

    def _ahead(self, chain: exact.Markov) -> list[tuple[D, ...]]:
        """Return for each state: failed and alive at the horizon, mean life in hours."""
        hours = D(0 if self.system.mission_end else self.system.horizon)
        failed = after(chain, hours, frozenset(chain.fail))
        alive = after(chain, hours, frozenset({*range(chain.size)} - {*chain.fail}))
        return [*zip(failed, alive, exact.lives(chain), strict=True)]

    def _near(self, node: ast.AST, what: str, written: Any, expected: Any) -> None:
        """Compare a number, or rows of them, that need not be the same to the last digit."""
        if not isinstance(expected, D):
            if not isinstance(written, list | tuple) or len(written) != len(expected):
                raise UnprovedError(node, f"{what} has not {len(expected)} numbers")
            for k, (row, of) in enumerate(zip(written, expected, strict=True), 1):
                self._near(node, f"{what} {k}", row, of)
        elif type(written) is not float or not (
            abs(D(written) - expected) <= _CLOSE * expected + _LEAST * (expected > 0)
            if expected.is_finite()
            else written == math.inf
        ):
            self.emitted.differs(node, f"{what} is {written!r}, the model says {expected:.15g}")

    def _class(self, name: str, base: str) -> Class:
        of = self.emitted.classes.pop(name, None)
        if of is None or of.base != base:
            raise UnprovedError(of.node if of else None, f"there is no {name} that is {base}")
        return of

    def _chain(self, name: str, chain: exact.Markov, initial: int = 0, age: float = 0.0) -> None:
        """Take the class of a chain: its numbers, and sums of them; or what they are made of."""
        system, states = self.system, range(chain.size)
        quantum, horizon = system.quantum / 3600.0, system.horizon
        part = horizon / _GRID if system.mission_end else horizon
        steps = _GRID if system.mission_end else None
        if chain.size > _WRITTEN_OUT:
            large = self._class(name, "large_chain.LargeChain")
            data_of: dict[str, object] = {"count": chain.size, "initial": initial or None}
            data_of |= {"fail": chain.fail, "endless": tuple(sorted(chain.endless())) or None}
            data_of |= {"age": age or None, "hours": quantum, "horizon": part, "steps": steps}
            for key, value in {**data_of, "arcs": chain.arcs}.items():
                self.emitted.attribute(large, key, value)
            self.emitted.end(large)
            return
        of = self._class(name, "chain.Chain")

        def within(hours: float) -> list[Sequence[D]]:
            return [after(chain, D(hours), frozenset({state})) for state in states]

        ahead = self._ahead(chain)
        failed, alive, means = zip(*ahead, strict=True)
        self.emitted.attribute(of, "fail", chain.fail)
        self.emitted.attribute(of, "steps", steps)
        rows: dict[str, Any] = {"first": [row[initial] for row in within(age)], "ahead": ahead}
        rows |= {"grid": [*zip(*within(part), strict=True)]} if system.mission_end else {}
        for key, value in rows.items():
            node = of.attributes.pop(key, ast.Constant(None))
            self._near(node, f"{key} of {name}", data(node), value)
        lasting = [D(0) if mean == INF else mean for mean in means]
        endless = [D(mean == INF) for mean in means]
        sums: dict[str, tuple[str, Sequence[Sequence[D]]]] = {"quantum": ("", within(quantum))}
        if not system.mission_end:
            look = [failed, alive, lasting, endless, [D(1)] * chain.size]
            sums["look"] = ", at", look
        for method, (more, wanted) in sums.items():
            function = of.methods.pop(method, of.node)
            written = returned(function, f"self, belief{more}", {"belief": variables(states)})
            products = {of for terms in written for of, factor in terms.items() if factor}
            if not products <= {(k,) for k in states}:
                raise UnprovedError(function, "it is no sum over the states")
            numbers = [[float(terms.get((k,), 0)) for k in states] for terms in written]
            self._near(function, f"{method} of {name}", numbers, wanted)
        self.emitted.end(of)

    def _tree(self, place: int, name: str, tree: FaultTree) -> None:
        """Take the class of a fault tree."""
        of = self._class(f"Tree{place}", "tree.FaultTree")
        events: dict[str, Polynomial] = {}
        numbers: dict[str, int] = {}  # of what is an event at run time
        orders: list[Any] = []
        rows = {
            "names": list[Any](),
            "observed": list[Any](),
            "models": list[Any](),
            "orders": orders,
        }
        laws: list[str] = []
        for key in exact.leaves(tree):
            at = len(laws)
            if key in tree.gates:
                events[key] = variables([at])[0] if tree.gates[key].type != "SAND" else Polynomial()
                rows["names"].append(key)
                laws.append("0.0")
                if events[key]:
                    orders.append((at, Call(f"Order{at}of{place}")))
                    self._chain(f"Order{at}of{place}", exact.ordered(tree, key), 0, tree.age)
                continue
            event, law = tree.events[key], tree.events[key].law
            assert law is not None, "a checked tree has the law of each event"
            number = numbers.setdefault(exact.variable(tree, key), at)
            events[key] = variables([number])[0]
            if number < at:
                continue
            rows["names"].append(event.name)
            laws.append(_law(law, tree.age if event.age is None else event.age, event.observed))
            if law.model:
                rows["models"].append((at, law.model))
                self.uses[name] += self.uses[law.model]
            if event.observed:
                id_ = self._input(name, input_id(name, key), "bool")
                rows["observed"].append((at, id_))
            elif law.kind in ("fixed", "exponential") and law.values[0] == 0.0:
                events[key] = Polynomial()
            elif (law.kind, law.values) == ("fixed", (1.0,)):
                events[key] = ONE
        for attribute, value in rows.items():
            self.emitted.attribute(of, attribute, tuple(value) or None)
        self.emitted.attribute(of, "repair", tree.repair or None)
        text = f"return [{', '.join(laws)}]"
        for line in ("expm1 = tree.expm1", "until = age + horizon"):
            text = f"{line}\n{text}" if line.split()[0] in text else text
        of.body("laws", "self, age, horizon", text)
        failure = exact.structure(tree, events)
        if failure.keys() - {()} and {"NOT", "XOR"} & {g.type for g in tree.used_gates() if g.of}:
            self.emitted.attribute(of, "grows", False)
            if rows["observed"] or rows["models"]:
                self._nodes(of, variables(range(len(laws))), failure)
        for method, wanted in (("failure", failure), ("survival", ONE - failure)):
            function = of.methods.pop(method, of.node)
            got = returned(function, "self, q", {"q": variables(range(len(laws)))})
            if got + Polynomial() != wanted:
                text = f"{method} of {of.node.name} is another function of the events"
                self.emitted.differs(function, text)
        self.emitted.end(of)

    def _nodes(self, of: Class, q: Sequence[Polynomial], failure: Polynomial) -> None:
        """Take the diagram of a tree, by which it is bounded."""
        node = of.attributes.pop("nodes", ast.Constant(None))
        values, written = [Polynomial(), ONE], data(node)
        try:
            for event, high, low in written:
                values.append(q[event] * values[high] + (ONE - q[event]) * values[low])
        except (TypeError, ValueError, IndexError):
            raise UnprovedError(node) from None
        if values[-1] != failure:
            self.emitted.differs(node, f"nodes of {of.node.name} are of another function")


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

"""The class ``Monitor`` of a reliability model, and a class for each chain and fault tree."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from eddi_runtime.reliability.component import Rule

from eddi_scaffold.kinds.reliability import chains, lowering
from eddi_scaffold.kinds.reliability.decision_diagram import FALSE, TRUE, Diagram
from eddi_scaffold.kinds.reliability.system import (
    DYNAMIC,
    MISSION_END,
    Chain,
    ComponentModel,
    FaultTree,
    ReliabilitySystem,
    input_id,
)
from eddi_scaffold.program import python_text as py
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import (
    CompiledMonitor,
    Declaration,
    attribute_of,
    head_lines,
)

_BOOL = Rule("bool")
_LEVEL = Rule("float", 0.0, 100.0, slack=0.5)
_TEMPERATURE = Rule("float", -200.0, sys.float_info.max)
_LOAD = Rule("float", 0.0, sys.float_info.max)
_SECONDS = Rule("float", -1e12, 1e12)
FORMAT = 3
NODES_WRITTEN_OUT = 4000
"""Nodes of a diagram up to which its sums are written out; a loop is slower, but has no text."""
MODULES = (
    *("battery", "chain", "laws", "large_chain", "large_tree", "observed"),
    *("processor", "rotors", "tree", "units"),
)
"""Modules of the runtime's part, of which a package has those that its monitor uses."""


def compile_system(
    system: ReliabilitySystem,
    declaration: Declaration,
    *,
    states: int = chains.STATES_WRITTEN_OUT,
    nodes: int = NODES_WRITTEN_OUT,
) -> CompiledMonitor:
    """Return the compiled monitor of a checked system.

    Sums are written out up to so many states and nodes.
    """
    lines: list[str] = []
    models = []
    known: dict[str, Rule] = {MISSION_END: _SECONDS} if system.mission_end else {}
    owners: dict[str, str] = {}  # of an input that first reads it
    uses: dict[str, tuple[str, ...]] = {}  # inputs of a model, and of those that it uses
    for place, model in enumerate(system.used_models()):
        kind, path = model.type.title().replace("_", ""), model.place.path or ""
        about = py.comment(f"{kind} {model.name}: {path}".rstrip(": "))
        component = _Component(place, model, about, system, states, nodes)
        models.append(
            py.Item(component.constructor(), f"{py.text_literal(model.name)}: ", above=about)
        )
        lines += component.lines
        used: list[str] = []
        for read, rule in component.reads:
            if rule is None:
                used += uses[read]
            else:
                known.setdefault(read, rule)
                owners.setdefault(read, path)
                used.append(read)
        uses[model.name] = tuple(dict.fromkeys(used))
    lines += head_lines("reliability.Reliability", declaration, owners)
    inputs = [input_ for input_ in declaration.inputs if input_.id in known]
    rules: dict[str, py.Part] = {}
    for input_ in inputs:
        rule = known[input_.id]
        usual = Rule(rule.type)._asdict()
        fields = {key: py.literal(v) for key, v in rule._asdict().items() if v != usual[key]}
        rules[input_.id] = py.call("reliability.Rule", [py.text_literal(rule.type)], **fields)
    lines += py.assignment("rules", _map(rules), 4)
    lines.append(f"    top = {py.text_literal(system.top)}")
    lines += py.assignment("uses", py.literal(uses[system.top]), 4)
    lines.append(f"    horizon = {py.number(system.horizon)}  # h")
    lines += [f"    moving = True  # {MISSION_END}"] if system.mission_end else []
    lines.append(f"    quantum_ns = {round(system.quantum * 1e9)}")
    lines.append(f"    max_gap_ns = {round(system.usual_gap * 1e9)}")
    if system.thresholds:
        rows = ((t.id, t.activate, t.release, round(t.hold * 1e9)) for t in system.thresholds)
        thresholds = (py.call("reliability.Threshold", map(py.literal, row)) for row in rows)
        lines += py.assignment("thresholds", py.tuple_of(thresholds), 4)
    lines += ["    worst_case = True"] if system.worst_case else []
    lines += ["", "    def _read(self, source):"]
    lines += _values([(input_, known[input_.id]) for input_ in inputs])
    lines += ["", "    def _models(self):"]
    lines += py.returned(py.Group("{", tuple(models), "}"), 8)
    return CompiledMonitor(FORMAT, lines, MODULES)


def _map(entries: dict[str, py.Part]) -> py.Group:
    rows = (py.Item(part, f"{py.text_literal(key)}: ") for key, part in entries.items())
    return py.Group("{", tuple(rows), "}")


def _values(inputs: list[tuple[BoundInput, Rule]]) -> Iterator[str]:
    """Yield the body that reads the inputs and takes usual values as they are."""
    if not inputs:
        yield "        return {}"
        return
    names = [f"v{k}" for k in range(len(inputs))]
    attributes = py.tuple_of(attribute_of("source", input_.attribute) for input_, _ in inputs)
    yield "        try:"
    unpacked = ", ".join(names) if len(names) > 1 else "(v0,)"
    yield from py.assignment(f"raw = {unpacked}", attributes, 12)
    yield from ("        except Exception:", "            return super()._read(source)")
    usual: list[str] = []
    for name, (input_, rule) in zip(names, inputs, strict=True):
        if rule.type == "bool":
            usual.append(f"type({name}) is bool")
        elif rule.type == "float" and input_.factor is None:
            usual.append(f"type({name}) is float")
            usual.append(f"{py.number(rule.low)} <= {name} <= {py.number(rule.high)}")
        else:  # its value always has to be looked at
            yield "        return self._believed(raw)"
            return
    flat = f"        if {' and '.join(usual)}:"
    if len(flat) <= py.WIDTH:
        yield flat
    else:
        yield from ("        if (", f"            {usual[0]}")
        yield from (*(f"            and {term}" for term in usual[1:]), "        ):")
    ids = [input_.id for input_, _ in inputs]
    yield from py.returned(_map(dict(zip(ids, names, strict=True))), 12)
    yield "        return self._believed(raw)"


@dataclass
class _Component:
    """Writes a model: its constructor, and the classes for that, numbered by its place."""

    place: int
    model: ComponentModel
    about: str
    system: ReliabilitySystem
    states: int
    nodes: int
    lines: list[str] = field(default_factory=list)  # of the classes, with a comment above
    # ids of inputs with what they may hold, and the models that it uses
    reads: list[tuple[str, Rule | None]] = field(default_factory=list)

    def constructor(self) -> py.Part:
        """Return the call that makes the model."""
        content, values = self.model.content, self.model.values
        if isinstance(content, FaultTree):
            return self._tree(lowering.lower_tree(self.model.name, content))
        if isinstance(content, Chain):
            return self._markov(content)
        more: dict[str, py.Part] = {"repair": "True"} if values.get("repair") else {}
        match self.model.type:
            case "series":
                self.reads += [(part, None) for part in self.model.uses]
                return py.call("units.Series", map(py.text_literal, self.model.uses))
            case "k_out_of_n":
                most = 10_000.0 if values["max"] is None else float(values["max"])
                available = self._input("available", Rule("int", 0.0, most))
                units = py.literal(values["k"]), py.number(self._number("rate"))
                return py.call("units.KOutOfN", [*units, py.literal(values["max"]), available])
            case "propulsion":
                return py.call("rotors.Propulsion", self._rotors(), **more)
            case "battery":
                keys = ("failure_rate", "alpha", "beta", "degradation")
                chain = chains.battery_chain(*map(self._number, keys))
                level, arcs = self._input("level", _LEVEL), chains.rows_of_arcs(chain)
                rows = chains.rows_of_states(chain, chains.mean_times(chain))
                fields = [level, arcs, rows, py.number(self.system.horizon)]
                return py.call("battery.Battery", fields, **more, **self._heat())
        heat = self._heat()
        load = py.tuple_of([self._input("utilisation", _LOAD), py.literal(values["u_max"])])
        if self._number("age"):
            more["age"] = py.number(self._number("age"))
        fields = [py.number(self._number(key)) for key in ("mttf_ref", "shape")]
        return py.call("processor.Processor", fields, **heat, load=load, **more)

    def _number(self, key: str) -> float:
        return float(self.model.values.get(key, 0.0))

    def _input(self, name: str, rule: Rule) -> str:
        id_ = input_id(self.model.name, name)
        self.reads.append((id_, rule))
        return py.text_literal(id_)

    def _heat(self) -> dict[str, py.Part]:
        """Return how heat ages it, if it does."""
        if "t_ref" not in self.model.values:
            return {}
        keys = ("activation_energy", "t_ref", "t_max")
        law = py.call("laws.Arrhenius", [py.number(self._number(key)) for key in keys])
        return {"heat": law, "temperature": self._input("temperature", _TEMPERATURE)}

    def _markov(self, content: Chain) -> py.Part:
        self.reads += [(seen.input, _BOOL) for seen in content.observe]
        number = content.states.index
        observe = tuple((number(seen.state), seen.input, seen.negated) for seen in content.observe)
        more: dict[str, py.Part] = {"observe": py.literal(observe)} if observe else {}
        more |= {"repair": "True"} if content.repair else {}
        chain = self._chain("Chain", lowering.chain_of(content), self.about)
        return py.call("observed.MarkovChain", [chain], **more)

    def _rotors(self) -> list[py.Part]:
        values = self.model.values
        configuration, rates = values["configuration"], values["rates"]
        motors = sorted(range(len(rates)), key=values["positions"].__getitem__)
        chain = chains.rotors_chain(configuration, [float(rates[motor]) for motor in motors])
        if self.system.mission_end:  # the chain finds what lies ahead
            ahead: py.Part = self._chain("Chain", chain, self.about)
        else:
            numbers = chains.rows_ahead(chain, self.system.horizon)
            ahead = py.call("rotors.Rows", [chains.rows_of_states(chain, numbers)])
        if values["status"] == "list":
            status = self._input("status", Rule("bool[]", length=len(motors)))
            inputs = [py.tuple_of([status, str(motor)]) for motor in motors]
        else:
            inputs = [py.tuple_of([self._input(f"motor_{m}", _BOOL), "None"]) for m in motors]
        sets = py.tuple_of(
            py.Item(py.literal(tuple(sorted(failed))), behind=str(state))
            for state, failed in enumerate(chains.survived(configuration))
        )
        return [ahead, sets, py.tuple_of(inputs)]

    def _chain(self, name: str, chain: chains.Chain, about: str) -> str:
        name = f"{name}{self.place}"
        write = chains.chain_lines if len(chain.states) <= self.states else chains.chain_table_lines
        self.lines += [f"# {about}"] if about else []
        self.lines += [*write(name, chain, self.system), "", ""]
        return f"{name}()"

    def _tree(self, tree: lowering.FaultTree) -> py.Part:
        orders = []
        for i, event in enumerate(tree.events):
            self.reads += [(event.model, None)] if event.model else []
            self.reads += [(event.input, _BOOL)] if event.input else []
            if event.law in DYNAMIC:
                about = py.comment(f"{event.law} {event.name}: {event.place}".rstrip(": "))
                chain = chains.order_chain(event.law, event.values, event.age)
                orders.append((i, self._chain(f"Order{i}of", chain, about).removesuffix("()")))
        name = f"Tree{self.place}"
        lines = tree_lines(name, tree, orders, self.nodes)
        self.lines += [f"# {self.about}", *lines, "", ""]
        return f"{name}()"


def tree_lines(
    name: str, tree: lowering.FaultTree, orders: Sequence[tuple[int, str]], limit: int
) -> Iterator[str]:
    """Yield the class of a tree; ``orders``: event that is a dynamic gate, class of its chain."""
    events, diagram = tree.events, tree.diagram
    is_written_out = diagram is not None and len(diagram.nodes) <= limit
    exact = "tree.FaultTree" if is_written_out else "large_tree.LargeTree"
    yield f"class {name}({exact if diagram else 'large_tree.BoundedTree'}):"
    yield from py.assignment(
        "names", py.tuple_of(py.text_literal(event.name) for event in events), 4
    )
    observed = tuple((i, event.input) for i, event in enumerate(events) if event.input is not None)
    models = tuple((i, event.model) for i, event in enumerate(events) if event.law == "model")
    for key, rows in (("observed", observed), ("models", models)):
        if rows:
            yield from py.assignment(key, py.literal(rows), 4)
    if orders:
        yield from py.assignment(
            "orders", py.tuple_of(py.tuple_of([str(i), c]) for i, c in orders), 4
        )
    if tree.repair:
        yield "    repair = True"
    if diagram is None:
        yield "    # Minimal cut sets, by the numbers of the events."
        sets = (py.literal(tuple(sorted(cut_set))) for cut_set in tree.cut_sets or ())
        yield from py.assignment("sets", py.tuple_of(sets), 4)
    else:
        if not diagram.coherent:
            yield "    grows = False"
        if not is_written_out or (not diagram.coherent and (observed or models)):
            yield "    # Nodes (event, high, low), the last one at the top."
            yield from py.assignment("nodes", py.literal(diagram.nodes), 4)
    values = [_law(event) for event in events]
    yield from ("", "    def laws(self, age, horizon):")
    if any("until" in text for text in values):
        yield "        until = age + horizon"
    if any("expm1" in text for text in values):
        yield "        expm1 = tree.expm1"
    laws = (
        py.Item(text, behind=about) for text, about in zip(values, map(_about, events), strict=True)
    )
    yield from py.returned(py.Group("[", tuple(laws), "]"), 8)
    if diagram is not None and is_written_out:
        for method, of_failure in (("failure", True), ("survival", False)):
            yield from ("", f"    def {method}(self, q):")
            yield from _sums_of_products(tree, diagram, of_failure=of_failure)


def _about(event: lowering.Event) -> str:
    return py.comment(f"{event.name}: {event.place}" if event.place else event.name)


def _law(event: lowering.Event) -> str:
    before = py.number(event.age)
    if event.law == "exponential":
        rate = py.number(-event.values[0])
        if event.input is not None:
            return f"-expm1({rate} * horizon)"
        return f"-expm1({rate} * {f'({before} + until)' if event.age else 'until'})"
    if event.law == "weibull":
        scale, shape = map(py.number, event.values)
        age = f"{before} + age" if event.age else "age"
        if event.input is None:
            return f"tree.weibull(0.0, {age} + horizon, {scale}, {shape})"
        return f"tree.weibull({age}, horizon, {scale}, {shape})"
    return py.number(event.values[0]) if event.law == "fixed" else "0.0"


def _sums_of_products(
    tree: lowering.FaultTree, diagram: Diagram, *, of_failure: bool
) -> Iterator[str]:
    """Yield sums of products of what is not negative: nothing cancels, 1e-27 keeps its digits."""
    if len(tree.events) == 1:
        yield f"        q0 = q[0]  # {_about(tree.events[0])}".rstrip("# ")
    else:
        yield "        ("
        for i, event in enumerate(tree.events):
            yield f"            q{i},  # {_about(event)}".rstrip("# ")
        yield "        ) = q"
    complements: set[int] = set()
    value = {FALSE: "0.0", TRUE: "1.0"} if of_failure else {FALSE: "1.0", TRUE: "0.0"}
    for node, (i, high, low) in enumerate(diagram.nodes, 2):
        if value[low] != "0.0" and i not in complements:
            complements.add(i)
            yield f"        w{i} = 1.0 - q{i}"
        products = [
            weight if value[branch] == "1.0" else f"{weight} * {value[branch]}"
            for weight, branch in ((f"q{i}", high), (f"w{i}", low))
            if value[branch] != "0.0"
        ]
        value[node] = f"n{node}"
        about = py.comment(tree.events[i].name)
        yield from py.assignment(value[node], " + ".join(products) or "0.0", 8, about)
    yield f"        return {value[diagram.root]}"

"""The class ``Monitor`` of a reliability model, and a class for each chain and fault tree."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from eddi_runtime.reliability.component import Rule

from eddi_scaffold.kinds.reliability import chains, lowering
from eddi_scaffold.kinds.reliability.decision_diagram import FALSE, TRUE, Diagram
from eddi_scaffold.kinds.reliability.system import DYNAMIC, MISSION_END, ReliabilitySystem
from eddi_scaffold.program import python_text as py
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import (
    CompiledMonitor,
    Declaration,
    attribute_of,
    head_lines,
)

FORMAT = 2
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
    lowered: lowering.LoweredSystem | None = None,
    *,
    states: int = chains.STATES_WRITTEN_OUT,
    nodes: int = NODES_WRITTEN_OUT,
) -> CompiledMonitor:
    """Return the compiled monitor of a checked system, or of these models in place of its own.

    Sums are written out up to so many states and nodes; with 0 states no number is of one horizon.
    """
    lowered = lowered or lowering.lower(system)
    time = chains.Time(system.quantum / 3600.0, system.horizon, moving=system.mission_end)
    lines: list[str] = []
    models = []
    for place, (name, component) in enumerate(lowered.components.items()):
        kind = type(component).__name__
        about = py.comment(f"{kind} {name}: {lowered.places[name]}".rstrip(": "))
        classes = _Classes(place, about, time, states, nodes)
        constructor = classes.constructor(component)
        lines += classes.lines
        models.append(py.Item(constructor, f"{py.text_literal(name)}: ", above=about))
    owners = {key: lowered.places[name] for key, name in lowered.owners.items()}
    lines += head_lines("reliability.Reliability", declaration, owners)
    inputs = [input_ for input_ in declaration.inputs if input_.id in lowered.rules]
    rules: dict[str, py.Part] = {}
    for input_ in inputs:
        rule = lowered.rules[input_.id]
        usual = Rule(rule.type)._asdict()
        fields = {key: py.literal(v) for key, v in rule._asdict().items() if v != usual[key]}
        rules[input_.id] = py.call("reliability.Rule", [py.text_literal(rule.type)], **fields)
    lines += py.assignment("rules", _map(rules), 4)
    lines.append(f"    top = {py.text_literal(system.top)}")
    lines += py.assignment("uses", py.literal(lowered.uses[system.top]), 4)
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
    lines += _values([(input_, lowered.rules[input_.id]) for input_ in inputs])
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
class _Classes:
    """Writes the classes of a component, numbered by its place, with a comment above."""

    place: int
    about: str
    time: chains.Time
    states: int
    nodes: int
    lines: list[str] = field(default_factory=list)

    def constructor(self, component: lowering.Component) -> py.Part:
        repair: dict[str, py.Part] = {"repair": "True"} if getattr(component, "repair", 0) else {}
        fields: list[py.Part]
        match component:
            case lowering.Markov():
                seen = {"observe": py.literal(component.observe)} if component.observe else {}
                chain = self._chain("Chain", component.chain, self.about)
                return py.call("observed.MarkovChain", [chain], **seen, **repair)
            case lowering.Propulsion():
                sets = py.tuple_of(
                    py.Item(py.literal(failed), behind=str(state))
                    for state, failed in enumerate(component.sets)
                )
                if self.time.moving or not self.states:  # the chain finds what lies ahead
                    ahead: py.Part = self._chain("Chain", component.chain, self.about)
                else:
                    numbers = chains.rows_ahead(component.chain, self.time.horizon)
                    rows = chains.rows_of_states(component.chain, numbers)
                    ahead = py.call("rotors.Rows", [rows])
                fields = [ahead, sets, py.literal(component.inputs)]
                return py.call("rotors.Propulsion", fields, **repair)
            case lowering.Battery():
                level, arcs = py.text_literal(component.level), chains.rows_of_arcs(component.chain)
                lives = chains.mean_times(component.chain)
                rows = chains.rows_of_states(component.chain, lives)
                fields = [level, arcs, rows, py.number(self.time.horizon)]
                return py.call("battery.Battery", fields, **repair, **_heat(component.heat))
            case lowering.Processor():
                load = {} if component.load is None else {"load": py.literal(component.load)}
                age = {"age": py.number(component.age)} if component.age else {}
                fields = [py.number(component.mean), py.number(component.shape)]
                heat = _heat(component.heat)
                return py.call("processor.Processor", fields, **heat, **load, **age)
            case lowering.KOutOfN():
                return py.call("units.KOutOfN", map(py.literal, component))
            case lowering.Series():
                return py.call("units.Series", map(py.text_literal, component.parts))
            case lowering.FaultTree():
                return self._tree(component)

    def _chain(self, name: str, chain: chains.Chain, about: str) -> str:
        name = f"{name}{self.place}"
        write = chains.chain_lines if len(chain.states) <= self.states else chains.chain_table_lines
        self.lines += [f"# {about}"] if about else []
        self.lines += [*write(name, chain, self.time), "", ""]
        return f"{name}()"

    def _tree(self, tree: lowering.FaultTree) -> py.Part:
        orders = []
        for i, event in enumerate(tree.events):
            if event.law in DYNAMIC:
                about = py.comment(f"{event.law} {event.name}: {event.place}".rstrip(": "))
                chain = chains.order_chain(event.law, event.values, event.age)
                orders.append((i, self._chain(f"Order{i}of", chain, about).removesuffix("()")))
        name = f"Tree{self.place}"
        lines = tree_lines(name, tree, orders, self.nodes)
        self.lines += [f"# {self.about}", *lines, "", ""]
        return f"{name}()"


def _heat(heat: lowering.Heat | None) -> dict[str, py.Part]:
    if heat is None:
        return {}
    numbers = map(py.number, (heat.energy, heat.reference, heat.hottest))
    law = py.call("laws.Arrhenius", numbers)
    return {"heat": law, "temperature": py.text_literal(heat.temperature)}


def tree_lines(
    name: str, tree: lowering.FaultTree, orders: Sequence[tuple[int, str]], limit: int
) -> Iterator[str]:
    """Yield the class of a tree; ``orders``: event that is a dynamic gate, class of its chain."""
    events, diagram = tree.events, tree.diagram
    is_written_out = diagram is not None and diagram.size <= limit
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
    if tree.cut_sets is not None:
        yield "    # Minimal cut sets, by the numbers of the events."
        sets = (py.literal(tuple(sorted(cut_set))) for cut_set in tree.cut_sets)
        yield from py.assignment("sets", py.tuple_of(sets), 4)
    elif diagram is not None:
        if not diagram.coherent:
            yield "    grows = False"
        if not is_written_out or (not diagram.coherent and (observed or models)):
            yield "    # Nodes (variable, high, low) of each module, and its root."
            yield from py.assignment("modules", py.literal(table(diagram)), 4)
    values = [_law(event) for event in events]
    yield from ("", "    def laws(self, age, horizon):")
    if any("until" in text for text in values):
        yield "        until = age + horizon"
    if any("expm1" in text for text in values):
        yield "        expm1 = tree.expm1"
    abouts = [_about(event.name, event.place) for event in events]
    laws = (py.Item(text, behind=about) for text, about in zip(values, abouts, strict=True))
    yield from py.returned(py.Group("[", tuple(laws), "]"), 8)
    if diagram is not None and is_written_out:
        for method, of_failure in (("failure", True), ("survival", False)):
            yield from ("", f"    def {method}(self, q):")
            yield from _sums_of_products(tree, diagram, of_failure=of_failure)


def table(diagram: Diagram) -> tuple[object, ...]:
    """Return the modules with variables that count those before behind the events."""
    number_of = {module.variable: diagram.events + i for i, module in enumerate(diagram.modules)}
    return tuple(
        (tuple((number_of.get(v, v), high, low) for v, high, low in module.nodes), module.root)
        for module in diagram.modules
    )


def _about(name: str, place: str) -> str:
    return py.comment(f"{name}: {place}" if place else name)


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
    named = [(event.name, event.place) for event in tree.events]
    named += [
        (f"{gate.type} {named.name}".rstrip(), named.place)
        for gate, named in zip(tree.gates, tree.names, strict=True)
    ]
    if len(tree.events) == 1:
        yield f"        q0 = q[0]  # {_about(*named[0])}".rstrip("# ")
    else:
        yield "        ("
        for i in range(len(tree.events)):
            yield f"            q{i},  # {_about(*named[i])}".rstrip("# ")
        yield "        ) = q"
    complements: set[int] = set()
    last = diagram.modules[-1]
    for place, module in enumerate(diagram.modules):
        value = {FALSE: "0.0", TRUE: "1.0"}
        if module is last and not of_failure:
            value = {FALSE: "1.0", TRUE: "0.0"}
        for i, (variable, high, low) in enumerate(module.nodes):
            if value[low] != "0.0" and variable not in complements:
                complements.add(variable)
                yield f"        w{variable} = 1.0 - q{variable}"
            value[i + 2] = f"n{place}_{i}"
            products = [
                weight if value[branch] == "1.0" else f"{weight} * {value[branch]}"
                for weight, branch in ((f"q{variable}", high), (f"w{variable}", low))
                if value[branch] != "0.0"
            ]
            about = py.comment(named[variable][0]) if variable < len(named) else ""
            text = " + ".join(products) or "0.0"
            yield from py.assignment(value[i + 2], text, 8, about)
        gate = _about(*named[module.variable]) if module.variable < len(named) else ""
        if module is last:
            yield from py.returned(value[module.root], 8, gate)
        else:
            yield from py.assignment(f"q{module.variable}", value[module.root], 8, gate)

"""The class ``Monitor`` of a reliability model, and a class for each chain and fault tree."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from eddi_scaffold.kinds.reliability.chains import (
    STATES_WRITTEN_OUT,
    Chain,
    Time,
    chain_lines,
    chain_table_lines,
    mean_times,
    order_chain,
    rows_ahead,
    rows_of_states,
)
from eddi_scaffold.kinds.reliability.decision_diagram import FALSE, TRUE, Diagram
from eddi_scaffold.kinds.reliability.lowering import (
    Battery,
    Component,
    Event,
    FaultTree,
    Heat,
    KOutOfN,
    LoweredSystem,
    Markov,
    Processor,
    Propulsion,
    Rule,
    Series,
    lower,
)
from eddi_scaffold.kinds.reliability.system import DYNAMIC, MISSION_END, ReliabilitySystem
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import (
    CompiledMonitor,
    Declaration,
    attribute_of,
    head_lines,
)
from eddi_scaffold.program.python_text import (
    WIDTH,
    Group,
    Item,
    Part,
    assignment,
    call,
    comment,
    literal,
    number,
    returned,
    text_literal,
    tuple_of,
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
    lowered: LoweredSystem | None = None,
    *,
    states: int = STATES_WRITTEN_OUT,
    nodes: int = NODES_WRITTEN_OUT,
) -> CompiledMonitor:
    """Return the compiled monitor of a checked system, or of these models in place of its own.

    Sums are written out of chains and diagrams with at most so many states and nodes; with 0 states
    no number is of one horizon.
    """
    lowered = lowered or lower(system)
    time = Time(system.quantum / 3600.0, system.horizon, moving=system.mission_end)
    lines: list[str] = []
    models = []
    for place, (name, component) in enumerate(lowered.components.items()):
        about = comment(f"{type(component).__name__} {name}: {lowered.places[name]}".rstrip(": "))
        classes = _Classes(place, about, time, states, nodes)
        constructor = classes.constructor(component)
        lines += classes.lines
        models.append(Item(constructor, f"{text_literal(name)}: ", above=about))
    lines += [*_monitor(system, lowered, declaration), "", "    def _models(self):"]
    lines += returned(Group("{", tuple(models), "}"), 8)
    return CompiledMonitor(FORMAT, lines, MODULES)


def _monitor(
    system: ReliabilitySystem, lowered: LoweredSystem, declaration: Declaration
) -> Iterator[str]:
    owners = {key: lowered.places[name] for key, name in lowered.owners.items()}
    yield from head_lines("reliability.Reliability", declaration, owners)
    inputs = [input_ for input_ in declaration.inputs if input_.id in lowered.rules]
    rules = {input_.id: _rule(lowered.rules[input_.id]) for input_ in inputs}
    yield from assignment("rules", _map(rules), 4)
    yield f"    top = {text_literal(system.top)}"
    yield from assignment("uses", literal(lowered.uses[system.top]), 4)
    yield f"    horizon = {number(system.horizon)}  # h"
    if system.mission_end:
        yield f"    moving = True  # {MISSION_END}"
    yield f"    quantum_ns = {round(system.quantum * 1e9)}"
    yield f"    max_gap_ns = {round(system.usual_gap * 1e9)}"
    if system.thresholds:
        fields = ((t.id, t.activate, t.release, round(t.hold * 1e9)) for t in system.thresholds)
        thresholds = (call("reliability.Threshold", map(literal, values)) for values in fields)
        yield from assignment("thresholds", tuple_of(thresholds), 4)
    if system.worst_case:
        yield "    worst_case = True"
    yield from ("", "    def _read(self, source):")
    yield from _values([(input_, lowered.rules[input_.id]) for input_ in inputs])


def _rule(rule: Rule) -> Part:
    usual = Rule(rule.type)._asdict()
    fields = {key: literal(v) for key, v in rule._asdict().items() if v != usual[key]}
    return call("reliability.Rule", [text_literal(rule.type)], **fields)


def _map(entries: dict[str, Part]) -> Group:
    rows = (Item(part, f"{text_literal(key)}: ") for key, part in entries.items())
    return Group("{", tuple(rows), "}")


def _values(inputs: list[tuple[BoundInput, Rule]]) -> Iterator[str]:
    """Yield the body that reads the inputs and takes usual values as they are."""
    if not inputs:
        yield "        return {}"
        return
    names = [f"v{k}" for k in range(len(inputs))]
    attributes = tuple_of(attribute_of("source", input_.attribute) for input_, _ in inputs)
    yield "        try:"
    unpacked = ", ".join(names) if len(names) > 1 else "(v0,)"
    yield from assignment(f"raw = {unpacked}", attributes, 12)
    yield from ("        except Exception:", "            return super()._read(source)")
    usual: list[str] = []
    for name, (input_, rule) in zip(names, inputs, strict=True):
        if rule.type == "bool":
            usual.append(f"type({name}) is bool")
        elif rule.type == "float" and input_.factor is None:
            usual.append(f"type({name}) is float")
            usual.append(f"{number(rule.low)} <= {name} <= {number(rule.high)}")
        else:  # its value always has to be looked at
            yield "        return self._believed(raw)"
            return
    flat = f"        if {' and '.join(usual)}:"
    if len(flat) <= WIDTH:
        yield flat
    else:
        yield from ("        if (", f"            {usual[0]}")
        yield from (*(f"            and {term}" for term in usual[1:]), "        ):")
    ids = [input_.id for input_, _ in inputs]
    yield from returned(_map(dict(zip(ids, names, strict=True))), 12)
    yield "        return self._believed(raw)"


@dataclass
class _Classes:
    """Writes the classes of a component, numbered by its place, with a comment above."""

    place: int
    about: str
    time: Time
    states: int
    nodes: int
    lines: list[str] = field(default_factory=list)

    def constructor(self, component: Component) -> Part:
        repair: dict[str, Part] = {"repair": "True"} if getattr(component, "repair", 0) else {}
        match component:
            case Markov():
                seen = {"observe": literal(component.observe)} if component.observe else {}
                chain = self._chain("Chain", component.chain, self.about)
                return call("observed.MarkovChain", [chain], **seen, **repair)
            case Propulsion():
                sets = tuple_of(
                    Item(literal(failed), behind=str(state))
                    for state, failed in enumerate(component.sets)
                )
                ahead = self._ahead(component.chain)
                return call("rotors.Propulsion", [ahead, sets, literal(component.inputs)], **repair)
            case Battery():
                return self._battery(component, repair)
            case Processor():
                load = {} if component.load is None else {"load": literal(component.load)}
                age = {"age": number(component.age)} if component.age else {}
                numbers = [number(component.mean), number(component.shape)]
                return call("processor.Processor", numbers, **_heat(component.heat), **load, **age)
            case KOutOfN():
                fields = (component.k, component.rate, component.largest, component.available)
                return call("units.KOutOfN", map(literal, fields))
            case Series():
                return call("units.Series", map(text_literal, component.parts))
            case FaultTree():
                return self._tree(component)

    def _ahead(self, chain: Chain) -> Part:
        """Return what lies ahead of each state; where the horizon changes, the chain finds it."""
        if self.time.moving or not self.states:
            return self._chain("Chain", chain, self.about)
        rows = rows_ahead(chain, self.time.horizon)
        return call("rotors.Rows", [rows_of_states(chain, rows)])

    def _chain(self, name: str, chain: Chain, about: str) -> str:
        """Write the class of a chain; return the call that constructs one."""
        name = f"{name}{self.place}"
        write = chain_lines if len(chain.states) <= self.states else chain_table_lines
        self.lines += [f"# {about}"] if about else []
        self.lines += [*write(name, chain, self.time), "", ""]
        return f"{name}()"

    def _battery(self, battery: Battery, repair: dict[str, Part]) -> Part:
        states = battery.chain.states
        arcs = tuple_of(
            Item(literal(arc), behind=f"{states[arc[0]]} to {states[arc[1]]}")
            for arc in battery.chain.arcs
        )
        pairs = zip(states, mean_times(battery.chain), strict=True)
        lives = tuple_of(Item(number(life), behind=state) for state, life in pairs)
        fields: list[Part] = [text_literal(battery.level), arcs, lives, number(self.time.horizon)]
        return call("battery.Battery", fields, **repair, **_heat(battery.heat))

    def _tree(self, tree: FaultTree) -> Part:
        orders = []
        for i, event in enumerate(tree.events):
            if event.law in DYNAMIC:
                about = comment(f"{event.law} {event.name}: {event.place}".rstrip(": "))
                chain = order_chain(event.law, event.values, event.age)
                orders.append((i, self._chain(f"Order{i}of", chain, about).removesuffix("()")))
        name = f"Tree{self.place}"
        lines = tree_lines(name, tree, orders, self.nodes)
        self.lines += [f"# {self.about}", *lines, "", ""]
        return f"{name}()"


def _heat(heat: Heat | None) -> dict[str, Part]:
    if heat is None:
        return {}
    numbers = map(number, (heat.energy, heat.reference, heat.hottest))
    law = call("laws.Arrhenius", numbers)
    return {"heat": law, "temperature": text_literal(heat.temperature)}


def tree_lines(
    name: str, tree: FaultTree, orders: Sequence[tuple[int, str]], limit: int
) -> Iterator[str]:
    """Yield the class of a tree; sums are written out of up to ``limit`` nodes.

    ``orders`` are pairs of an event that stands for a dynamic gate and the class of its chain.
    """
    events, diagram = tree.events, tree.diagram
    is_written_out = diagram is not None and diagram.size <= limit
    exact = "tree.FaultTree" if is_written_out else "large_tree.LargeTree"
    yield f"class {name}({exact if diagram else 'large_tree.BoundedTree'}):"
    yield from assignment("names", tuple_of(text_literal(event.name) for event in events), 4)
    observed = tuple((i, event.input) for i, event in enumerate(events) if event.input is not None)
    models = tuple((i, event.model) for i, event in enumerate(events) if event.law == "model")
    for key, rows in (("observed", observed), ("models", models)):
        if rows:
            yield from assignment(key, literal(rows), 4)
    if orders:
        yield from assignment("orders", tuple_of(tuple_of([str(i), c]) for i, c in orders), 4)
    if tree.repair:
        yield "    repair = True"
    if tree.cut_sets is not None:
        yield "    # Minimal cut sets, by the numbers of the events."
        sets = (literal(tuple(sorted(cut_set))) for cut_set in tree.cut_sets)
        yield from assignment("sets", tuple_of(sets), 4)
    elif diagram is not None:
        if not diagram.coherent:
            yield "    grows = False"
        if not is_written_out or (not diagram.coherent and (observed or models)):
            yield "    # Nodes (variable, high, low) of each module, and its root."
            yield from assignment("modules", literal(table(diagram)), 4)
    yield from _laws(events)
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


def _laws(events: Sequence[Event]) -> Iterator[str]:
    values = [_law(event) for event in events]
    yield from ("", "    def laws(self, age, horizon):")
    if any("until" in text for text in values):
        yield "        until = age + horizon"
    if any("expm1" in text for text in values):
        yield "        expm1 = tree.expm1"
    rows = (
        Item(text, behind=_about(event.name, event.place))
        for text, event in zip(values, events, strict=True)
    )
    yield from returned(Group("[", tuple(rows), "]"), 8)


def _law(event: Event) -> str:
    before = number(event.age)
    if event.law == "exponential":
        rate = number(-event.values[0])
        if event.input is not None:
            return f"-expm1({rate} * horizon)"
        return f"-expm1({rate} * {f'({before} + until)' if event.age else 'until'})"
    if event.law == "weibull":
        scale, shape = map(number, event.values)
        age = f"{before} + age" if event.age else "age"
        if event.input is None:
            return f"tree.weibull(0.0, {age} + horizon, {scale}, {shape})"
        return f"tree.weibull({age}, horizon, {scale}, {shape})"
    return number(event.values[0]) if event.law == "fixed" else "0.0"


def _about(name: str, place: str) -> str:
    return comment(f"{name}: {place}" if place else name)


def _sums_of_products(tree: FaultTree, diagram: Diagram, *, of_failure: bool) -> Iterator[str]:
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
            about = comment(named[variable][0]) if variable < len(named) else ""
            text = " + ".join(products) or "0.0"
            yield from assignment(value[i + 2], text, 8, about)
        gate = _about(*named[module.variable]) if module.variable < len(named) else ""
        if module is last:
            yield from returned(value[module.root], 8, gate)
        else:
            yield from assignment(f"q{module.variable}", value[module.root], 8, gate)

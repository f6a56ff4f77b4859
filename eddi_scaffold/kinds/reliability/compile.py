"""The class ``Monitor`` of a reliability model, and a class for each chain and fault tree."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from eddi_scaffold.kinds.reliability import component_text
from eddi_scaffold.kinds.reliability.chains import Chain, mean_times
from eddi_scaffold.kinds.reliability.component_text import NODES_WRITTEN_OUT, STATES_WRITTEN_OUT
from eddi_scaffold.kinds.reliability.inputs import MISSION_END
from eddi_scaffold.kinds.reliability.lowering import (
    Battery,
    Component,
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
    order_chain,
)
from eddi_scaffold.kinds.reliability.system import DYNAMIC, ReliabilitySystem
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
MODULES = (
    "battery",
    "chain",
    "cut_sets",
    "laws",
    "large_chain",
    "large_tree",
    "observed",
    "processor",
    "rotors",
    "series",
    "tree",
    "units",
)
"""Modules of the runtime's part, of which a package has those that its monitor uses."""


def compile_system(
    system: ReliabilitySystem,
    declaration: Declaration,
    *,
    states: int = STATES_WRITTEN_OUT,
    nodes: int = NODES_WRITTEN_OUT,
) -> CompiledMonitor:
    """Return the compiled monitor of a checked system.

    Args:
        system: the system.
        declaration: whose monitor it is, and its inputs.
        states: of the largest chain whose sums are written out; 0: no number is of one horizon.
        nodes: of the largest diagram whose sums are written out.
    """
    return compile_lowered(lower(system), system, declaration, states=states, nodes=nodes)


def compile_lowered(
    lowered: LoweredSystem,
    system: ReliabilitySystem,
    declaration: Declaration,
    *,
    states: int = STATES_WRITTEN_OUT,
    nodes: int = NODES_WRITTEN_OUT,
) -> CompiledMonitor:
    """Return the compiled monitor of a system whose models are lowered."""
    time = component_text.Time(system.quantum / 3600.0, system.horizon, moving=system.mission_end)
    lines: list[str] = []
    models = []
    for place, (name, component) in enumerate(lowered.components.items()):
        about = comment(f"{type(component).__name__} {name}: {lowered.places[name]}".rstrip(": "))
        classes = _Classes(place, about, time, states, nodes)
        made = classes.made(component)
        lines += classes.lines
        models.append(Item(made, f"{text_literal(name)}: ", above=about))
    lines += [*_monitor(system, lowered, declaration), "", "    def _models(self):"]
    lines += returned(Group("{", tuple(models), "}"), 8)
    return CompiledMonitor(FORMAT, lines, MODULES)


def _monitor(
    system: ReliabilitySystem, lowered: LoweredSystem, declaration: Declaration
) -> Iterator[str]:
    owners = {key: lowered.places[name] for key, name in lowered.owners.items()}
    yield from head_lines("reliability.Reliability", declaration, owners)
    read = [input_ for input_ in declaration.inputs if input_.id in lowered.rules]
    rules = (
        Item(_rule(lowered.rules[input_.id]), f"{text_literal(input_.id)}: ") for input_ in read
    )
    yield from assignment("rules", Group("{", tuple(rules), "}"), 4)
    yield f"    top = {text_literal(system.top)}"
    yield from assignment("uses", literal(lowered.uses[system.top]), 4)
    yield f"    horizon = {number(system.horizon)}  # h"
    if system.mission_end:
        yield f"    moving = True  # {MISSION_END}"
    yield f"    quantum_ns = {round(system.quantum * 1e9)}"
    yield f"    max_gap_ns = {round(system.usual_gap * 1e9)}"
    if system.thresholds:
        thresholds = (
            call(
                "reliability.Threshold",
                [
                    text_literal(threshold.id),
                    number(threshold.activate),
                    number(threshold.release),
                    literal(round(threshold.hold * 1e9)),
                ],
            )
            for threshold in system.thresholds
        )
        yield from assignment("thresholds", tuple_of(thresholds), 4)
    if system.worst_case:
        yield "    worst_case = True"
    yield from _values(read, lowered)


def _values(read: Sequence[BoundInput], lowered: LoweredSystem) -> Iterator[str]:
    """Yield the method that reads the inputs and takes usual values as they are."""
    names = [f"v{k}" for k in range(len(read))]
    yield from ("", "    def _read(self, source):")
    if not read:
        yield "        return {}"
        return
    yield "        try:"
    whole = tuple_of(attribute_of("source", one.attribute) for one in read)
    unpacked = ", ".join(names) if len(names) > 1 else "(v0,)"
    yield from assignment(f"raw = {unpacked}", whole, 12)
    yield from ("        except Exception:", "            return super()._read(source)")
    usual = [
        _usual(name, lowered.rules[one.id], one) for name, one in zip(names, read, strict=True)
    ]
    if all(usual):
        yield from _condition(usual, 8)
        rows = (
            Item(name, f"{text_literal(one.id)}: ") for name, one in zip(names, read, strict=True)
        )
        yield from returned(Group("{", tuple(rows), "}"), 12)
    yield "        return self._believed(raw)"


def _condition(parts: Sequence[str], indent: int) -> list[str]:
    """Return the lines of ``if`` all of these."""
    flat, blanks = " and ".join(parts), " " * indent
    if len(f"{blanks}if {flat}:") <= WIDTH:
        return [f"{blanks}if {flat}:"]
    terms = " and ".join(parts).split(" and ")
    rows = (f"{blanks}    {'and ' if place else ''}{term}" for place, term in enumerate(terms))
    return [f"{blanks}if (", *rows, f"{blanks}):"]


def _usual(name: str, rule: Rule, one: BoundInput) -> str:
    """Return when a value is taken as it is, empty for never."""
    if rule.type == "bool":
        return f"type({name}) is bool"
    if rule.type == "float" and one.factor is None:
        return f"type({name}) is float and {number(rule.low)} <= {name} <= {number(rule.high)}"
    return ""


def _rule(rule: Rule) -> Part:
    given = {key: value for key, value in rule._asdict().items() if value != _DEFAULT[key]}
    kind = given.pop("type", "")
    return call(
        "reliability.Rule",
        [text_literal(str(kind))],
        **{key: literal(value) for key, value in given.items()},
    )


_DEFAULT = Rule("")._asdict()


class _Classes:
    """Writes the classes of a component, and the expression that makes it.

    Args:
        place: of the component in the model.
        about: a comment.
        time: quantum and horizon.
        states: of the largest chain whose sums are written out.
        nodes: of the largest diagram whose sums are written out.
    """

    def __init__(
        self, place: int, about: str, time: component_text.Time, states: int, nodes: int
    ) -> None:
        self.lines: list[str] = []
        self._place, self._about, self._time = place, about, time
        self._states, self._nodes = states, nodes

    def made(self, component: Component) -> Part:
        if isinstance(component, Markov):
            observe: Mapping[str, Part] = (
                {"observe": literal(component.observe)} if component.observe else {}
            )
            chain = self._chain("Chain", component.chain, self._about)
            return call("observed.MarkovChain", [chain], **observe, **_repair(component.repair))
        if isinstance(component, Propulsion):
            sets = tuple_of(
                Item(literal(failed), behind=str(state))
                for state, failed in enumerate(component.sets)
            )
            parts: list[Part] = [self._rows(component.chain), sets, literal(component.inputs)]
            return call("rotors.Propulsion", parts, **_repair(component.repair))
        if isinstance(component, Battery):
            return self._battery(component)
        if isinstance(component, Processor):
            load = {} if component.load is None else {"load": literal(component.load)}
            age = {"age": number(component.age)} if component.age else {}
            heat = component.heat
            named = {"heat": _heat(heat), "temperature": text_literal(heat.temperature)}
            numbers = [number(component.mean), number(component.shape)]
            return call("processor.Processor", numbers, **named, **load, **age)
        if isinstance(component, KOutOfN):
            fields = (component.k, component.rate, component.largest, component.available)
            return call("units.KOutOfN", map(literal, fields))
        if isinstance(component, Series):
            return call("series.Series", map(text_literal, component.parts))
        return self._tree(component)

    def _rows(self, chain: Chain) -> Part:
        """Return what lies ahead of each state; where the horizon changes, the chain finds it."""
        if self._time.moving or not self._states:
            return self._chain("Chain", chain, self._about)
        rows = component_text.rows_ahead(chain, self._time.horizon)
        return call("rotors.Rows", [component_text.table_ahead(chain, rows)])

    def _chain(self, name: str, chain: Chain, about: str) -> str:
        """Write the class of a chain; return the call that makes one."""
        name = f"{name}{self._place}"
        self.lines += [f"# {about}"] if about else []
        if len(chain.states) <= self._states:
            self.lines += component_text.chain_lines(name, chain, self._time)
        else:
            self.lines += component_text.chain_table_lines(name, chain, self._time)
        self.lines += ["", ""]
        return f"{name}()"

    def _battery(self, battery: Battery) -> Part:
        names = battery.chain.states
        arcs = tuple_of(
            Item(literal(arc), behind=f"{names[arc[0]]} to {names[arc[1]]}")
            for arc in battery.chain.arcs
        )
        lives = tuple_of(
            Item(number(life), behind=name)
            for name, life in zip(names, mean_times(battery.chain), strict=True)
        )
        heat = battery.heat
        aged: dict[str, Part] = {}
        if heat is not None:
            aged = {"heat": _heat(heat), "temperature": text_literal(heat.temperature)}
        positional: list[Part] = [
            text_literal(battery.level),
            arcs,
            lives,
            number(self._time.horizon),
        ]
        return call("battery.Battery", positional, **_repair(battery.repair), **aged)

    def _tree(self, tree: FaultTree) -> Part:
        orders = []
        for i, event in enumerate(tree.events):
            if event.law in DYNAMIC:
                about = comment(f"{event.law} {event.name}: {event.place}".rstrip(": "))
                orders.append((i, self._chain(f"Order{i}of", order_chain(event), about)[:-2]))
        name = f"Tree{self._place}"
        self.lines += [
            f"# {self._about}",
            *component_text.tree_lines(name, tree, orders, self._nodes),
        ]
        self.lines += ["", ""]
        return f"{name}()"


def _repair(repair: bool) -> dict[str, Part]:
    return {"repair": "True"} if repair else {}


def _heat(heat: Heat) -> Part:
    return call("laws.Arrhenius", map(number, (heat.energy, heat.reference, heat.hottest)))

"""The classes of chains and fault trees as text: sums with numbers, what is large as tables."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import fsum, inf

from eddi_scaffold.kinds.reliability.chains import (
    Chain,
    certain,
    mean_times,
    propagator,
    rates_of,
)
from eddi_scaffold.kinds.reliability.fault_tree import FALSE, TRUE, Diagram
from eddi_scaffold.kinds.reliability.lowering import Event, FaultTree
from eddi_scaffold.program.python_text import (
    WIDTH,
    Group,
    Item,
    Part,
    assignment,
    comment,
    literal,
    number,
    returned,
    text_literal,
    tuple_of,
)

STATES_WRITTEN_OUT = 8
"""States up to which the sums are written out."""
GRID = 256
"""How many horizons are prepared when the mission's end is an input."""
_Numbers = Sequence[float]


@dataclass(frozen=True)
class Time:
    """Quantum and horizon, in hours; ``moving``: the mission's end is an input."""

    quantum: float
    horizon: float
    moving: bool


def chain_table_lines(name: str, chain: Chain, time: Time) -> list[str]:
    """Return the class of a chain whose exponentials are found when the monitor starts."""
    states = range(len(chain.states))
    endless = sorted(set(states) - certain(chain) - set(chain.fail))
    lines = [f"class {name}(large_chain.LargeChain):", f"    count = {len(chain.states)}"]
    if chain.initial:
        lines += [f"    initial = {chain.initial}"]
    lines += assignment("fail", literal(chain.fail), 4)
    if endless:
        lines += assignment("endless", literal(tuple(endless)), 4)
    if chain.age:
        lines += [f"    age = {number(chain.age)}  # h"]
    lines += [f"    hours = {number(time.quantum)}  # one quantum"]
    lines += [f"    horizon = {number(time.horizon / GRID if time.moving else time.horizon)}"]
    lines += [f"    steps = {GRID}"] if time.moving else []
    arcs = (
        Item(literal(arc), behind=comment(f"{chain.states[arc[0]]} to {chain.states[arc[1]]}"))
        for arc in chain.arcs
    )
    return [*lines, *assignment("arcs", tuple_of(arcs), 4)]


def rows_ahead(chain: Chain, hours: float) -> list[tuple[float, float, float]]:
    """Return for each state: failed and alive at the horizon, mean life in hours."""
    fails = [float(state in chain.fail) for state in range(len(chain.states))]
    works = [1.0 - fail for fail in fails]
    moved = propagator(rates_of(chain), hours)
    ends = [(min(_dot(row, fails), 1.0), _dot(row, works)) for row in moved]
    return [(*end, life) for end, life in zip(ends, mean_times(chain), strict=True)]


def table_ahead(chain: Chain, rows: Sequence[tuple[float, float, float]]) -> Part:
    """Return these rows as a tuple, each with its state."""
    pairs = zip(rows, chain.states, strict=True)
    return tuple_of(Item(literal(row), behind=comment(state)) for row, state in pairs)


def chain_lines(name: str, chain: Chain, time: Time) -> list[str]:
    """Return the class of a chain with its numbers: one quantum, and what lies ahead."""
    rates = rates_of(chain)
    states = [comment(state) for state in chain.states]
    first = propagator(rates, chain.age)[chain.initial]
    lines = [f"class {name}(chain.Chain):"]
    lines += assignment("fail", literal(chain.fail), 4)
    lines += assignment("first", literal(tuple(first)), 4)
    lines += ["    # Failed and alive at the horizon, mean life in hours."]
    ahead = rows_ahead(chain, 0.0 if time.moving else time.horizon)
    lines += assignment("ahead", table_ahead(chain, ahead), 4)
    if time.moving:
        grid = propagator(rates, time.horizon / GRID)
        lines += [f"    # Transitions in one of {GRID} parts of the longest horizon."]
        moved = (
            Item(literal(tuple(row)), behind=state) for row, state in zip(grid, states, strict=True)
        )
        lines += [*assignment("grid", tuple_of(moved), 4), f"    steps = {GRID}"]
    step = propagator(rates, time.quantum)
    columns = [
        ([(row[state], f"b{i}") for i, row in enumerate(step)], about)
        for state, about in enumerate(states)
    ]
    lines += ["", "    def quantum(self, belief):", *_unpacked(len(states))]
    lines += sums(columns)
    if time.moving:
        return lines
    failed, alive, lives = zip(*ahead, strict=True)
    finite = [0.0 if life == inf else life for life in lives]
    endless = [float(life == inf) for life in lives]
    looks = [
        ([(weight, f"b{i}") for i, weight in enumerate(weights)], about)
        for weights, about in (
            (failed, "failed"),
            (alive, "alive"),
            (finite, "mean life"),
            (endless, "lives for ever"),
            ([1.0] * len(states), "weight"),
        )
    ]
    lines += ["", "    def look(self, belief, at):", *_unpacked(len(states))]
    return [*lines, *sums(looks)]


def _unpacked(count: int) -> list[str]:
    names = [f"b{i}" for i in range(count)]
    return [f"        {', '.join(names)}{',' if count == 1 else ''} = belief"]


def _dot(one: _Numbers, other: _Numbers) -> float:
    return fsum(a * b for a, b in zip(one, other, strict=True))


NODES_WRITTEN_OUT = 4000
"""Nodes of a diagram up to which its sums are written out; a loop is slower, but has no text."""


def tree_lines(
    name: str, tree: FaultTree, orders: Sequence[tuple[int, str]], limit: int
) -> Iterator[str]:
    """Yield the lines of the class.

    Args:
        name: of the class.
        tree: the tree.
        orders: (event that stands for a dynamic gate, class of its chain).
        limit: nodes up to which sums are written out.
    """
    events, diagram = tree.events, tree.diagram
    written = diagram is not None and diagram.size <= limit
    exact = "tree.FaultTree" if written else "large_tree.LargeTree"
    yield f"class {name}({exact if diagram else 'cut_sets.BoundedTree'}):"
    yield from assignment("names", tuple_of(text_literal(event.name) for event in events), 4)
    observed = tuple((i, event.input) for i, event in enumerate(events) if event.input is not None)
    models = tuple((i, event.model) for i, event in enumerate(events) if event.law == "model")
    for key, rows in (("observed", observed), ("models", models)):
        if rows:
            yield from assignment(key, literal(rows), 4)
    if orders:
        made = (tuple_of([str(i), order]) for i, order in orders)
        yield from assignment("orders", tuple_of(made), 4)
    if tree.repair:
        yield "    repair = True"
    if tree.cut_sets is not None:
        yield "    # Minimal cut sets, by the numbers of the events."
        sets = (Item(literal(tuple(sorted(cut_set)))) for cut_set in tree.cut_sets)
        yield from assignment("sets", tuple_of(sets), 4)
    elif diagram is not None:
        if not diagram.coherent:
            yield "    grows = False"
        if not written or (not diagram.coherent and (observed or models)):
            yield "    # Nodes (variable, high, low) of each module, and its root."
            yield from assignment("modules", literal(table(diagram)), 4)
    yield from _laws(events)
    if diagram is not None and written:
        for method, of_failure in (("failure", True), ("survival", False)):
            yield from ("", f"    def {method}(self, q):")
            yield from _sums(tree, diagram, of_failure=of_failure)


def table(diagram: Diagram) -> tuple[object, ...]:
    """Return the modules with variables that count those before behind the events."""
    number_of = {module.variable: diagram.events + i for i, module in enumerate(diagram.modules)}
    return tuple(
        (
            tuple(
                (number_of.get(variable, variable), up, down) for variable, up, down in module.nodes
            ),
            module.root,
        )
        for module in diagram.modules
    )


def _laws(events: Sequence[Event]) -> Iterator[str]:
    values = [_law(event) for event in events]
    yield ""
    yield "    def laws(self, age, horizon):"
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
        whole = f"{before} + age" if event.age else "age"
        if event.input is None:
            return f"tree.weibull(0.0, {whole} + horizon, {scale}, {shape})"
        return f"tree.weibull({whole}, horizon, {scale}, {shape})"
    return number(event.values[0]) if event.law == "fixed" else "0.0"


def _about(name: str, place: str) -> str:
    return comment(f"{name}: {place}" if place else name)


def _sums(tree: FaultTree, diagram: Diagram, *, of_failure: bool) -> Iterator[str]:
    """Yield sums of products of what is not negative: nothing cancels, 1e-27 keeps its digits."""
    events = tree.events
    gates = (
        (f"{gate.type} {named.name}".rstrip(), named.place)
        for gate, named in zip(tree.gates, tree.names, strict=True)
    )
    named = [*((event.name, event.place) for event in events), *gates]
    if len(events) == 1:
        yield f"        q0 = q[0]  # {_about(*named[0])}".rstrip("# ")
    else:
        yield "        ("
        for i in range(len(events)):
            yield f"            q{i},  # {_about(*named[i])}".rstrip("# ")
        yield "        ) = q"
    complements: set[int] = set()
    last = diagram.modules[-1]
    for place, module in enumerate(diagram.modules):
        if module is last and not of_failure:
            value = {FALSE: "1.0", TRUE: "0.0"}
        else:
            value = {FALSE: "0.0", TRUE: "1.0"}
        for i, (variable, high, low) in enumerate(module.nodes):
            if value[low] != "0.0" and variable not in complements:
                complements.add(variable)
                yield f"        w{variable} = 1.0 - q{variable}"
            value[i + 2] = f"n{place}_{i}"
            branches = ((f"q{variable}", value[high]), (f"w{variable}", value[low]))
            products = [
                weight if branch == "1.0" else f"{weight} * {branch}"
                for weight, branch in branches
                if branch != "0.0"
            ]
            text = " + ".join(products) or "0.0"
            about = comment(named[variable][0]) if variable < len(named) else ""
            yield from assignment(value[i + 2], text, 8, about)
        gate = _about(*named[module.variable]) if module.variable < len(named) else ""
        if module is last:
            yield from returned(value[module.root], 8, gate)
        else:
            yield from assignment(f"q{module.variable}", value[module.root], 8, gate)


Term = tuple[float, str]
"""A coefficient and the variable that it weighs."""


def sums(rows: Iterable[tuple[Sequence[Term], str]]) -> list[str]:
    """Return the lines of ``return`` of a tuple of sums, each with a comment behind it."""
    lines = ["        return ("]
    for terms, about in rows:
        parts = [_product(*term) for term in terms if term[0] != 0.0] or ["0.0"]
        flat = f"            {' + '.join(parts)},"
        behind = f"  # {about}" if about else ""
        if len(flat) > WIDTH:
            whole = [f"            {parts[0]}", *(f"            + {part}" for part in parts[1:])]
            lines += [*whole[:-1], f"{whole[-1]},{behind}"]
        elif len(flat + behind) > WIDTH:
            lines += [f"            # {about}", flat]
        else:
            lines += [flat + behind]
    return [*lines, "        )"]


def _product(weight: float, variable: str) -> str:
    return variable if weight == 1.0 else f"{variable} * {number(weight)}"

"""The class of a fault tree: laws of its events, and its diagram as sums of products."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from eddi_scaffold.compiling.reliability.diagram import FALSE, TRUE, Diagram
from eddi_scaffold.compiling.reliability.model import Event, FaultTree, Named
from eddi_scaffold.compiling.text import (
    Group,
    Item,
    assignment,
    comment,
    literal,
    number,
    returned,
    text_literal,
    tuple_of,
)

WRITTEN_OUT = 4000
"""Nodes of a diagram up to which its sums are written out; a loop is slower, but has no text."""


def class_lines(
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
        sets = (Item(literal(cut_set)) for cut_set in tree.cut_sets)
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
    rows = (Item(text, behind=_about(one)) for text, one in zip(values, events, strict=True))
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


def _about(one: Event | Named) -> str:
    return comment(f"{one.name}: {one.place}" if one.place else one.name)


def _sums(tree: FaultTree, diagram: Diagram, *, of_failure: bool) -> Iterator[str]:
    """Yield sums of products of what is not negative: nothing cancels, 1e-27 keeps its digits."""
    events = tree.events
    named: list[Event | Named] = [*events, *tree.gates]
    if len(events) == 1:
        yield f"        q0 = q[0]  # {_about(events[0])}".rstrip("# ")
    else:
        yield "        ("
        for i, event in enumerate(events):
            yield f"            q{i},  # {_about(event)}".rstrip("# ")
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
            text = _sum(variable, value[high], value[low])
            about = comment(named[variable].name) if variable < len(named) else ""
            yield from assignment(value[i + 2], text, 8, about)
        gate = _about(named[module.variable]) if module.variable < len(named) else ""
        if module is last:
            yield from returned(value[module.root], 8, gate)
        else:
            yield from assignment(f"q{module.variable}", value[module.root], 8, gate)


def _sum(variable: int, high: str, low: str) -> str:
    parts = []
    for weight, value in ((f"q{variable}", high), (f"w{variable}", low)):
        if value != "0.0":
            parts.append(weight if value == "1.0" else f"{weight} * {value}")
    return " + ".join(parts) or "0.0"

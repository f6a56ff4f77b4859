"""Small event models, written as expressions in tuples."""

from __future__ import annotations

from eddi_scaffold.conditions.analysis import Analysis
from eddi_scaffold.kinds.event.events import Events
from eddi_scaffold.program.input_expressions import class_of
from eddi_scaffold.program.instructions import BUFFERED, WINDOWS
from eddi_scaffold.program.running import module_of
from runtime_lib.tests.bound_models import bound_input, bound_model

SECOND = 10**9


def form(*outputs, variables=("x", "y", "a", "b"), period=SECOND, **said):
    """Return an intermediate form.

    Args:
        outputs: expressions: a name, a number, True or False, or (op, argument, ...); windows are
            (op, argument, seconds[, coverage]).
        variables: one letter each; a to c are booleans, m is an ENUM of P and Q, others numbers.
        period: nanoseconds.
        said: variable -> further keys of its entry.
    """
    rows = []

    def add(row):
        rows.append(dict(row, at=[1, 1]))
        return len(rows) - 1

    def made(term):
        if isinstance(term, bool):
            return add({"op": "truth", "value": 2 if term else 0})
        if term is None or isinstance(term, (int, float)):
            return add({"op": "number", "value": None if term is None else float(term)})
        if isinstance(term, str):
            return add({"op": "variable", "value": variables.index(term)})
        op, *args = term
        if op == "literal":
            return add({"op": op, "value": args[0]})
        if op == "age":
            return add({"op": op, "value": variables.index(args[0])})
        if op in WINDOWS:
            row = {"op": op, "args": [made(args[0])], "window": round(args[1] * SECOND)}
            if op in BUFFERED:
                row["capacity"] = 16
            if len(args) > 2:
                row["coverage"] = args[2]
            return add(row)
        return add({"op": op, "args": [made(arg) for arg in args]})

    named = []
    for number, term in enumerate(outputs):
        polarity = "HAZARD" if number % 2 else "EVIDENCE"
        named.append({"id": f"e{number}", "node": made(term), "polarity": polarity})
    entries = []
    for name in variables:
        kind = "bool" if name in "abc" else "enum" if name == "m" else "number"
        entry = {"name": name, "type": kind}
        if kind == "enum":
            entry["literals"] = ["P", "Q"]
        entries.append(dict(entry, **said.get(name, {})))
    return {
        "version": 1,
        "period": period,
        "variables": entries,
        "nodes": rows,
        "outputs": named,
    }


def events(form, inputs, name="Test"):
    """Return the events of a form, with their inputs."""
    return bound_model(
        "event", name, Events("", Analysis((), (), (), {}, form, ""), 1.0), None, inputs
    )


def bound(*outputs, inputs=None, **options):
    """Return a model of the kind ``event``, with its inputs."""
    found = form(*outputs, **options)
    names = [variable["name"] for variable in found["variables"]]
    return events(found, [bound_input(one, **(inputs or {}).get(one, {})) for one in names])


def monitor(*outputs, **options):
    return bound(*outputs, **options).monitor()


def expression(document):
    """Return the compiled expression of an input."""
    head = ["from eddi_runtime import expressions", 'NAN = float("nan")']
    head += [
        "from eddi_runtime.expressions import expression, hold, lists, stacks, window, windows"
    ]
    return module_of("\n".join([*head, *class_of("One", document)]), "expression").One()

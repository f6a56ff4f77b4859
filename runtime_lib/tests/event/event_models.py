"""Small event models, written as expressions in tuples."""

from __future__ import annotations

from eddi_scaffold.conditions.analysis import Analysis
from eddi_scaffold.conditions.graph import GraphBuilder
from eddi_scaffold.kinds.event.events import Events
from eddi_scaffold.program.input_expressions import class_of
from eddi_scaffold.program.instructions import BUFFERED, WINDOWS, Operation, Read, Result
from eddi_scaffold.program.running import module_of
from runtime_lib.tests.bound_models import bound_input, bound_model

SECOND = 10**9


def form(*outputs, variables=("x", "y", "a", "b"), period=SECOND, **said):
    """Return a program of conditions.

    Args:
        outputs: expressions: a name, a number, True or False, or (op, argument, ...); windows are
            (op, argument, seconds[, coverage]).
        variables: one letter each; a to c are booleans, m is an ENUM of P and Q, others numbers.
        period: nanoseconds.
        said: variable -> further fields of what is read.
    """
    builder = GraphBuilder(period)
    rows = builder.operations

    def add(op, *args, **more):
        rows.append(Operation(op, args, "", about=f"1:1 {op}", at=(1, 1), **more))
        return len(rows) - 1

    def made(term):
        if isinstance(term, bool):
            return add("truth", value=2 if term else 0)
        if term is None or isinstance(term, (int, float)):
            return add("number", value=None if term is None else float(term))
        if isinstance(term, str):
            return add("variable", value=variables.index(term))
        op, *args = term
        if op == "literal":
            return add(op, value=args[0])
        if op == "age":
            return add(op, value=variables.index(args[0]))
        if op in WINDOWS:
            more = {"window": round(args[1] * SECOND), "capacity": 16 if op in BUFFERED else 0}
            return add(op, made(args[0]), coverage=args[2] if len(args) > 2 else None, **more)
        return add(op, *map(made, args))

    results = [Result(f"e{k}", made(term), k % 2 == 1) for k, term in enumerate(outputs)]
    reads = []
    for name in variables:
        type_ = "bool" if name in "abc" else "enum" if name == "m" else "number"
        read = Read(name, type_, literals=("P", "Q") if type_ == "enum" else ())
        reads.append(read._replace(**said.get(name, {})))
    return builder.program(reads, results)


def events(program, inputs, name="Test"):
    return bound_model(
        "event", name, Events("", Analysis((), (), (), {}, program, ""), 1.0), None, inputs
    )


def bound(*outputs, inputs=None, **options):
    found = form(*outputs, **options)
    names = [read.name for read in found.reads]
    return events(found, [bound_input(one, **(inputs or {}).get(one, {})) for one in names])


def monitor(*outputs, **options):
    return bound(*outputs, **options).monitor()


def expression(document):
    head = ["from eddi_runtime import expressions", 'NAN = float("nan")']
    head += [
        "from eddi_runtime.expressions import expression, hold, lists, stacks, window, windows"
    ]
    return module_of("\n".join([*head, *class_of("One", document)]), "expression").One()

"""Conditions node by node as they are written, for their evaluation by definition.

Nothing is folded, shared or lowered: it shares only the parser with what is compiled.
"""

from eddi_scaffold.conditions.definition import History, Sample
from eddi_scaffold.conditions.parser import parse
from eddi_scaffold.program.instructions import Operation, Program, Result
from tests.conditions.formulas import PERIOD, READS, Step

_ERROR = 1e-11  # of the results of windows, which are added up in another order


def program_of(text: str) -> Program:
    """Return the program of a text over the fixed variables."""
    file, rows, new = parse(text), list[Operation](), list[int]()
    names, roots = [read.name for read in READS], {of.name: of.root for of in file.events}

    def add(op: str, *args: int, **more: object) -> int:
        rows.append(Operation(op, args, "", **more))
        return len(rows) - 1

    for node in file.nodes:
        args, name = [new[k] for k in node.args], node.text
        if node.op == "number":
            new.append(add("number", value=float(name)))
        elif node.op == "truth":
            new.append(add("truth", value=2 * (name.upper() == "TRUE")))
        elif node.op == "name" and name in roots:
            new.append(new[roots[name]])
        elif node.op == "name" and name in names:
            new.append(add("variable", value=names.index(name)))
        elif node.op == "name":
            literals = next(read.literals for read in READS if name in read.literals)
            new.append(add("literal", value=literals.index(name)))
        elif node.op == "age":
            new.append(add("age", value=names.index(file.nodes[node.args[0]].text)))
        elif node.op == "clamp":
            x, low, high = args
            new.append(add("least", add("greatest", x, low), high))
        elif node.op == "hypot":
            new.append(add("sqrt", add("add", *(add("mul", k, k) for k in args))))
        else:
            new.append(add(node.op, *args, window=node.window, coverage=node.coverage))
    results = tuple(Result(event.name, new[event.root]) for event in file.events)
    return Program(PERIOD, tuple(READS), tuple(rows), results)


def by_definition(text: str, steps: list[Step]) -> list[list[tuple[object, object]]]:
    """Return for each result at each step the least and the greatest, where sums are rounded."""
    samples = [
        Sample(step.t, step.values, {name: step.t - t for name, t in step.stamps.items()})
        for step in steps
    ]
    ends = [History(program_of(text), samples, error=n).results() for n in (-_ERROR, _ERROR)]
    return [[*zip(*rows, strict=True)] for rows in zip(*ends, strict=True)]

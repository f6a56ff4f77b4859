"""Expressions of inputs in place of the inputs: one program, which reads messages."""

from __future__ import annotations

from collections.abc import Sequence

from eddi_scaffold.compiling.expressions.emission import Names
from eddi_scaffold.compiling.expressions.form import read_form
from eddi_scaffold.compiling.monitor import BoundInput
from eddi_scaffold.compiling.program.building import Builder
from eddi_scaffold.compiling.program.instructions import BOOL, Operation, Program, Read

_TYPES = {"bool": "bool", "float": "number"}
"""Type of an expression that is what its input gives -> type of what is read."""


def inlined(program: Program, inputs: Sequence[BoundInput]) -> Program:
    """Return a program that computes the inputs which an expression gives.

    Texts, rounded numbers and reductions of lists stay inputs.

    Args:
        program: what reads the inputs.
        inputs: what it reads, in order.
    """
    if all(spec.expression is None for spec in inputs):
        return program
    builder = Builder()
    given: dict[int, int] = {}
    period = program.period
    for k, (read, spec) in enumerate(zip(program.reads, inputs, strict=True)):
        found = _program(spec, read)
        if found is not None:
            period = found.period
            result = builder.append(found)[found.results[0].operation]
            if spec.expression is not None and spec.expression.get("polarity") == "HAZARD":
                result = _unless_false(builder, result, found.operations[-1].about)
            given[k] = result
    places = builder.append(program, given)
    results = [one._replace(operation=places[one.operation]) for one in program.results]
    return builder.program(period, results)


def _program(spec: BoundInput, read: Read) -> Program | None:
    """Return the program that gives the value of an input, None where there is none."""
    document = spec.expression
    if document is None or _TYPES.get(document["type"]) != read.type:
        return None
    (part,) = document["parts"]
    found = read_form(part["form"])
    if any(one.reduction is not None or one.text for one in found.reads):
        return None
    names = Names(document)
    reads = (_bounded(one, names, read.timeout) for one in found.reads)
    return found._replace(reads=tuple(reads))


def _bounded(read: Read, names: Names, limit: int | None) -> Read:
    """Return what is read of a message, which is UNKNOWN when that is older than the limit."""
    if limit is not None and names.is_message(read.name):
        limit = limit if read.timeout is None else min(limit, read.timeout)
        read = read._replace(timeout=limit, stamped=True)
    checked = "UNKNOWN where the message says that it is no measurement"
    return read._replace(about=checked) if len(names.field(read.name)) > 1 else read


def _unless_false(builder: Builder, truth: int, about: str) -> int:
    """Add that UNKNOWN is TRUE; return the number of the operation."""
    known = builder.add(Operation("known_bool", (truth,), BOOL, about=f"KNOWN({about})"))
    unknown = builder.add(Operation("not", (known,), BOOL, about="HAZARD: UNKNOWN is true"))
    return builder.add(Operation("or", (truth, unknown), BOOL, about=about))

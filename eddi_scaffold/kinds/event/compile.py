"""Events as straight-line Python: read the inputs, then a line for each operation."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from eddi_scaffold.conditions.uses import accepted
from eddi_scaffold.program import instructions
from eddi_scaffold.program import python_text as py
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import (
    CompiledMonitor,
    Declaration,
    attribute_of,
    head_lines,
)
from eddi_scaffold.program.python_step import Printer, names_of, stamp_name

FORMAT = 1


def compile_events(program: instructions.Program, declaration: Declaration) -> CompiledMonitor:
    """Compile configured events: what each needs as tables, the step as text."""
    sampling = instructions.Sampling(program)
    numbers = {input_.id: k for k, input_ in enumerate(declaration.inputs)}
    places = [numbers[input_.name] for input_ in sampling.inputs]
    sampled = {input_.name: input_ for input_ in sampling.inputs}
    reads = {
        read.name: read
        for read in program.reads
        if read.type == instructions.NUMBER and read.reduction is None and not read.text
    }
    types = (_type(sampled.get(input_.id)) for input_ in declaration.inputs)
    limits = (_limits(reads.get(input_.id)) for input_ in declaration.inputs)
    events = []
    for result, used in zip(program.results, instructions.reads_of_results(program), strict=True):
        needs = sorted({place for read in used for place in sampling.uses[read]})
        words = tuple(
            dict.fromkeys(silence.word for silence in accepted(program, result.operation))
        )
        more = {"accepts": py.literal(words)} if words else {}
        inputs = py.literal(tuple(places[k] for k in needs))
        row = [py.text_literal(result.id), str(result.hazard), inputs]
        events.append(py.call("event.Event", row, **more))
    lines = [
        *head_lines("event.EventMonitor", declaration, {}),
        *py.assignment("types", py.tuple_of(types), 4),
        *py.assignment("limits", py.tuple_of(limits), 4),
        *py.assignment("events", py.tuple_of(events), 4),
    ]
    reduced = tuple(
        places[used[0]]
        for read, used in zip(program.reads, sampling.uses, strict=True)
        if read.reduction is not None
    )
    if reduced:
        lines += py.assignment("reductions", py.literal(reduced), 4)
    return CompiledMonitor(FORMAT, [*lines, *_methods(program, sampling, declaration.inputs)])


def _type(input_: instructions.HostInput | None) -> py.Part:
    if input_ is None:
        return '""'
    if input_.list:
        return '"list"'
    return py.literal(input_.literals) if input_.type == "enum" else py.text_literal(input_.type)


def _limits(read: instructions.Read | None) -> py.Part:
    if read is None:
        return "None"
    low, high = read.range or (-math.inf, math.inf)
    return py.tuple_of([py.number(low), py.number(high), str(read.infinite)])


def _methods(
    program: instructions.Program, sampling: instructions.Sampling, inputs: Sequence[BoundInput]
) -> Iterator[str]:
    names, variables = names_of(program, sampling)
    printer = Printer(program, variables)
    yield from [*printer.members(), "", "    def step(self, source, t):"]
    if inputs:
        yield "        try:"
        yield from py.assignment("raw", py.tuple_of(map(_value, inputs)), 12)
        yield from ["        except Exception:", "            raw = self.read(source)"]
        yield "        self.raw = raw"
        named = dict(zip((input_.name for input_ in sampling.inputs), names, strict=True))
        yield from py.unpacked([named.get(input_.id, "_") for input_ in inputs], "raw")
    reductions = 0
    for k, (read, used) in enumerate(zip(program.reads, sampling.uses, strict=True)):
        if read.reduction is not None:
            raws = [names[place] for place in used]
            value = py.call("self.reduce", [str(reductions), f"self.reduce_{k}", *raws])
            yield from py.assignment(variables[k], value, 8)
            reductions += 1
        elif variables[k] != names[used[0]]:
            yield f"        {variables[k]} = {names[used[0]]}"
        if read.stamped:
            stamp = py.call("self.stamp", ["t", py.text_literal(sampling.inputs[used[0]].name)])
            yield from py.assignment(stamp_name(variables[k]), stamp, 8)
    yield from printer.evaluation(raw=True)


def _value(input_: BoundInput) -> py.Part:
    value = attribute_of("source", input_.attribute)
    if input_.factor is None:
        return value
    return py.call("expressions.scaled", [value, *map(str, input_.factor)])

"""Events as straight-line Python: read the inputs, then a line for each operation."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from eddi_scaffold.conditions.uses import accepted
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.instructions import (
    NUMBER,
    HostInput,
    Program,
    Read,
    Sampling,
    reads_of_results,
)
from eddi_scaffold.program.monitor_text import (
    CompiledMonitor,
    Declaration,
    attribute_of,
    head_lines,
)
from eddi_scaffold.program.python_step import Printer, names_of, stamp_name
from eddi_scaffold.program.python_text import (
    Part,
    assignment,
    call,
    literal,
    number,
    text_literal,
    tuple_of,
    unpacked,
)

FORMAT = 1


def compile_events(program: Program, declaration: Declaration) -> CompiledMonitor:
    """Compile configured events: what each needs as tables, the step as text."""
    sampling = Sampling(program)
    numbers = {input_.id: k for k, input_ in enumerate(declaration.inputs)}
    places = [numbers[input_.name] for input_ in sampling.inputs]
    sampled = {input_.name: input_ for input_ in sampling.inputs}
    reads = {
        read.name: read
        for read in program.reads
        if read.type == NUMBER and read.reduction is None and not read.text
    }
    types = (_type(sampled.get(input_.id)) for input_ in declaration.inputs)
    limits = (_limits(reads.get(input_.id)) for input_ in declaration.inputs)
    events = []
    for result, used in zip(program.results, reads_of_results(program), strict=True):
        needs = sorted({place for read in used for place in sampling.uses[read]})
        words = tuple(
            dict.fromkeys(silence.word for silence in accepted(program, result.operation))
        )
        more = {"accepts": literal(words)} if words else {}
        inputs = literal(tuple(places[k] for k in needs))
        row = [text_literal(result.id), str(result.hazard), inputs]
        events.append(call("event.Event", row, **more))
    lines = [
        *head_lines("event.EventMonitor", declaration, {}),
        *assignment("types", tuple_of(types), 4),
        *assignment("limits", tuple_of(limits), 4),
        *assignment("events", tuple_of(events), 4),
    ]
    reduced = tuple(
        places[used[0]]
        for read, used in zip(program.reads, sampling.uses, strict=True)
        if read.reduction is not None
    )
    if reduced:
        lines += assignment("reductions", literal(reduced), 4)
    return CompiledMonitor(FORMAT, [*lines, *_methods(program, sampling, declaration.inputs)])


def _type(input_: HostInput | None) -> Part:
    if input_ is None:
        return '""'
    if input_.list:
        return '"list"'
    return literal(input_.literals) if input_.type == "enum" else text_literal(input_.type)


def _limits(read: Read | None) -> Part:
    if read is None:
        return "None"
    low, high = read.range or (-math.inf, math.inf)
    return tuple_of([number(low), number(high), str(read.infinite)])


def _methods(program: Program, sampling: Sampling, inputs: Sequence[BoundInput]) -> Iterator[str]:
    names, variables = names_of(program, sampling)
    printer = Printer(program, variables)
    yield from [*printer.members(), "", "    def step(self, source, t):"]
    if inputs:
        yield "        try:"
        yield from assignment("raw", tuple_of(map(_value, inputs)), 12)
        yield from ["        except Exception:", "            raw = self.read(source)"]
        yield "        self.raw = raw"
        named = dict(zip((input_.name for input_ in sampling.inputs), names, strict=True))
        yield from unpacked([named.get(input_.id, "_") for input_ in inputs], "raw")
    reductions = 0
    for k, (read, used) in enumerate(zip(program.reads, sampling.uses, strict=True)):
        if read.reduction is not None:
            raws = [names[place] for place in used]
            value = call("self.reduce", [str(reductions), f"self.reduce_{k}", *raws])
            yield from assignment(variables[k], value, 8)
            reductions += 1
        elif variables[k] != names[used[0]]:
            yield f"        {variables[k]} = {names[used[0]]}"
        if read.stamped:
            stamp = call("self.stamp", ["t", text_literal(sampling.inputs[used[0]].name)])
            yield from assignment(stamp_name(variables[k]), stamp, 8)
    yield from printer.evaluation(raw=True)


def _value(input_: BoundInput) -> Part:
    value = attribute_of("source", input_.attribute)
    if input_.factor is None:
        return value
    return call("expressions.scaled", [value, *map(str, input_.factor)])

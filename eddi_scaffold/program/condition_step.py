"""What compiled conditions declare of their inputs, and the step that reads and evaluates them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

from eddi_scaffold.program import instructions
from eddi_scaffold.program import python_text as py
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import attribute_of
from eddi_scaffold.program.python_step import Printer, names_of, stamp_name


class ConditionStep:
    """The lines of one program of conditions."""

    def __init__(
        self,
        program: instructions.Program,
        inputs: Sequence[BoundInput],  # of the monitor; the program may read only some
        units: Mapping[str, str],  # of the inputs, for people
        *arguments: str,  # what `__init__` takes and passes on
    ) -> None:
        self.program, self.inputs, self.units, self.arguments = program, inputs, units, arguments
        self.sampling = instructions.Sampling(program)
        numbers = {input_.id: k for k, input_ in enumerate(inputs)}
        self._places = [numbers[input_.name] for input_ in self.sampling.inputs]

    def needs(self) -> list[tuple[int, ...]]:
        """Return for each result the numbers of the inputs that it depends on."""
        uses, places = self.sampling.uses, self._places
        return [
            tuple(places[k] for k in sorted({place for read in used for place in uses[read]}))
            for used in instructions.reads_of_results(self.program)
        ]

    def tables(self) -> list[str]:
        """Return the lines with types, limits and units of the inputs."""
        sampled = {input_.name: input_ for input_ in self.sampling.inputs}
        reads = {
            read.name: read
            for read in self.program.reads
            if read.type == instructions.NUMBER and read.reduction is None and not read.text
        }
        types = (_type(sampled.get(input_.id)) for input_ in self.inputs)
        limits = (_limits(reads.get(input_.id)) for input_ in self.inputs)
        shown = tuple(self.units.get(input_.id, "") for input_ in self.inputs)
        return [
            *py.assignment("types", py.tuple_of(types), 4),
            *py.assignment("limits", py.tuple_of(limits), 4),
            *(py.assignment("units", py.literal(shown), 4) if any(shown) else ()),
        ]

    def reductions(self) -> list[str]:
        """Return the line that names the first input of each reduction of a list."""
        reduced = tuple(
            self._places[used[0]]
            for read, used in zip(self.program.reads, self.sampling.uses, strict=True)
            if read.reduction is not None
        )
        return py.assignment("reductions", py.literal(reduced), 4) if reduced else []

    def methods(self) -> Iterator[str]:
        """Yield the lines of the methods, the step at last."""
        program, sampling, inputs = self.program, self.sampling, self.inputs
        names, variables = names_of(program, sampling)
        printer = Printer(program, variables, arguments=self.arguments)
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


def _value(input_: BoundInput) -> py.Part:
    value = attribute_of("source", input_.attribute)
    if input_.factor is None:
        return value
    return py.call("expressions.scaled", [value, *map(str, input_.factor)])

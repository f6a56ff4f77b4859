"""The class ``Monitor`` of events: what each is called and needs as tables, its step as text."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

from eddi_scaffold.compiling.document import InputData, ModelError, ModelFile, take, texts
from eddi_scaffold.compiling.expressions.form import read_form
from eddi_scaffold.compiling.inputs import attribute_of, declaration_of, head_lines
from eddi_scaffold.compiling.program.instructions import (
    BOOL,
    NUMBER,
    Program,
    Read,
    reads_of_results,
)
from eddi_scaffold.compiling.program.python import Printer, names_of, stamp_name
from eddi_scaffold.compiling.program.sampling import HostInput, Sampling
from eddi_scaffold.compiling.text import (
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


def lines_of(model_file: ModelFile) -> list[str]:
    """Return the lines of the class.

    Raises:
        ModelError: the model is wrong.
    """
    program = _program(model_file)
    sampling = Sampling(program)
    numbers = {spec.id: k for k, spec in enumerate(model_file.inputs)}
    missing = [input_.name for input_ in sampling.inputs if input_.name not in numbers]
    if missing:
        raise ModelError("", f"there is no input for the variable {missing[0]!r}")
    places = [numbers[input_.name] for input_ in sampling.inputs]
    given = {input_.name: input_ for input_ in sampling.inputs}
    types = (_type(given.get(spec.id)) for spec in model_file.inputs)
    numbers_read = {read.name: read for read in program.reads if _is_number(read)}
    limits = (_limits(numbers_read.get(spec.id)) for spec in model_file.inputs)
    events = _events(program, sampling, places, model_file.model)
    lines = [
        *head_lines("event.EventMonitor", declaration_of(model_file), {}),
        *assignment("types", tuple_of(types), 4),
        *assignment("limits", tuple_of(limits), 4),
        *assignment("events", tuple_of(events), 4),
    ]
    reduced = [
        places[used[0]]
        for read, used in zip(program.reads, sampling.uses, strict=True)
        if read.reduction is not None
    ]
    if reduced:
        lines += assignment("reductions", literal(tuple(reduced)), 4)
    return [*lines, *_methods(program, sampling, model_file.inputs)]


def _program(model_file: ModelFile) -> Program:
    program = read_form(take(model_file.model, "form", dict, "the model"))
    if any(program.operations[result.operation].type != BOOL for result in program.results):
        raise ModelError("", "an event is no truth value")
    return program


def _events(
    program: Program, sampling: Sampling, places: Sequence[int], model: Mapping[str, object]
) -> Iterator[Part]:
    accepts = model.get("accepts", {})
    if not isinstance(accepts, dict):
        raise ModelError("", "'accepts' of the model is no object")
    words = {name: texts(found, f"'accepts' of {name!r}") for name, found in accepts.items()}
    for result, used in zip(program.results, reads_of_results(program), strict=True):
        needs = sorted({k for read in used for k in sampling.uses[read]})
        more = {"accepts": literal(words[result.id])} if words.get(result.id) else {}
        numbers = literal(tuple(places[k] for k in needs))
        yield call("event.Event", [text_literal(result.id), str(result.hazard), numbers], **more)


def _type(one: HostInput | None) -> Part:
    if one is None:
        return '""'
    if one.list:
        return '"list"'
    return literal(one.literals) if one.type == "enum" else text_literal(one.type)


def _is_number(one: Read) -> bool:
    return one.type == NUMBER and one.reduction is None and not one.text


def _limits(one: Read | None) -> Part:
    if one is None:
        return "None"
    low, high = one.range or (-math.inf, math.inf)
    return tuple_of([number(low), number(high), str(one.infinite)])


def _methods(program: Program, sampling: Sampling, inputs: Sequence[InputData]) -> list[str]:
    names, variables = names_of(program, sampling)
    printer = Printer(program, variables)
    named = dict(zip((input_.name for input_ in sampling.inputs), names, strict=True))
    lines = [*printer.members(), "", "    def step(self, source, t):"]
    lines += _read(inputs, [named.get(spec.id, "_") for spec in inputs])
    reductions = 0
    for k, (read, used) in enumerate(zip(program.reads, sampling.uses, strict=True)):
        if read.reduction is not None:
            raws = [names[one] for one in used]
            value = call("self.reduce", [str(reductions), f"self.reduce_{k}", *raws])
            lines += assignment(variables[k], value, 8)
            reductions += 1
        elif variables[k] != names[used[0]]:
            lines += [f"        {variables[k]} = {names[used[0]]}"]
        if read.stamped:
            stamp = call("self.stamp", ["t", text_literal(sampling.inputs[used[0]].name)])
            lines += assignment(stamp_name(variables[k]), stamp, 8)
    return [*lines, *printer.evaluation(raw=True)]


def _read(inputs: Sequence[InputData], names: Sequence[str]) -> list[str]:
    if not inputs:
        return []
    lines = ["        try:", *assignment("raw", tuple_of(map(_value, inputs)), 12)]
    lines += ["        except Exception:", "            raw = self.read(source)"]
    return [*lines, "        self.raw = raw", *unpacked(names, "raw")]


def _value(one: InputData) -> Part:
    value = attribute_of("source", one.attribute)
    if one.factor is None:
        return value
    return call("expressions.scaled", [value, *map(str, one.factor)])

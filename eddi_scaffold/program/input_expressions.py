"""The inputs of a monitor, and the class of each that an expression gives.

Such a class reads messages and holds the windows. In place of the input, a program may compute the
expression itself.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from eddi_scaffold.program.instructions import (
    BOOL,
    Builder,
    Operation,
    Program,
    Read,
    Sampling,
    joined,
)
from eddi_scaffold.program.python_step import Printer, names_of, stamp_name
from eddi_scaffold.program.python_text import (
    Part,
    assignment,
    call,
    literal,
    text_literal,
    tuple_of,
    variables,
)

FORMAT = 3
MODULES = ("expression", "hold", "lists", "stacks", "window", "windows")
"""Modules of the part that a monitor imports where it uses them."""
_TYPES = {"bool": "bool", "float": "number"}
"""Type of an expression that is what its input gives -> type of what is read."""


@dataclass(frozen=True)
class BoundInput:
    """One input of a monitor, as ``eddi_runtime.InputSpec`` describes it."""

    id: str
    attribute: str
    requires: tuple[str, ...] = ()
    max_age: float | str | None = None
    factor: tuple[int, int] | None = None
    default: Any = None
    every_message: bool = False
    expression: Mapping[str, Any] | None = None
    accepts: tuple[str, ...] = ()
    # for people only, so no part of what is computed: topics of ``requires``, claims that it reads
    topics: Mapping[str, str] = field(default_factory=dict, compare=False)
    claims: tuple[tuple[str, str], ...] = field(default=(), compare=False)


def expression_classes(inputs: Sequence[BoundInput]) -> dict[str, str]:
    """Return input id -> name of the class that computes it, for inputs with an expression."""
    computed = [input_ for input_ in inputs if input_.expression is not None]
    names = variables([f"Expression_{input_.attribute}" for input_ in computed], ())
    return {input_.id: name for input_, name in zip(computed, names, strict=True)}


def expression_lines(inputs: Sequence[BoundInput]) -> list[str]:
    """Return the lines of the classes of all expressions."""
    classes = expression_classes(inputs)
    lines: list[str] = []
    for input_ in inputs:
        if input_.expression is not None:
            lines += [*class_of(classes[input_.id], input_.expression), "", ""]
    return lines


def class_of(name: str, document: Mapping[str, Any]) -> list[str]:
    """Return the lines of one class."""
    type_, parts = document["type"], document["parts"]
    program = joined([part["program"] for part in parts])
    sampling, sources = Sampling(program), Names(document)
    messages = dict.fromkeys(sources.split(input_.name)[0] for input_ in sampling.inputs)
    kinds = document.get("names") or {message: ["message", message] for message in messages}
    lines = [f"class {name}(expression.Expression):", f'    type = "{type_}"']
    lines += ["    hazard = True"] if document.get("polarity") == "HAZARD" else []
    if type_ == "state":
        lines += assignment("states", literal(tuple(part["state"] for part in parts)), 4)
    lines += assignment("names", literal({key: tuple(kind) for key, kind in kinds.items()}), 4)
    _, names = names_of(program, sampling)
    printer = Printer(program, names)
    lines += [*printer.members(), "", "    def step(self, t, messages, ages):"]
    for k, (read, used) in enumerate(zip(program.reads, sampling.uses, strict=True)):
        message = text_literal(sources.split(sampling.inputs[used[0]].name)[0])
        fields = [sources.field(sampling.inputs[use].name) for use in used]
        if read.reduction is None:
            value = call("self.field", ["messages", message, *fields[0]])
        else:
            reduction = [str(k), f"self.reduce_{k}", "messages", message]
            value = call("self.reduce", [*reduction, *map(tuple_of, fields)])
        lines += assignment(names[k], value, 8)
        if read.stamped:
            stamp = f"expressions.stamp(t, ages.get({message}))"
            lines += [f"        {stamp_name(names[k])} = {stamp}"]
    return [*lines, *printer.evaluation(raw=True)]


class Names:
    """Where the variables of an expression come from."""

    def __init__(self, document: Mapping[str, Any]) -> None:
        self._paths: Mapping[str, Any] = document.get("paths", {})
        self._checks: Mapping[str, Any] = document.get("checks", {})
        self.kinds: Mapping[str, Any] = document.get("names") or {}

    def split(self, name: str) -> tuple[str, tuple[Any, ...]]:
        """Split ``temps.data[1]`` into ``temps`` and the path (``data``, 1); some are given."""
        if name not in self._paths:
            first, *rest = name.replace("[", ".[").split(".")
            return first, tuple(int(key[1:-1]) if key.startswith("[") else key for key in rest)
        return name.partition(".")[0].partition("[")[0], _tuple(self._paths[name])

    def field(self, name: str) -> list[Part]:
        """Return the path of a variable, and the checks of whether it is a measurement."""
        checks = self._checks.get(name, ())
        return [literal(_tuple(path)) for path in (self.split(name)[1], *checks)]


def _tuple(value: Any) -> Any:
    return tuple(map(_tuple, value)) if isinstance(value, (list, tuple)) else value


def inlined(program: Program, inputs: Sequence[BoundInput]) -> Program:
    """Return a program that computes the inputs which an expression gives.

    Texts, rounded numbers and reductions of lists stay inputs.
    """
    if all(spec.expression is None for spec in inputs):
        return program
    builder = Builder()
    computed: dict[int, int] = {}
    period = program.period
    for k, (read, spec) in enumerate(zip(program.reads, inputs, strict=True)):
        expression = _program(spec, read)
        if expression is None or spec.expression is None:
            continue
        period = expression.period
        computed[k] = truth = builder.append(expression)[expression.results[0].operation]
        if spec.expression.get("polarity") == "HAZARD":
            about = expression.operations[-1].about
            known = Operation("known_bool", (truth,), BOOL, about=f"KNOWN({about})")
            unknown = Operation("not", (builder.add(known),), BOOL, about="HAZARD: UNKNOWN is true")
            either = (truth, builder.add(unknown))
            computed[k] = builder.add(Operation("or", either, BOOL, about=about))
    places = builder.append(program, computed)
    results = [result._replace(operation=places[result.operation]) for result in program.results]
    return builder.program(period, results)


def _program(spec: BoundInput, read: Read) -> Program | None:
    """Return the program that gives the value of an input, None where there is none."""
    document = spec.expression
    if document is None or _TYPES.get(document["type"]) != read.type:
        return None
    (part,) = document["parts"]
    program: Program = part["program"]
    if any(source.reduction is not None or source.text for source in program.reads):
        return None
    names = Names(document)
    reads = (_bounded(source, names, read.timeout) for source in program.reads)
    return program._replace(reads=tuple(reads))


def _bounded(read: Read, names: Names, limit: int | None) -> Read:
    """Return what is read of a message, which is UNKNOWN when that is older than the limit."""
    kind = names.kinds.get(names.split(read.name)[0], ["message"])[0]
    if limit is not None and kind == "message":
        limit = limit if read.timeout is None else min(limit, read.timeout)
        read = read._replace(timeout=limit, stamped=True)
    checked = "UNKNOWN where the message says that it is no measurement"
    return read._replace(about=checked) if len(names.field(read.name)) > 1 else read

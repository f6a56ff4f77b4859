"""An input of a monitor as it is compiled."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from eddi_scaffold.program.builder import Builder, joined, read_form
from eddi_scaffold.program.instructions import BOOL, Operation, Program, Read, Sampling
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


FORMAT = 3
MODULES = ("expression", "hold", "lists", "stacks", "window", "windows")
"""Modules of the part that a monitor imports where it uses them."""


def expression_classes(inputs: Sequence[BoundInput]) -> dict[str, str]:
    """Return input id -> name of the class that computes it, for inputs with an expression."""
    found = [input_ for input_ in inputs if input_.expression is not None]
    names = variables([f"Expression_{one.attribute}" for one in found], ())
    return {one.id: name for one, name in zip(found, names, strict=True)}


def expression_lines(inputs: Sequence[BoundInput]) -> list[str]:
    """Return the lines of the classes of all expressions."""
    classes = expression_classes(inputs)
    lines: list[str] = []
    for input_ in inputs:
        if input_.expression is not None:
            lines += [*class_of(classes[input_.id], input_.expression), "", ""]
    return lines


def class_of(name: str, document: Mapping[str, Any]) -> list[str]:
    """Return the lines of one class.

    Args:
        name: of the class.
        document: what ``eddi_scaffold.conditions.inputs`` made.
    """
    kind, parts = document["type"], document["parts"]
    program = joined([read_form(part["form"]) for part in parts])
    sampling = Sampling(program)
    sources = Names(document)
    words = dict.fromkeys(sources.split(input_.name)[0] for input_ in sampling.inputs)
    names = document.get("names") or {word: ["message", word] for word in words}
    lines = [f"class {name}(expression.Expression):", f'    type = "{kind}"']
    lines += ["    hazard = True"] if document.get("polarity") == "HAZARD" else []
    if kind == "state":
        lines += assignment("states", literal(tuple(part["state"] for part in parts)), 4)
    lines += assignment("names", literal({word: tuple(one) for word, one in names.items()}), 4)
    return [*lines, *_methods(program, sampling, sources)]


class Names:
    """Where the variables of an expression come from."""

    def __init__(self, document: Mapping[str, Any]) -> None:
        self._paths: Mapping[str, Any] = document.get("paths", {})
        self._checks: Mapping[str, Any] = document.get("checks", {})
        self._kinds: Mapping[str, Any] = document.get("names") or {}

    def split(self, name: str) -> tuple[str, tuple[Any, ...]]:
        """Return the first word of a name and the path behind it; those with keys are given."""
        if name not in self._paths:
            return split_name(name)
        word = name.partition(".")[0].partition("[")[0]
        return word, _tuple(self._paths[name])

    def is_message(self, name: str) -> bool:
        """Return whether a variable is read of a message, not of another input."""
        kind: str = self._kinds.get(self.split(name)[0], ["message"])[0]
        return kind == "message"

    def field(self, name: str) -> list[Part]:
        """Return the path of a variable, and the checks of whether it is a measurement."""
        checks = self._checks.get(name, ())
        return [literal(_tuple(one)) for one in (self.split(name)[1], *checks)]


def split_name(name: str) -> tuple[str, tuple[str | int, ...]]:
    """Split the name of a variable: ``temps.data[1]`` -> ``temps``, and the path ``data``, 1."""
    pieces = name.replace("[", ".[").split(".")
    parts = [int(piece[1:-1]) if piece.startswith("[") else piece for piece in pieces]
    return str(parts[0]), tuple(parts[1:])


def _tuple(value: Any) -> Any:
    return tuple(map(_tuple, value)) if isinstance(value, (list, tuple)) else value


def _methods(program: Program, sampling: Sampling, sources: Names) -> list[str]:
    _, names = names_of(program, sampling)
    printer = Printer(program, names)
    lines = [*printer.members(), "", "    def step(self, t, messages, ages):"]
    for k, (read, used) in enumerate(zip(program.reads, sampling.uses, strict=True)):
        word = text_literal(sources.split(sampling.inputs[used[0]].name)[0])
        fields = [sources.field(sampling.inputs[one].name) for one in used]
        if read.reduction is None:
            value = call("self.field", ["messages", word, *fields[0]])
        else:
            reduce = [str(k), f"self.reduce_{k}", "messages", word]
            value = call("self.reduce", [*reduce, *map(tuple_of, fields)])
        lines += assignment(names[k], value, 8)
        if read.stamped:
            stamp = f"expressions.stamp(t, ages.get({word}))"
            lines += [f"        {stamp_name(names[k])} = {stamp}"]
    return [*lines, *printer.evaluation(raw=True)]


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

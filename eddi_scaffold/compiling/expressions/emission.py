"""The class of each input that an expression gives: it reads messages and holds the windows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from eddi_scaffold.compiling.expressions.form import joined, read_form
from eddi_scaffold.compiling.monitor import BoundInput
from eddi_scaffold.compiling.program.instructions import Program
from eddi_scaffold.compiling.program.python import Printer, names_of, stamp_name
from eddi_scaffold.compiling.program.sampling import Sampling
from eddi_scaffold.compiling.text import (
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

"""The inputs of a monitor as text: one ``InputSpec`` each, and how its attribute is read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from eddi_scaffold.compiling.expressions.emission import expression_classes
from eddi_scaffold.compiling.monitor import BoundInput, Declaration
from eddi_scaffold.compiling.text import (
    Item,
    Part,
    assignment,
    call,
    comment,
    is_identifier,
    literal,
    text_literal,
    tuple_of,
)


def head_lines(base: str, declaration: Declaration, paths: Mapping[str, str]) -> list[str]:
    """Return the first lines of the class ``Monitor``: whose monitor it is, and its inputs.

    Args:
        base: class of the runtime that it inherits from.
        declaration: of the monitor.
        paths: input id -> fragment path of its element in the EDDI.
    """
    return [
        f"class Monitor({base}):",
        f"    model_id = {text_literal(declaration.model_id)}",
        f'    digest = "{declaration.digest}"',
        *_input_lines(declaration.inputs, paths),
    ]


def _input_lines(inputs: Sequence[BoundInput], paths: Mapping[str, str]) -> list[str]:
    """Return the lines of the class attribute ``inputs``; expressions are classes above it.

    Args:
        inputs: in the order of the model file.
        paths: input id -> fragment path of its element in the EDDI.
    """
    classes = expression_classes(inputs)
    rows = (
        Item(_spec(input_, classes.get(input_.id)), above=comment(paths.get(input_.id, "")))
        for input_ in inputs
    )
    return assignment("inputs", tuple_of(rows), 4)


def attribute_of(source: str, attribute: str) -> str:
    """Return the expression that reads an attribute."""
    if is_identifier(attribute):
        return f"{source}.{attribute}"
    return f"getattr({source}, {text_literal(attribute)})"


def _spec(one: BoundInput, expression: str | None) -> Part:
    named: dict[str, Any] = {
        "requires": one.requires or None,
        "max_age": one.max_age,
        "factor": one.factor,
        "default": one.default,
        "every_message": one.every_message or None,
        "accepts": one.accepts or None,
    }
    given = {key: literal(value) for key, value in named.items() if value is not None}
    if expression is not None:
        given["expression"] = expression
    return call("InputSpec", [text_literal(one.id), text_literal(one.attribute)], **given)

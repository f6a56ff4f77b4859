"""Two numbers of an expression in one unit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from eddi_scaffold.common.units import converted, dimension, factor, word
from eddi_scaffold.conditions.findings import TextFindings
from eddi_scaffold.conditions.form_builder import GraphBuilder
from eddi_scaffold.conditions.scope import NUMBER, Type


@dataclass(frozen=True)
class Value:
    """What a node of the text is.

    Attributes:
        type: of its value.
        unit: of its value, ``None`` for none.
        node: its number in the graph.
    """

    type: Type
    unit: str | None
    node: int


Pair = tuple[Value, Value]


def aligned(
    left: Value, right: Value, places: Sequence[int], builder: GraphBuilder, findings: TextFindings
) -> Pair | None:
    """Bring two numbers to one unit; ``None`` when that cannot be.

    Args:
        left: one of them.
        right: the other.
        places: offsets of both.
        builder: the graph; constants are converted in it.
        findings: gets E009 and E013.
    """
    constant = [builder.is_constant(one.node) for one in (left, right)]
    if left.unit == right.unit:
        return left, right
    if left.unit is not None and factor(left.unit, right.unit or "") == 1:
        return left, replace(right, unit=left.unit)  # another name of the same
    if left.unit is None or right.unit is None:
        return _with_plain(left, right, constant, places, builder, findings)
    if dimension(left.unit) != dimension(right.unit):
        shown = " and ".join(f"{one} ({dimension(one)})" for one in (left.unit, right.unit))
        at = places[0 if constant[0] and not constant[1] else 1]
        findings.add("E009.apart", at, shown=shown)
        return None
    if constant[1]:
        made = _converted(right, left.unit, places[1], builder, findings)
        return None if made is None else (left, made)
    if constant[0]:
        made = _converted(left, right.unit, places[0], builder, findings)
        return None if made is None else (made, right)
    times = converted(1.0, right.unit, left.unit)
    findings.add("E009.scale", places[1], unit=left.unit, right_unit=right.unit, times=times)
    return None


def _with_plain(
    left: Value,
    right: Value,
    constant: Sequence[bool],
    places: Sequence[int],
    builder: GraphBuilder,
    findings: TextFindings,
) -> Pair | None:
    """Bring a plain number to the unit of the other side."""
    plain = 0 if left.unit is None else 1
    unit = left.unit or right.unit or ""
    if constant[1 - plain] and not constant[plain]:
        hint = f"declare the unit: VAR name : NUMBER UNIT {word(unit)}"
        if builder.rows[(left, right)[plain].node]["op"] != "variable":
            hint = "what *, / and RATE give has no unit: write the number without one"
        findings.add("E009.one_side", places[1 - plain], hint=hint, unit=unit)
        return None
    return replace(left, unit=unit), replace(right, unit=unit)


def _converted(
    value: Value, unit: str, place: int, builder: GraphBuilder, findings: TextFindings
) -> Value | None:
    """Return a constant in another unit of its dimension."""
    row = builder.rows[value.node]
    number = None if row["value"] is None else converted(row["value"], value.unit or "", unit)
    if number is not None and not math.isfinite(number):
        findings.add("E013.number_in_unit", place, unit=unit)
        return None
    line, column = row["at"]
    return Value(NUMBER, unit, builder.number(number, (line, column)))

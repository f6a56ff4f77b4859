"""Sums of products, and conditions, as text in the form that the formatter leaves as it is."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from eddi_scaffold.compiling.text import WIDTH, number

Term = tuple[float, str]
"""A coefficient and the variable that it weighs."""


def sums(rows: Iterable[tuple[Sequence[Term], str]]) -> list[str]:
    """Return the lines of ``return`` of a tuple of sums, each with a comment behind it."""
    lines = ["        return ("]
    for terms, about in rows:
        parts = [_product(*term) for term in terms if term[0] != 0.0] or ["0.0"]
        flat = f"            {' + '.join(parts)},"
        behind = f"  # {about}" if about else ""
        if len(flat) > WIDTH:
            whole = [f"            {parts[0]}", *(f"            + {part}" for part in parts[1:])]
            lines += [*whole[:-1], f"{whole[-1]},{behind}"]
        elif len(flat + behind) > WIDTH:
            lines += [f"            # {about}", flat]
        else:
            lines += [flat + behind]
    return [*lines, "        )"]


def condition(parts: Sequence[str], indent: int) -> list[str]:
    """Return the lines of ``if`` all of these."""
    flat, blanks = " and ".join(parts), " " * indent
    if len(f"{blanks}if {flat}:") <= WIDTH:
        return [f"{blanks}if {flat}:"]
    terms = " and ".join(parts).split(" and ")
    rows = (f"{blanks}    {'and ' if place else ''}{term}" for place, term in enumerate(terms))
    return [f"{blanks}if (", *rows, f"{blanks}):"]


def _product(weight: float, variable: str) -> str:
    return variable if weight == 1.0 else f"{variable} * {number(weight)}"

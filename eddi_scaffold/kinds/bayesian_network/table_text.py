"""Lines that are not a bracket: sums that are too long for one line, and unpacked names."""

from __future__ import annotations

from collections.abc import Sequence

from eddi_scaffold.program import python_text as py


def sum_lines(target: str, terms: Sequence[str], indent: int) -> list[str]:
    """Return the lines of ``target = term + term``, added from left to right."""
    blanks = " " * indent
    lines, line = [], f"{blanks}{target} = {terms[0]}"
    for term in terms[1:]:
        if len(line) + len(term) + 3 > py.WIDTH:
            lines.append(line)
            line = f"{blanks}{target} = {target}"
        line += f" + {term}"
    return [*lines, line]


def look_up_lines(
    name: str, tables: Sequence[Sequence[tuple[int, int]]], about: Sequence[str]
) -> list[str]:
    """Return a function: rows of each table -> the look-up, states -> a row of each table.

    A table is given by (position of an input, distance between the rows of its states).
    """
    rows = [f"t{k}" for k in range(len(tables))]
    lines = [f"    # t{k}: {of}" for k, of in enumerate(about)]
    lines += [*py.unpacked(rows, "tables", 4), "", "    def look_up(s):"]
    case_of: dict[tuple[tuple[int, int], ...], str] = {}
    for strides in map(tuple, tables):
        if strides not in case_of:
            terms = [f"s[{position}] * {by}" for position, by in strides] or ["0"]
            case_of[strides] = f"k{len(case_of)}"
            lines += sum_lines(case_of[strides], terms, 8)
    items = (py.Item(f"{t}[{case_of[tuple(of)]}]") for t, of in zip(rows, tables, strict=True))
    lines += py.returned(py.Group("[", tuple(items), "]"), 8)
    return [f"def {name}(*tables):", *lines, "", "    return look_up"]


def total_lines(
    name: str,
    rows: Sequence[Sequence[float]],
    counts: Sequence[int],
    strides: Sequence[int],
    axes: Sequence[str],
    states: Sequence[str],
) -> list[str]:
    """Return a function: one vector for each axis -> the sum of all products with a table.

    ``counts`` numbers of each axis are summed, whose rows are ``strides`` apart; ``axes`` and
    ``states`` (of a row) are comments.
    """
    lines = [f"def {name}(v):"]
    for axis, count in enumerate(counts):
        lines.append(f"    # {axes[axis]}")
        lines += py.unpacked([f"v{axis}_{k}" for k in range(count)], f"v[{axis}]", 4)
    count = 0

    def terms(axis: int, offset: int, state: int) -> list[str]:
        nonlocal count
        texts = []
        for k in range(counts[axis]):
            place = offset + k * strides[axis]
            if axis + 1 == len(counts):
                texts.append(f"v{axis}_{k} * {py.number(rows[place][state])}")
                continue
            inner = terms(axis + 1, place, state)
            text = f"({' + '.join(inner)})"
            if len(text) > py.WIDTH - 30:
                text, count = f"x{count}", count + 1
                lines.extend(sum_lines(text, inner, 4))
            texts.append(f"v{axis}_{k} * {text}")
        return texts

    names = [f"p{state}" for state in range(len(rows[0]))]
    for state, name_of_sum in enumerate(names):
        lines.append(f"    # {states[state]}")
        of_state = terms(0, 0, state) if counts else [py.number(rows[0][state])]
        lines += sum_lines(name_of_sum, of_state, 4)
    return [*lines, *py.returned(py.Group("[", tuple(map(py.Item, names)), "]"), 4)]

"""The canonical form: every operator in parentheses, durations in whole ms or ns."""

from __future__ import annotations

from eddi_scaffold.language.syntax import (
    OPERATORS,
    PREFIXES,
    File,
    ReductionOptions,
    SyntaxNode,
    word_of,
)

_MS = 10**6


def canonical(file: File, root: int) -> str:
    """Return the canonical form of the expression that ends at a node."""
    first = root
    while file.nodes[first].args:  # the operands of an expression are right before it
        first = file.nodes[first].args[0]
    texts: list[str] = []
    for node in file.nodes[first : root + 1]:
        texts.append(_text(node, [texts[k - first] for k in node.args]))
        for k in node.args:
            texts[k - first] = ""  # each is used once: what is printed can go
    return texts[-1]


def number_text(value: float) -> str:
    """Return the shortest text that gives this number again: ``100``, ``0.5``, ``1e-07``."""
    text = repr(float(value))
    return text.removesuffix(".0")


def duration_text(ns: int) -> str:
    """Return a duration in the canonical form."""
    return f"{ns}ns" if ns % _MS else f"{ns // _MS}ms"


def _listed(options: ReductionOptions, args: list[str]) -> list[str]:
    """Return the list of a reduction, and its options in one order."""
    found = args[:1]
    if options.sector is not None:
        ends = [f"{number_text(one.value)} {one.unit}" for one in options.sector]
        found.append(f"SECTOR {' .. '.join(ends)}")
    if options.length is not None:
        found.append(f"LENGTH {' .. '.join(str(n) for n in dict.fromkeys(options.length))}")
    if options.within:
        found.append(f"WITHIN {args[1]} .. {args[2]}")
    if options.coverage is not None:
        found.append(f"COVERAGE {number_text(options.coverage)}")
    return found


def _text(node: SyntaxNode, args: list[str]) -> str:
    if node.op in OPERATORS:
        return f"({args[0]} {OPERATORS[node.op]} {args[1]})"
    if node.op in PREFIXES:
        return f"({PREFIXES[node.op]}{args[0]})"
    if node.op == "number":
        return number_text(float(node.text)) + (f" {node.unit}" if node.unit else "")
    if node.op == "truth":
        return node.text.upper()
    if node.op == "name":
        return node.text
    if node.options is not None:
        return f"{word_of(node.op)}({', '.join(_listed(node.options, args))})"
    inside = [*args]
    if node.window:
        inside.append(duration_text(node.window))
    if node.coverage is not None:
        inside.append(f"COVERAGE {number_text(node.coverage)}")
    return f"{word_of(node.op)}({', '.join(inside)})"

"""Declarations that would do what a hand-written body does (SESAME D7.2 Fig 19)."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from itertools import pairwise

from eddi_scaffold.adopting.modules import Body
from eddi_scaffold.regions.python_text import parse_shallow


@dataclass(frozen=True)
class BodyUse:
    """What a body does with its node.

    Attributes:
        observed: it sets an outcome.
        output: it sets the flag of outputs.
        proposal: line for ``discretisation:``, ``None`` when its form is another one.
    """

    observed: bool
    output: bool
    proposal: str | None


def use_of(node: str, body: Body, outcomes: dict[str, str]) -> BodyUse:
    """Look at a body.

    Args:
        node: name of the node.
        body: what a person wrote.
        outcomes: variable (``outcome_Yes``) -> state.
    """
    try:
        tree = parse_shallow("if True:\n" + _shifted(body.text))
    except SyntaxError:
        return BodyUse(observed=False, output=False, proposal=None)
    names = {
        target.id: one.value
        for one in ast.walk(tree)
        if isinstance(one, ast.Assign)
        for target in one.targets
        if isinstance(target, ast.Name)
    }
    observed = any(name in outcomes for name in names)
    flag = names.get("is_bn_output")
    output = isinstance(flag, ast.Constant) and flag.value is True
    first = tree.body[0]
    statements = first.body if isinstance(first, ast.If) else []
    return BodyUse(observed, output, _proposal(node, statements, outcomes))


def _shifted(text: str) -> str:
    lines = text.expandtabs(8).split("\n")
    least = min((len(one) - len(one.lstrip()) for one in lines if one.strip()), default=0)
    return "\n".join(f" {one[least:]}" if one.strip() else "" for one in lines)


def _proposal(node: str, statements: list[ast.stmt], outcomes: dict[str, str]) -> str | None:
    """Return a declaration for a chain of comparisons of one attribute with rising constants."""
    names: dict[str, str] = {}
    chain: ast.stmt | None = None
    for one in statements:
        if isinstance(one, ast.Assign) and isinstance(one.targets[0], ast.Name) and chain is None:
            attribute = _attribute(one.value, names)
            if attribute is None:
                return None
            names[one.targets[0].id] = attribute
        elif isinstance(one, ast.If) and chain is None:
            chain = one
        else:
            return None
    edges: list[float] = []
    states: list[str] = []
    sources: set[str] = set()
    strict: set[bool] = set()
    while isinstance(chain, ast.If):
        upper = _upper(chain.test, names, sources, strict, edges[-1] if edges else None)
        state = _state(chain.body, outcomes)
        if state is None or upper is False:
            return None
        states.append(state)
        if upper is None:
            chain = None if not chain.orelse else chain.orelse[0]
            if chain is not None:
                return None
            break
        edges.append(upper)
        rest = chain.orelse
        if len(rest) == 1 and isinstance(rest[0], ast.If):
            chain = rest[0]
            continue
        last = _state(rest, outcomes) if rest else None
        if last is not None:
            states.append(last)
        break
    rising = all(a < b for a, b in pairwise(edges))
    fits = len(states) == len(edges) + 1 == len(set(states)) and len(sources) == 1
    if not edges or not rising or not fits or len(strict) != 1:
        return None
    closed = ", closed: left" if True in strict else ""
    listed = ", ".join(f"{edge:g}" for edge in edges)
    order = ", ".join(states)
    return f"{node}: {{input: {sources.pop()}, bins: [{listed}], order: [{order}]{closed}}}"


def _attribute(node: ast.expr, names: dict[str, str]) -> str | None:
    """Return the input that ``self.dra_data.x``, or a variable that holds it, refers to."""
    if isinstance(node, ast.Name):
        return names.get(node.id)
    inner = node.value if isinstance(node, ast.Attribute) else None
    if isinstance(node, ast.Attribute) and isinstance(inner, ast.Attribute):
        is_data = inner.attr == "dra_data" and isinstance(inner.value, ast.Name)
        return node.attr if is_data else None
    return None


def _upper(
    test: ast.expr,
    names: dict[str, str],
    sources: set[str],
    strict: set[bool],
    lower: float | None,
) -> float | bool | None:
    """Return the upper edge of a branch, None for the last one, False for another form."""
    if not isinstance(test, ast.Compare):
        return False
    parts = [test.left, *test.comparators]
    values = [_attribute(part, names) or _number(part) for part in parts]
    if len(values) == 3:  # lower < x <= upper
        if values[0] != lower or not isinstance(values[1], str):
            return False
        values, ops = values[1:], test.ops[1:]
    else:
        ops = test.ops
    left, right = values
    op = ops[0]
    if isinstance(left, str) and isinstance(right, float) and isinstance(op, ast.Lt | ast.LtE):
        sources.add(left)
        strict.add(isinstance(op, ast.Lt))
        return right
    above = (
        isinstance(left, float) and isinstance(right, str) and isinstance(op, ast.Lt | ast.LtE)
    ) or (isinstance(left, str) and isinstance(right, float) and isinstance(op, ast.Gt | ast.GtE))
    edge = left if isinstance(left, float) else right
    return None if above and edge == lower else False


def _number(node: ast.expr) -> float | None:
    try:
        value = ast.literal_eval(node)
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        return float(value) if is_number else None
    except (ValueError, TypeError, OverflowError):
        return None


def _state(body: list[ast.stmt], outcomes: dict[str, str]) -> str | None:
    """Return the state that a branch sets for sure, and nothing else."""
    if len(body) != 1 or not isinstance(body[0], ast.Assign):
        return None
    target, value = body[0].targets[0], body[0].value
    if not isinstance(target, ast.Name) or not isinstance(value, ast.Constant) or value.value != 1:
        return None
    return outcomes.get(target.id)

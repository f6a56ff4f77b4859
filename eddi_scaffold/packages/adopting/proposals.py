"""What the old generator wrote; declarations that do what a body does (D7.2 Fig 19)."""

from __future__ import annotations

import ast
import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

from eddi_scaffold.common.escaping import parse_shallow
from eddi_scaffold.packages.adopting.old_package import Body, Method, ParsedModule
from eddi_scaffold.yaml_text.writer import dump_plain, quoted

_Position = tuple[float, int]
"""A number, and where next to it: just below (-1), at it (0), just above (1)."""
_Interval = tuple[_Position, _Position]
"""The first and the last position of an interval."""
_Branch = tuple[ast.expr | None, str]
"""The test of a branch, ``None`` for the last ``else``, and the state that it sets."""
_EVERYTHING: _Interval = ((-math.inf, 0), (math.inf, 0))


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


def use_of(
    node: str, body: Body, outcomes: Mapping[str, str], truths: Collection[str] = ()
) -> BodyUse:
    """Look at a body.

    Args:
        node: name of the node.
        body: what a person wrote.
        outcomes: variable (``outcome_Yes``) -> state.
        truths: the inputs that are true or false.
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
    proposal = _proposal(statements, outcomes, truths)
    return BodyUse(observed, output, proposal and f"{quoted(node)}: {proposal}")


def _shifted(text: str) -> str:
    lines = text.expandtabs(8).split("\n")
    least = min((len(line) - len(line.lstrip()) for line in lines if line.strip()), default=0)
    return "\n".join(f" {line[least:]}" if line.strip() else "" for line in lines)


def _proposal(
    statements: Sequence[ast.stmt], outcomes: Mapping[str, str], truths: Collection[str]
) -> str | None:
    """Return a declaration for one chain of tests of one attribute."""
    names: dict[str, str] = {}
    for statement in statements[:-1]:
        held = _held(statement, names)
        if held is None:
            return None
        names |= held
    chain = statements[-1] if statements else None
    branches = _branches(chain, outcomes) if isinstance(chain, ast.If) else None
    if not branches:
        return None
    return _as_map(branches, names, truths) or _as_bins(branches, names)


def _held(statement: ast.stmt, names: Mapping[str, str]) -> dict[str, str] | None:
    """Return the variable that an assignment gives the value of an attribute."""
    if not isinstance(statement, ast.Assign) or not isinstance(statement.targets[0], ast.Name):
        return None
    attribute = attribute_of(statement.value, names)
    return None if attribute is None else {statement.targets[0].id: attribute}


def _branches(chain: ast.If, outcomes: Mapping[str, str]) -> list[_Branch] | None:
    """Return the branches of a chain, ``None`` where one does more than set a state."""
    state = _state(chain.body, outcomes)
    if state is None:
        return None
    match chain.orelse:
        case []:
            rest: list[_Branch] | None = []
        case [ast.If() as following]:
            rest = _branches(following, outcomes)
        case _:
            last = _state(chain.orelse, outcomes)
            rest = None if last is None else [(None, last)]
    return None if rest is None else [(chain.test, state), *rest]


def _as_map(
    branches: Sequence[_Branch], names: Mapping[str, str], truths: Collection[str]
) -> str | None:
    """Return the declaration of ``if x: ... else: ...`` for an input that is true or false."""
    match branches:
        case [(ast.UnaryOp(op=ast.Not(), operand=test), false), (None, true)]:
            pass
        case [(ast.expr() as test, true), (None, false)]:
            pass
        case _:
            return None
    source = attribute_of(test, names)
    if source is None or source not in truths or true == false:
        return None
    return f"{{input: {quoted(source)}, map: {{true: {quoted(true)}, false: {quoted(false)}}}}}"


def _as_bins(branches: Sequence[_Branch], names: Mapping[str, str]) -> str | None:
    """Return the declaration of comparisons with constants, in whatever order they stand.

    The constants cut the numbers into pieces; each has the state of the first test that holds.
    """
    sources: set[str] = set()
    intervals: list[tuple[_Interval, str]] = []
    for test, state in branches:
        found = _EVERYTHING if test is None else _interval(test, names, sources)
        if found is None:
            return None
        intervals.append((found, state))
    bounds = (bound for (low, high), _ in intervals for bound in (low[0], high[0]))
    edges = sorted({bound for bound in bounds if math.isfinite(bound)})
    if len(sources) != 1 or not edges:
        return None

    def state_at(position: _Position) -> str | None:
        return next((of for (low, high), of in intervals if low <= position <= high), None)

    states, bins, closed = [state_at((edges[0], -1))], [], set()
    for edge in edges:
        at, above = state_at((edge, 0)), state_at((edge, 1))
        if above == states[-1] == at:
            continue
        closed.add("right" if at == states[-1] else "left" if at == above else None)
        states.append(above)
        bins.append(edge)
    if {*states} != {of for _, of in intervals} or len(states) != len({*states}):
        return None
    if None in closed or len(closed) != 1:
        return None
    order = ", ".join(quoted(state) for state in states if state is not None)
    numbers = (int(edge) if edge.is_integer() else edge for edge in bins)
    listed = ", ".join(dump_plain(number).strip() for number in numbers)
    left = ", closed: left" if "left" in closed else ""
    return f"{{input: {quoted(sources.pop())}, bins: [{listed}], order: [{order}]{left}}}"


def _interval(test: ast.expr, names: Mapping[str, str], sources: set[str]) -> _Interval | None:
    """Return where comparisons of one attribute with constants hold."""
    if isinstance(test, ast.BoolOp) and isinstance(test.op, ast.And):
        parts = [_interval(value, names, sources) for value in test.values]
    elif isinstance(test, ast.Compare):
        parts = list(_halves(test, names, sources))
    else:
        return None
    low, high = _EVERYTHING
    for part in parts:
        if part is None:
            return None
        low, high = max(low, part[0]), min(high, part[1])
    return low, high


def _halves(
    test: ast.Compare, names: Mapping[str, str], sources: set[str]
) -> Iterator[_Interval | None]:
    """Yield where each comparison of a chain (``1 < x <= 2``) holds, ``None`` for another form."""
    operands = [test.left, *test.comparators]
    for left, op, right in zip(operands, test.ops, operands[1:], strict=False):
        name, number = attribute_of(left, names), _number(right)
        less = isinstance(op, ast.Lt | ast.LtE)
        if name is None:
            name, number, less = attribute_of(right, names), _number(left), not less
        ordered = isinstance(op, ast.Lt | ast.LtE | ast.Gt | ast.GtE)
        if name is None or number is None or not ordered:
            yield None
            return
        sources.add(name)
        strict = isinstance(op, ast.Lt | ast.Gt)
        if less:
            yield _EVERYTHING[0], (number, -strict)
        else:
            yield (number, int(strict)), _EVERYTHING[1]


def attribute_of(node: ast.AST, names: Mapping[str, str]) -> str | None:
    """Return the input that ``self.dra_data.x``, or a variable that holds it, refers to."""
    if isinstance(node, ast.Name):
        return names.get(node.id)
    inner = node.value if isinstance(node, ast.Attribute) else None
    if isinstance(node, ast.Attribute) and isinstance(inner, ast.Attribute):
        is_data = inner.attr == "dra_data" and isinstance(inner.value, ast.Name)
        return node.attr if is_data else None
    return None


def _number(node: ast.expr) -> float | None:
    try:
        value = ast.literal_eval(node)
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        return float(value) if is_number else None
    except (ValueError, TypeError, OverflowError):
        return None


def _state(body: Sequence[ast.stmt], outcomes: Mapping[str, str]) -> str | None:
    """Return the state that a branch sets for sure, and nothing else."""
    if len(body) != 1 or not isinstance(body[0], ast.Assign):
        return None
    target, value = body[0].targets[0], body[0].value
    if not isinstance(target, ast.Name) or not isinstance(value, ast.Constant) or value.value != 1:
        return None
    return outcomes.get(target.id)


_OWN = {"__init__", "update_dra_data", "processing"}


def foreign(module: ParsedModule, prefix: str) -> Iterator[ast.AST]:
    """Yield the statements of a module that the old generator did not write.

    Args:
        module: with one class of editable methods.
        prefix: of these (``node_`` or ``process_``).
    """
    yield from module.other
    for method in module.methods.values():
        if method.name.startswith(prefix):
            yield from (one for one in _outside(method) if not _generated(one))
        elif method.name not in _OWN:
            yield method.tree
        else:
            yield from (one for one in method.outside if not _ours(one))


def _outside(method: Method) -> tuple[ast.stmt, ...]:
    """Return the statements outside of the markers; a method without them was adopted whole."""
    return method.outside if method.body is not None or method.name.startswith("node_") else ()


def _generated(node: ast.stmt) -> bool:
    """Return whether a statement is one of Fig 15: initial values, and the result."""
    if isinstance(node, ast.Return | ast.Pass):
        return True
    if not isinstance(node, ast.Assign | ast.AnnAssign):
        return False
    targets = node.targets if isinstance(node, ast.Assign) else [node.target]
    value = node.value
    name = targets[0].id if isinstance(targets[0], ast.Name) else ""
    if not isinstance(value, ast.Constant):
        return False
    if name == "is_bn_output":
        return value.value is False
    return name.startswith("outcome_") and value.value == 0.0


def _ours(node: ast.stmt) -> bool:
    """Return whether a statement belongs to the generated frame of a class."""
    kinds = (ast.Assign, ast.AnnAssign, ast.If, ast.Return, ast.Pass, ast.Try)
    return isinstance(node, kinds) and not any(
        isinstance(one, ast.Call) and not _is_frame_call(one) for one in ast.walk(node)
    )


def _is_frame_call(call: ast.Call) -> bool:
    name = call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
    return name.startswith("process_") or name in {"hasattr", "getattr", "isinstance", "super"}

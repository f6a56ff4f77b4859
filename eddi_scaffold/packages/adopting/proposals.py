"""What the old generator wrote; declarations that do what a body does (D7.2 Fig 19)."""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

from eddi_scaffold.common.escaping import parse_shallow
from eddi_scaffold.packages.adopting.old_package import Body, ParsedModule
from eddi_scaffold.yaml_text.writer import dump_plain, quoted

_Position = tuple[float, int]
"""A number, and where next to it: just below (-1), at it (0), just above (1)."""
_Branch = tuple[ast.expr | None, str]
"""The test of a branch, ``None`` for the last ``else``, and the state that it sets."""
_ORDERS: Mapping[type, Callable[[_Position, _Position], bool]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}


@dataclass(frozen=True)
class BodyUse:
    """What a body does with its node."""

    observed: bool  # it sets an outcome
    output: bool  # it sets the flag of outputs
    proposal: str | None  # line for `discretisation:`, `None` when its form is another one


def use_of(
    node: str, body: Body, outcomes: Mapping[str, str], truths: Collection[str] = ()
) -> BodyUse:
    """Look at the body of a node with outcomes, variable (``outcome_Yes``) -> state.

    Some inputs are true or false.
    """
    lines = body.text.expandtabs(8).split("\n")
    least = min((len(line) - len(line.lstrip()) for line in lines if line.strip()), default=0)
    text = "\n".join(f" {line[least:]}" if line.strip() else "" for line in lines)
    try:
        tree = parse_shallow(f"if True:\n{text}")
    except SyntaxError:
        return BodyUse(observed=False, output=False, proposal=None)
    assigned = {
        target.id: statement.value
        for statement in ast.walk(tree)
        if isinstance(statement, ast.Assign)
        for target in statement.targets
        if isinstance(target, ast.Name)
    }
    flag = assigned.get("is_bn_output")
    output = isinstance(flag, ast.Constant) and flag.value is True
    first = tree.body[0]
    statements = first.body if isinstance(first, ast.If) else []
    proposal = _proposal(statements, outcomes, truths)
    observed = not outcomes.keys().isdisjoint(assigned)
    return BodyUse(observed, output, proposal and f"{quoted(node)}: {proposal}")


def _proposal(
    statements: Sequence[ast.stmt], outcomes: Mapping[str, str], truths: Collection[str]
) -> str | None:
    """Return a declaration for one chain of tests of one attribute."""
    names: dict[str, str] = {}
    *before, chain = statements or [ast.Pass()]
    for statement in before:  # variables that hold the attribute
        match statement:
            case ast.Assign(targets=[ast.Name(id=variable), *_], value=value):
                source = attribute_of(value, names)
                if source is None:
                    return None
                names[variable] = source
            case _:
                return None
    if not isinstance(chain, ast.If):
        return None
    try:
        branches = _branches([chain], outcomes)
        return _as_map(branches, names, truths) or _as_bins(branches, names)
    except KeyError:  # another form of test, or a branch that does more than set a state
        return None


def _branches(chain: Sequence[ast.stmt], outcomes: Mapping[str, str]) -> list[_Branch]:
    match chain:
        case []:
            return []
        case [ast.If(test=test, body=body, orelse=rest)]:
            return [(test, _state(body, outcomes)), *_branches(rest, outcomes)]
        case _:
            return [(None, _state(chain, outcomes))]


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
    nodes = [node for test, _ in branches if test is not None for node in ast.walk(test)]
    sources = {name for node in nodes if (name := attribute_of(node, names))}
    numbers = {number for node in nodes if math.isfinite(number := _number(node))}
    if len(sources) != 1 or not numbers:
        return None

    def state_at(position: _Position) -> str | None:
        return next((state for test, state in branches if _holds(test, names, position)), None)

    bins, closed, states = [], set(), [state_at((min(numbers), -1))]
    for edge in sorted(numbers):
        at, above = state_at((edge, 0)), state_at((edge, 1))
        if above == states[-1] == at:
            continue
        closed.add("right" if at == states[-1] else "left" if at == above else None)
        states.append(above)
        bins.append(int(edge) if edge.is_integer() else edge)
    if {*states} != {state for _, state in branches} or len(states) != len({*states}):
        return None
    if closed not in ({"left"}, {"right"}):
        return None
    order = ", ".join(quoted(state) for state in states if state is not None)
    listed = ", ".join(dump_plain(number).strip() for number in bins)
    side = ", closed: left" if "left" in closed else ""
    return f"{{input: {quoted(sources.pop())}, bins: [{listed}], order: [{order}]{side}}}"


def _holds(test: ast.expr | None, names: Mapping[str, str], position: _Position) -> bool:
    """Return whether comparisons of an attribute with constants hold; KeyError: something else."""
    match test:
        case None:
            return True
        case ast.BoolOp(op=ast.And(), values=tests):
            return all(_holds(part, names, position) for part in tests)
        case ast.Compare(left=left, ops=ops, comparators=others):
            operands = [
                position if attribute_of(operand, names) else (_number(operand), 0)
                for operand in (left, *others)
            ]
            if any(math.isnan(number) for number, _ in operands):
                raise KeyError(ast.dump(test))
            pairs = zip(operands, ops, operands[1:], strict=False)
            return all(_ORDERS[type(op)](a, b) for a, op, b in pairs)
        case _:
            raise KeyError(ast.dump(test))


def attribute_of(node: ast.AST, names: Mapping[str, str]) -> str | None:
    """Return the input that ``self.dra_data.x``, or a variable that holds it, refers to."""
    match node:
        case ast.Name(id=variable):
            return names.get(variable)
        case ast.Attribute(value=ast.Attribute(value=ast.Name(), attr="dra_data"), attr=name):
            return name
    return None


def _number(node: ast.AST) -> float:
    """Return the number that is written there; not a number for anything else."""
    try:
        value = ast.literal_eval(node) if isinstance(node, ast.expr) else None
        if isinstance(value, int | float) and not isinstance(value, bool):
            return float(value)
    except (ValueError, TypeError, OverflowError):
        pass
    return math.nan


def _state(body: Sequence[ast.stmt], outcomes: Mapping[str, str]) -> str:
    """Return the state that a branch sets for sure, and nothing else (KeyError)."""
    match body:
        case [ast.Assign(targets=[ast.Name(id=variable), *_], value=ast.Constant(value=1))]:
            return outcomes[variable]
    raise KeyError(len(body))


def foreign(module: ParsedModule, prefix: str) -> Iterator[ast.stmt]:
    """Yield the statements of a module that the old generator did not write.

    Its editable methods begin with a prefix, ``node_`` or ``process_``.
    """
    yield from module.other
    for method in module.methods.values():
        if method.name.startswith(prefix):  # a process method without markers is adopted whole
            adopted = method.body is None and not method.name.startswith("node_")
            yield from (s for s in method.outside if not adopted and not _is_of_fig_15(s))
        elif method.name in {"__init__", "update_dra_data", "processing"}:
            yield from (statement for statement in method.outside if not _is_frame(statement))
        else:
            yield method.tree


def _is_of_fig_15(node: ast.stmt) -> bool:
    """Return whether a statement of a node's method is an initial value, or the result."""
    match node:
        case ast.Return() | ast.Pass():
            return True
        case (
            ast.Assign(targets=[ast.Name(id=name), *_], value=ast.Constant(value=value))
            | ast.AnnAssign(target=ast.Name(id=name), value=ast.Constant(value=value))
        ):
            return (
                value is False
                if name == "is_bn_output"
                else (name.startswith("outcome_") and value == 0.0)
            )
    return False


def _is_frame(node: ast.stmt) -> bool:
    """Return whether a statement belongs to the generated frame of a class."""
    names = [
        call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
        for call in ast.walk(node)
        if isinstance(call, ast.Call)
    ]
    kinds = (ast.Assign, ast.AnnAssign, ast.If, ast.Return, ast.Pass, ast.Try)
    called = {"hasattr", "getattr", "isinstance", "super"}
    return isinstance(node, kinds) and all(
        name.startswith("process_") or name in called for name in names
    )

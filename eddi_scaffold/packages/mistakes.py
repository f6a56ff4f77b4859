"""What cannot be meant in the hand-written body of an input: mistakes of which a tree is proof."""

from __future__ import annotations

import ast
import builtins
import symtable
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import NamedTuple, TypeGuard

from eddi_scaffold.common.problems import did_you_mean, shortened_list
from eddi_scaffold.config.message_types import element

_KNOWN = {*dir(builtins), "__file__", "__class__"}
_INDIRECT = {"exec", "eval", "globals", "setattr", "vars", "__dict__"}
_PREFIX = "process_"


class Messages(NamedTuple):
    """What is known of messages.

    Attributes:
        types: name of a parameter -> type of its messages.
        fields: type of a message that is known whole -> field -> its type.
    """

    types: Mapping[str, str] = {}
    fields: Mapping[str, Mapping[str, str]] = {}


class Inputs:
    """The methods of a file that set inputs, with what is known of its names after one walk."""

    def __init__(self, text: str, tree: ast.Module, base: str) -> None:
        self._lines = text.split("\n")
        self._text, self._tree = text, tree
        self._methods: dict[str, ast.FunctionDef] = {}
        self._owners: dict[str, ast.ClassDef] = {}
        for owner in tree.body:
            if isinstance(owner, ast.ClassDef) and [getattr(b, "id", "") for b in owner.bases] == [
                base
            ]:
                for one in owner.body:
                    if isinstance(one, ast.FunctionDef) and one.name.startswith(_PREFIX):
                        self._methods[f"{owner.name}.{one.name}"] = one
                        self._owners[f"{owner.name}.{one.name}"] = owner
        self._inputs = {method.name.removeprefix(_PREFIX) for method in self._methods.values()}

    def mistakes(self, function: str, lines: range, messages: Messages) -> Iterator[str]:
        """Yield what is wrong with the body of an input.

        Args:
            function: the qualified name of its method.
            lines: of the body.
            messages: what is known of those that parameters are given.
        """
        method = self._methods.get(function)
        if method is None:
            return
        nodes = _nodes(method, lines)
        own = method.name.removeprefix(_PREFIX)
        for name in dict.fromkeys(one.id for one in nodes if isinstance(one, ast.Name)):
            if (method.lineno, name) in self._unbound:
                yield f"{name!r} is read, but nothing of that name is here: misspelt, not imported?"
        for node in nodes:
            if isinstance(node, ast.Expr) and isinstance(node.value, ast.Compare):
                yield f"'{self._line(node)}' only compares; `=` assigns"
            if isinstance(node, ast.Assign) and _is_decimal_comma(node.value):
                yield f"'{self._line(node)}' makes a tuple; a decimal number has a point"
        yield from dict.fromkeys(_no_fields(method, nodes, messages))
        yield from _overwritten(method, lines, own)
        for name in dict.fromkeys(_assigned(nodes)):
            if name != own and name in self._inputs:
                yield f"'self.{name}' is another input, and assigned here; meant 'self.{own}'?"

    def sets_nothing(self, function: str, lines: range) -> Iterator[str]:
        """Yield that the body of an input leaves it unknown, where that is certain."""
        method = self._methods.get(function)
        if method is None:
            return
        nodes = _nodes(method, lines)
        own = method.name.removeprefix(_PREFIX)
        attributes = [node for node in nodes if isinstance(node, ast.Attribute)]
        plain = sum(map(is_self, nodes)) - sum(is_self(attribute.value) for attribute in attributes)
        called = any(isinstance(n, ast.Call) and _is_method(n.func) for n in nodes)
        names = {getattr(node, "id", getattr(node, "attr", "")) for node in nodes}
        told = {*_assigned(nodes), *self._set_elsewhere[self._owners[function].name]}
        if own not in told and not plain and not called and not names & _INDIRECT:
            yield f"nothing here assigns 'self.{own}', so the input stays unknown"

    def _line(self, node: ast.stmt) -> str:
        return self._lines[node.lineno - 1].strip()

    @cached_property
    def _set_elsewhere(self) -> dict[str, set[str]]:
        """What methods of each class assign that are neither generated nor of an input."""
        return {
            owner.name: {
                name
                for one in owner.body
                if not (isinstance(one, ast.FunctionDef) and one.name.startswith((_PREFIX, "__i")))
                for name in _assigned(ast.walk(one))
            }
            for owner in dict.fromkeys(self._owners.values())
        }

    @cached_property
    def _unbound(self) -> set[tuple[int, str]]:
        """Names that methods read and that nothing binds, each with the line of the method.

        Empty where nobody can tell, as after ``from x import *``.
        """
        for node in ast.walk(self._tree):
            stars = isinstance(node, ast.ImportFrom) and any(
                name.name == "*" for name in node.names
            )
            if stars or (isinstance(node, ast.Name) and node.id in {"exec", "globals"}):
                return set()
        try:
            module = symtable.symtable(self._text, "<region>", "exec")
        except (SyntaxError, RecursionError, MemoryError, ValueError):
            return set()
        bound = _KNOWN | set(_bound(self._tree))
        return {
            (method.get_lineno(), symbol.get_name())
            for owner in module.get_children()
            for method in owner.get_children()
            for table in _tables(method)
            for symbol in table.get_symbols()
            if symbol.is_referenced() and symbol.is_global() and symbol.get_name() not in bound
        }


def _no_fields(
    method: ast.FunctionDef, nodes: Sequence[ast.AST], messages: Messages
) -> Iterator[str]:
    """Yield what is read of a message as if it were a field, and is none."""
    bound = {node.id for node in nodes if isinstance(node, ast.Name) and _is_stored(node)}
    types = {
        argument.arg: messages.types[argument.arg]
        for argument in method.args.args
        if argument.arg in messages.types and argument.arg not in bound
    }
    called = {id(node.func) for node in nodes if isinstance(node, ast.Call)}
    for node in nodes:
        if not isinstance(node, ast.Attribute) or node.attr.startswith("_"):
            continue
        message = _type_of(node.value, types, messages.fields) or ""
        fields = messages.fields.get(message)
        if fields is None or _field_type(fields, node.attr) is not None:
            continue
        if not node.attr.isupper() and id(node) not in called:  # constant, method
            hint = did_you_mean(node.attr, fields) or f"its fields: {shortened_list(fields)}"
            yield f"'{ast.unparse(node)}': {message} has no such field; {hint}"


def _type_of(
    node: ast.expr, types: Mapping[str, str], fields: Mapping[str, Mapping[str, str]]
) -> str | None:
    """Return the type of a message, of a field of one, or of an element; ``None``: not known."""
    steps: list[ast.Attribute | ast.Subscript] = []
    while isinstance(node, ast.Attribute | ast.Subscript):
        steps.append(node)
        node = node.value
    found = types.get(node.id) if isinstance(node, ast.Name) else None
    for step in reversed(steps):
        if isinstance(step, ast.Attribute):
            found = _field_type(fields.get(found or "", {}), step.attr)
        else:
            found = None if isinstance(step.slice, ast.Slice) else element(found or "")
    return found


def _field_type(fields: Mapping[str, str], name: str) -> str | None:
    """Return the type of a field, in any case of letters: of CameraInfo, ROS 2 has `k`."""
    return next((of for field, of in fields.items() if field.lower() == name.lower()), None)


def _overwritten(method: ast.FunctionDef, lines: range, own: str) -> Iterator[str]:
    """Yield that what was written above the line of the template has no effect.

    Not where the function may end before that line, or something may read the value until then.
    """
    *above, last = [one for one in method.body if one.lineno in lines] or [ast.Pass()]
    if not isinstance(last, ast.Assign) or ast.unparse(last) != f"self.{own} = None":
        return
    sets = [number for number, one in enumerate(above) if own in _assigned(ast.walk(one))]
    between = [node for one in above[sets[-1] + 1 :] for node in ast.walk(one)] if sets else []
    is_read = any(
        isinstance(node, ast.Attribute) and node.attr == own and isinstance(node.ctx, ast.Load)
        for statement in above
        for node in ast.walk(statement)
    )
    ends = any(isinstance(node, ast.Return) for statement in above for node in ast.walk(statement))
    if sets and not is_read and not ends and not any(map(is_self, between)):
        yield (
            f"'self.{own}' is assigned, then overwritten by the placeholder in line {last.lineno}: "
            "delete that line"
        )


def _is_stored(name: ast.Name) -> bool:
    return not isinstance(name.ctx, ast.Load)


def _nodes(method: ast.FunctionDef, lines: range) -> list[ast.AST]:
    return [node for node in ast.walk(method) if getattr(node, "lineno", 0) in lines]


def _tables(table: symtable.SymbolTable) -> Iterator[symtable.SymbolTable]:
    left = [table]
    while left:
        one = left.pop()
        yield one
        left += one.get_children()


def _bound(tree: ast.Module) -> Iterator[str]:
    """Yield the names that statements of the module bind; a symbol table takes long for them."""
    left: list[ast.AST] = [tree]
    while left:
        node = left.pop()
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield node.name
            yield from (
                name
                for one in ast.walk(node)
                for name in getattr(one, "names", ())
                if isinstance(one, ast.Global)
            )
            continue
        if isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Load):
            yield node.id
        elif isinstance(node, ast.alias):
            yield (node.asname or node.name).partition(".")[0]
        elif isinstance(node, ast.ExceptHandler | ast.MatchAs | ast.MatchStar) and node.name:
            yield node.name
        elif isinstance(node, ast.MatchMapping) and node.rest:
            yield node.rest
        left += ast.iter_child_nodes(node)


def _is_method(node: ast.AST) -> TypeGuard[ast.Attribute]:
    return isinstance(node, ast.Attribute) and is_self(node.value)


def _assigned(nodes: Iterable[ast.AST]) -> list[str]:
    return [
        node.attr
        for node in nodes
        if isinstance(node, ast.Attribute)
        and isinstance(node.ctx, ast.Store)
        and is_self(node.value)
    ]


def is_self(node: ast.AST) -> bool:
    """Return whether a node is ``self``."""
    return isinstance(node, ast.Name) and node.id == "self"


def _is_decimal_comma(node: ast.expr) -> bool:
    """Tell ``x - 0,5 < y``: a tuple without parentheses, with integers beside its comma."""
    if not isinstance(node, ast.Tuple) or len(node.elts) != 2:
        return False
    left, right = node.elts
    bare = (node.lineno, node.col_offset) == (left.lineno, left.col_offset)
    while isinstance(left, ast.BinOp | ast.UnaryOp | ast.Compare | ast.BoolOp):
        left = _last(left)
    while isinstance(right, ast.BinOp | ast.Compare):
        right = right.left
    return bare and _is_integer(left) and _is_integer(right)


def _last(node: ast.BinOp | ast.UnaryOp | ast.Compare | ast.BoolOp) -> ast.expr:
    if isinstance(node, ast.BinOp):
        return node.right
    if isinstance(node, ast.UnaryOp):
        return node.operand
    return node.comparators[-1] if isinstance(node, ast.Compare) else node.values[-1]


def _is_integer(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and type(node.value) is int

"""Types of undeclared variables, from how they are used."""

from __future__ import annotations

from eddi_scaffold.conditions.scope import BOOL, NUMBER, Scope, Type, Variable
from eddi_scaffold.conditions.signatures import arguments_of, result_of
from eddi_scaffold.conditions.syntax import File, SyntaxNode


def infer_types(file: File, scope: Scope) -> None:
    """Give a type to each undeclared variable whose use determines one; the others stay without.

    The operand of AND is a boolean, that of + or < a number, one side of == is of the type of the
    other. The first use decides; whether the others agree is checked later.
    """
    if scope.closed:
        return
    _Inference(file, scope).run()


class _Inference:
    """Sets of variables that have one type (union-find)."""

    def __init__(self, file: File, scope: Scope) -> None:
        self._file = file
        self._scope = scope
        self._parent: dict[str, str] = {}
        self._type: dict[str, Type] = {}

    def run(self) -> None:
        for node in self._file.nodes:
            if node.op == "name" and not self._scope.knows(node.text):
                self._parent.setdefault(node.text, node.text)
        for node in self._file.nodes:
            if node.op in ("eq", "ne"):
                self._same(*(self._file.nodes[k] for k in node.args))
                continue
            wanted = arguments_of(node.op)
            if node.op in ("known", "age"):
                continue
            for k, type_ in zip(node.args, wanted, strict=False):
                self._set(self._file.nodes[k], type_)
        for event in self._file.events:
            if not event.anonymous:
                self._set(self._file.nodes[event.root], BOOL)
        for name in self._parent:
            found = self._type.get(self._root(name))
            self._scope.variables[name] = Variable(name, found, declared=False)

    def _same(self, left: SyntaxNode, right: SyntaxNode) -> None:
        left_open, right_open = self._is_open(left), self._is_open(right)
        if left_open and right_open:
            one, other = self._root(left.text), self._root(right.text)
            found = self._type.get(one) or self._type.get(other)
            self._parent[other] = one
            if found is not None:
                self._type[one] = found
        elif left_open or right_open:
            name, known = (left, right) if left_open else (right, left)
            found = self._known(known)
            if found is not None:
                self._set(name, found)

    def _set(self, node: SyntaxNode, type_: Type) -> None:
        if self._is_open(node):
            self._type.setdefault(self._root(node.text), type_)

    def _is_open(self, node: SyntaxNode) -> bool:
        return node.op == "name" and node.text in self._parent

    def _root(self, name: str) -> str:
        while self._parent[name] != name:
            self._parent[name] = self._parent[self._parent[name]]
            name = self._parent[name]
        return name

    def _known(self, node: SyntaxNode) -> Type | None:
        """Return the type of a node that is not an open name."""
        if node.op == "name":
            return self._scope.type_of(node.text)
        if node.op in ("number", "truth"):
            return NUMBER if node.op == "number" else BOOL
        return result_of(node.op)

"""The text of a ``compiled.py``: a closed list of forms, each statement taken by one of them.

Nothing of it is executed. What no form takes is not proved; what a form takes is compared with the
model. A form is Python in which single capital letters stand for any expression or attribute.
"""

from __future__ import annotations

import ast
import builtins
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

if TYPE_CHECKING:
    from eddi_scaffold.program.monitor_text import Declaration

Key = TypeVar("Key")
Holes = dict[str, Any]  # what the letters of a form stand for: expressions, names of attributes
EXPRESSIONS = ("expression", "hold", "lists", "stacks", "window", "windows")
"""Modules of the runtime below ``eddi_runtime.expressions``; all others are below the kind's."""
_CONSTANTS = {"INF": 'float("inf")', "NAN": 'float("nan")'}
_PLACES = {"ctx", "kind", "type_comment", "type_params"}  # fields that decide nothing


class Finding(NamedTuple):
    """Something that keeps a text from being proved."""

    line: int  # in `compiled.py`
    text: str  # a counterexample, or what is not understood
    differs: bool  # it is another monitor, not only one that is not proved


class UnprovedError(Exception):
    """A statement has no form."""

    def __init__(self, node: ast.AST | None, why: str = "it has no known form") -> None:
        super().__init__(why)
        self.line = getattr(node, "lineno", 1)


class Call(NamedTuple):
    """A call as data; without arguments, a name."""

    name: str
    args: tuple[Any, ...] | None = None
    keywords: Mapping[str, Any] = {}

    def __repr__(self) -> str:
        rows = [*map(repr, self.args or ())]
        rows += [f"{key}={value!r}" for key, value in sorted(self.keywords.items())]
        return self.name if self.args is None else f"{self.name}({', '.join(rows)})"


def data(node: ast.expr) -> Any:
    """Return an expression as data: constants, tuples, lists, sets, dicts, calls and names."""
    match node:
        case ast.Constant():
            return node.value
        case ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=int() | float() as number)):
            return -number
        case ast.UnaryOp(op=ast.USub(), operand=ast.Name(id="INF")):
            return -float("inf")
        case ast.Tuple():
            return tuple(map(data, node.elts))
        case ast.List():
            return [*map(data, node.elts)]
        case ast.Set():
            return {*map(data, node.elts)}
        case ast.Dict() if None not in node.keys:
            return {data(k): data(v) for k, v in zip(node.keys, node.values, strict=True) if k}
        case ast.Name() | ast.Attribute():
            name = ast.unparse(node)
            return float(name) if name in _CONSTANTS else Call(name)
        case ast.Call(func=ast.Name() | ast.Attribute()):
            named = {keyword.arg or "**": data(keyword.value) for keyword in node.keywords}
            if "**" not in named and len(named) == len(node.keywords):
                return Call(ast.unparse(node.func), tuple(map(data, node.args)), named)
    raise UnprovedError(node)


@cache
def _parsed(form: str) -> Sequence[ast.stmt]:
    return ast.parse(form).body


def _is_hole(name: object) -> bool:
    return isinstance(name, str) and len(name) == 1 and name.isupper()


def _unify(form: Any, node: Any, holes: Holes) -> bool:
    if isinstance(form, ast.Expr) and _is_hole(getattr(form.value, "id", "")):
        return holes.setdefault(form.value.id, node) is node  # type: ignore[attr-defined]
    if isinstance(form, ast.Name) and _is_hole(form.id):
        before = holes.setdefault(form.id, node)
        return before is node or ast.unparse(before) == ast.unparse(node)
    if isinstance(form, ast.Attribute) and _is_hole(form.attr):
        is_same = isinstance(node, ast.Attribute) and _unify(form.value, node.value, holes)
        return is_same and holes.setdefault(form.attr, node.attr) == node.attr
    if type(form) is not type(node):
        return False
    if isinstance(form, ast.AST):
        names = [name for name in form._fields if name not in _PLACES]
        return all(_unify(getattr(form, name), getattr(node, name), holes) for name in names)
    if isinstance(form, list):
        return len(form) == len(node) and all(
            _unify(of, other, holes) for of, other in zip(form, node, strict=True)
        )
    return bool(form == node)


def matched(form: str, nodes: Sequence[ast.AST]) -> Holes | None:
    """Return what the letters of a form stand for in statements, or in an expression."""
    wanted: Sequence[ast.AST] = _parsed(form)
    if nodes and isinstance(nodes[0], ast.expr):
        wanted = [of.value for of in _parsed(form) if isinstance(of, ast.Expr)]
    holes: Holes = {}
    return holes if _unify([*wanted], [*nodes], holes) else None


class Lines:
    """The statements of a body, which are taken from the front."""

    def __init__(self, function: ast.FunctionDef) -> None:
        self.rest, self._end = deque(function.body), function

    def which(self, forms: Mapping[Key, str]) -> tuple[Key, Holes]:
        """Take the next statements, and return which of some forms they have."""
        for key, form in forms.items():
            size = len(_parsed(form))
            holes = matched(form, [self.rest[k] for k in range(min(size, len(self.rest)))])
            if holes is not None:
                for _ in range(size):
                    self.rest.popleft()
                return key, holes
        raise UnprovedError(self.rest[0] if self.rest else self._end)

    def take(self, *forms: str) -> Holes:
        """Take the next statements, which have one of these forms."""
        return self.which(dict(enumerate(forms)))[1]

    def end(self) -> None:
        """Refuse further statements."""
        if self.rest:
            raise UnprovedError(self.rest[0])


@dataclass
class Class:
    """A class: what no form has taken yet."""

    node: ast.ClassDef
    attributes: dict[str, ast.expr] = field(default_factory=dict)
    methods: dict[str, ast.FunctionDef] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for of in self.node.body:
            match of:
                case ast.Assign(targets=[ast.Name(id=name)]):
                    to: dict[str, Any] = self.attributes
                    value: Any = of.value
                case ast.FunctionDef(name=name, decorator_list=[], returns=None):
                    to, value = self.methods, of
                case _:
                    raise UnprovedError(of)
            if name in self.attributes or name in self.methods:
                raise UnprovedError(of)
            to[name] = value

    def method(self, name: str, arguments: str) -> Lines | None:
        """Take a method with these arguments; ``None`` where there is none."""
        function = self.methods.pop(name, None)
        if function is not None and ast.unparse(function.args) != arguments:
            raise UnprovedError(function)
        return None if function is None else Lines(function)


class Emitted:
    """A ``compiled.py``; ``findings`` are what keeps it from being proved.

    Args:
        text: of the file.
        kind: of the monitor.
        declared: id, digest and bound inputs of the model that was read.
        formats: part of the runtime -> the format that it has.
    """

    def __init__(
        self, text: str, kind: str, declared: Declaration, formats: Mapping[str, int]
    ) -> None:
        self.kind, self.declared, self.formats = kind, declared, formats
        self.findings: list[Finding] = []
        self.classes: dict[str, Class] = {}
        self.functions: dict[str, ast.FunctionDef] = {}
        self.values: dict[str, ast.expr] = {}  # of names of the module
        self.expressions: dict[str, str] = {}  # input -> class that computes it
        self._imports: set[str] = set()
        try:
            self._tree = ast.parse(text)
        except (SyntaxError, ValueError, RecursionError) as error:
            line = getattr(error, "lineno", None) or 1
            self._tree = ast.Module([], [])
            self.findings.append(Finding(line, "it is no Python", differs=False))

    def read(self) -> None:
        """Take the head, and put the rest of the module into the tables."""
        docstring = ast.get_docstring(self._tree)
        if docstring is None:
            raise UnprovedError(None)
        head, *body = self._tree.body
        needed = None
        for node in body:
            match node:
                case ast.Import(names=[ast.alias(name="eddi_runtime", asname=None)]):
                    self._name(node, "eddi_runtime")
                case ast.ImportFrom(module=str() as module, names=names, level=0):
                    for alias in names:
                        part = "expressions" if alias.name in EXPRESSIONS else self.kind
                        is_part = alias.name in ("InputSpec", "expressions", self.kind)
                        wanted = "eddi_runtime" if is_part else f"eddi_runtime.{part}"
                        if alias.asname is not None or module != wanted:
                            raise UnprovedError(node)
                        self._name(node, alias.name)
                case ast.Expr() if needed is None:
                    needed = (matched("eddi_runtime.needs(__file__, F)", [node]) or {}).get("F")
                    if not isinstance(needed, ast.Dict):
                        raise UnprovedError(node)
                case ast.Assign(targets=[ast.Name(id=name)]):
                    if name in _CONSTANTS and ast.unparse(node) != f"{name} = " + _CONSTANTS[
                        name
                    ].replace('"', "'"):
                        self.differs(node, f"{name} is not {_CONSTANTS[name]}")
                    self._name(node, name)
                    if name not in _CONSTANTS:
                        self.values[name] = node.value
                case ast.ClassDef(keywords=[], decorator_list=[]):
                    self._name(node, node.name)
                    self.classes[node.name] = Class(node)
                case ast.FunctionDef(decorator_list=[], returns=None):
                    self._name(node, node.name)
                    self.functions[node.name] = node
                case _:
                    raise UnprovedError(node)
        if needed is None:
            raise UnprovedError(head)
        parts = [name for name in ("eddi_runtime", self.kind) if name in self._imports]
        parts += ["expressions"] if {"expressions", *EXPRESSIONS} & self._imports else []
        expected = ", ".join(f"{name}: {self.formats[name]}" for name in parts)
        if ast.unparse(needed) != f"{{{expected}}}":
            self.differs(needed, f"it needs {ast.unparse(needed)}, the runtime has {{{expected}}}")
        self._check_names()

    def _name(self, node: ast.AST, name: str) -> None:
        if name in self._imports:
            raise UnprovedError(node, f"{name} has two meanings")
        self._imports.add(name)

    def _check_names(self) -> None:
        """Refuse names that are defined nowhere, and that hide what a form means by them."""
        names = [node for node in ast.walk(self._tree) if isinstance(node, ast.Name)]
        functions = [node for node in ast.walk(self._tree) if isinstance(node, ast.FunctionDef)]
        known = {*self._imports, *vars(builtins), "__file__", "__spec__"}
        known |= {node.id for node in names if isinstance(node.ctx, ast.Store)}
        for function in functions:
            inside = [*ast.walk(function)]
            own = {node.arg for node in inside if isinstance(node, ast.arg)}
            known |= own
            own |= {
                n.id for n in inside if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)
            }
            called = {*_CONSTANTS} | {
                ast.unparse(node.func).partition(".")[0]
                for node in inside
                if isinstance(node, ast.Call)
            }
            if own & called & {*self._imports, *vars(builtins)}:
                raise UnprovedError(function, "a variable hides what it calls")
        for node in names:
            if node.id not in known:
                raise UnprovedError(node, f"{node.id} is not defined")

    def differs(self, node: ast.AST | None, text: str) -> None:
        """Note a difference from the model."""
        self.findings.append(Finding(getattr(node, "lineno", 1), text, differs=True))

    def same(self, what: str, node: ast.expr | None, expected: object) -> None:
        """Compare data of the text with those of the model, element by element; types count."""
        if node is None:
            self.differs(None, f"{what} is missing, the model says {expected!r}")
            return
        got = data(node)
        if repr(got) == repr(expected):
            return
        rows = node.elts if isinstance(node, ast.Tuple) and isinstance(expected, tuple) else []
        if rows and isinstance(expected, tuple) and len(rows) == len(expected):
            for k, (element, of) in enumerate(zip(rows, expected, strict=True), 1):
                self.same(f"{what} {k}", element, of)
            return
        self.differs(node, f"{what} is {got!r}, the model says {expected!r}")

    def attribute(self, of: Class, name: str, expected: object) -> None:
        """Compare an attribute of a class; ``None``: there is to be none."""
        node = of.attributes.pop(name, None)
        if expected is not None or node is not None:
            self.same(name, node or of.node.bases[0] if expected is None else node, expected)

    def monitor(self, base: str) -> Class:
        """Take the class ``Monitor``: its base, whose monitor it is, and its inputs."""
        monitor = self.classes.pop("Monitor", None)
        if monitor is None:
            raise UnprovedError(None, "there is no class Monitor")
        self.same("the base of Monitor", ast.Tuple(monitor.node.bases), (Call(base),))
        self.attribute(monitor, "model_id", self.declared.model_id)
        self.attribute(monitor, "digest", self.declared.digest)
        specs = monitor.attributes.get("inputs")
        for k, spec in enumerate(specs.elts if isinstance(specs, ast.Tuple) else ()):
            for keyword in spec.keywords if isinstance(spec, ast.Call) else ():
                of = self.declared.inputs[k].id if k < len(self.declared.inputs) else ""
                if keyword.arg == "expression" and isinstance(keyword.value, ast.Name):
                    above = self.classes.get(keyword.value.id)
                    if above is None or above.node.lineno > monitor.node.lineno:
                        raise UnprovedError(keyword.value)
                    self.expressions[of] = keyword.value.id
        self.attribute(monitor, "inputs", tuple(self._specs()))
        topics = [row for input_ in self.declared.inputs for row in input_.topics.items()]
        self.attribute(monitor, "topics", dict(topics) or None)
        return monitor

    def _specs(self) -> Iterator[Call]:
        for input_ in self.declared.inputs:
            named = {
                "requires": input_.requires or None,
                "max_age": input_.max_age,
                "factor": input_.factor,
                "default": input_.default,
                "every_message": input_.every_message or None,
                "accepts": input_.accepts or None,
                "claims": input_.claims or None,
            }
            keywords: dict[str, Any] = {k: v for k, v in named.items() if v is not None}
            if input_.expression is not None:
                keywords["expression"] = Call(self.expressions.get(input_.id, "a class"))
            yield Call("InputSpec", (input_.id, input_.attribute), keywords)

    def end(self, *classes: Class) -> None:
        """Refuse what no form has taken, of classes that were taken and of the module."""
        for of in classes:
            for node in (*of.attributes.values(), *of.methods.values()):
                raise UnprovedError(node)
        left: Iterable[ast.AST] = (
            *(of.node for of in self.classes.values()),
            *self.functions.values(),
            *self.values.values(),
        )
        for node in left:
            raise UnprovedError(node)


def read_inputs(
    lines: Lines, attributes: Sequence[tuple[str, tuple[int, int] | None]], kept: str
) -> list[str]:
    """Take the lines that read the inputs in order, each perhaps in another unit; return names.

    ``kept`` is the form of the line that keeps what was read.
    """
    if not attributes:
        return []
    form = "try:\n    raw = V\nexcept Exception:\n    raw = self.read(source)"
    values = lines.take(form)["V"]
    elements = values.elts if isinstance(values, ast.Tuple) else []
    for element, (name, factor) in zip(elements, attributes, strict=False):
        read = [Call(f"source.{name}"), Call("getattr", (Call("source"), name))]
        wanted = {repr(of) for of in read}
        if factor is not None:
            wanted = {repr(Call("expressions.scaled", (of, *factor))) for of in read}
        if repr(data(element)) not in wanted:
            raise UnprovedError(element, f"it is not the input {name}")
    if len(elements) != len(attributes):
        raise UnprovedError(values, "other inputs are read")
    lines.take(kept)
    return unpacked(lines, "raw", len(attributes))


def unpacked(lines: Lines, value: str, number: int) -> list[str]:
    """Take the line that takes a tuple apart; return the names, of which `_` is for nothing."""
    names = lines.take(f"V = {value}")["V"]
    found = [of.id for of in getattr(names, "elts", ()) if isinstance(of, ast.Name)]
    used = [name for name in found if name != "_"]
    if not isinstance(names, ast.Tuple) or len(found) != len(names.elts) or len(found) != number:
        raise UnprovedError(names)
    if len({*used, "self", "source", "raw", "t"}) != len(used) + 4:
        raise UnprovedError(names, "a name has two meanings")
    return found

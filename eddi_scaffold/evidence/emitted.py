"""The text of a ``compiled.py``: a closed list of forms, each statement taken by one of them.

Nothing of it is executed. What no form takes is not proved; what a form takes is compared with the
model: as text, without comments and layout, or as data.
"""

from __future__ import annotations

import ast
import builtins
import keyword
import re
from collections.abc import Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from eddi_scaffold.program.monitor_text import Declaration

_LONGEST = 40  # name that stands in a text as it is
_MODULES = {
    **dict.fromkeys(("InputSpec", "expressions"), "eddi_runtime"),
    **dict.fromkeys(
        ("expression", "hold", "lists", "stacks", "window", "windows"), "eddi_runtime.expressions"
    ),
}
"""What is imported -> where it is; all other names are in the kind's module."""
_FIXED = {
    "import eddi_runtime": "eddi_runtime",
    "INF = float('inf')": "INF",
    "NAN = float('nan')": "NAN",
}
_IMPORT = r"from ([\w.]+) import (\w+(?:, \w+)*)"
_COOKIE, _LINE = re.compile(r"[ \t\f]*#.*?coding[:=]"), r"\r\n?|\n"
_BUILTINS = {*vars(builtins), "__file__", "__spec__"}


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


def called(name: str, *args: Any, **keywords: Any) -> Call:
    """Return a call, without keywords that are ``None``."""
    return Call(name, args, {key: of for key, of in keywords.items() if of is not None})


def data(node: ast.expr) -> Any:
    """Return an expression as data: constants, tuples, lists, dicts, calls and names."""
    match node:
        case ast.Constant():
            return node.value
        case ast.UnaryOp(op=ast.USub()):
            return -data(node.operand)
        case ast.Tuple():
            return tuple(map(data, node.elts))
        case ast.List():
            return [*map(data, node.elts)]
        case ast.Dict() if None not in node.keys:  # such as of `**`
            pairs = zip(node.keys, node.values, strict=True)
            made = {data(key): data(value) for key, value in pairs if key is not None}
            if len(made) < len(node.keys):
                raise UnprovedError(node, "a key has two values")
            return made
        case ast.Name(id="INF" | "NAN"):
            return float(node.id)
        case ast.Name() | ast.Attribute() | ast.Subscript(value=ast.Attribute()):
            return Call(ast.unparse(node))
        case ast.Call():
            named = {keyword.arg or "**": data(keyword.value) for keyword in node.keywords}
            return Call(ast.unparse(node.func), tuple(map(data, node.args)), named)
    raise UnprovedError(node)


class Lines:
    """The statements of a body, which are taken from the front."""

    def __init__(self, function: ast.FunctionDef) -> None:
        self.rest, self._end = [*function.body], function

    def find(self, pattern: str) -> dict[str, str] | None:
        """Take the next statement if its text has a pattern; return the groups."""
        of = re.fullmatch(pattern, ast.unparse(self.rest[0])) if self.rest else None
        if of is None:
            return None
        del self.rest[0]
        return of.groupdict()

    def returned(self) -> ast.expr:
        """Take the last statement; return what it returns."""
        match self.rest:
            case [ast.Return(value=ast.expr() as value)]:
                self.rest = []
                return value
        raise UnprovedError(self.rest[0] if self.rest else self._end)

    def expect(self, *texts: str) -> None:
        """Take the next statements, which are one of these texts."""
        for text in texts[:-1]:
            wanted = [*map(ast.unparse, ast.parse(text).body)]
            if [*map(ast.unparse, self.rest[: len(wanted)])] == wanted:
                del self.rest[: len(wanted)]
                return
        for of in ast.parse(texts[-1]).body:
            got = self.rest.pop(0) if self.rest else self._end
            if ast.unparse(got) != ast.unparse(of):
                raise UnprovedError(got, f"it is not as the model says: {ast.unparse(of)!r}")

    def end(self) -> None:
        """Refuse further statements."""
        if self.rest:
            raise UnprovedError(self.rest[0])


class Class:
    """A class: what no form has taken yet."""

    def __init__(self, node: ast.ClassDef) -> None:
        self.node, self.base = node, ", ".join(map(ast.unparse, node.bases))
        self.attributes: dict[str, ast.expr] = {}
        self.methods: dict[str, ast.FunctionDef] = {}
        for of in node.body:
            match of:
                case ast.Assign(targets=[ast.Name(id=name)]) if name not in self.attributes:
                    self.attributes[name] = of.value
                case ast.FunctionDef(name=name, decorator_list=[], returns=None) if (
                    name not in self.methods
                ):
                    self.methods[name] = of
                case _:
                    raise UnprovedError(of)

    def method(self, name: str, arguments: str) -> Lines:
        """Take a method with these arguments."""
        function = self.methods.pop(name, None)
        if function is None or ast.unparse(function.args) != arguments:
            raise UnprovedError(function or self.node, f"there is no {name}({arguments})")
        return Lines(function)

    def body(self, name: str, arguments: str, expected: str) -> None:
        """Take a method that has these arguments and these lines."""
        lines = self.method(name, arguments)
        lines.expect(expected)
        lines.end()


def _check_names(tree: ast.Module, defined: AbstractSet[str]) -> None:
    """Refuse names that are not defined, and variables that hide what is called.

    Whether they are defined above their use is seen when the module is loaded.
    """
    bodies = [tree.body, *(of.body for of in tree.body if isinstance(of, ast.ClassDef))]
    functions = [of for body in bodies for of in body if isinstance(of, ast.FunctionDef)]
    for part in [tree, *functions]:
        nodes = [*ast.walk(part)]
        names = [of for of in nodes if isinstance(of, ast.Name)]
        own = {of.id for of in names if isinstance(of.ctx, ast.Store)}
        own |= {of.arg for of in nodes if isinstance(of, ast.arg)}
        own |= {of.name for of in nodes[1:] if isinstance(of, ast.FunctionDef)}
        if {of.id for of in names} - own - defined:
            raise UnprovedError(part, "it uses a name that is not defined")
        calls = (ast.unparse(of.func) for of in nodes if isinstance(of, ast.Call))
        called = {"Exception", "INF", "NAN", *(call.partition(".")[0] for call in calls)}
        if part is not tree and own & called & defined:
            raise UnprovedError(part, "a variable hides what is called")


class Emitted:
    """A ``compiled.py``; ``findings`` are what keeps it from being proved.

    ``declared``: of the model that was read; ``formats``: part of the runtime -> the one it has.
    An UnprovedError: a statement of the module has no form.
    """

    def __init__(
        self, text: str, kind: str, declared: Declaration, formats: Mapping[str, int]
    ) -> None:
        self.kind, self.declared = kind, declared
        self.findings: list[Finding] = []
        self.classes: dict[str, Class] = {}
        self.functions: dict[str, ast.FunctionDef] = {}
        self.values: dict[str, ast.expr] = {}  # of names of the module
        self.expressions: dict[str, str] = {}  # input -> class that computes it
        try:
            tree = ast.parse(text)
        except (SyntaxError, ValueError, RecursionError) as error:
            raise UnprovedError(None, f"it is no Python: {error}") from None
        names, modules = set[str](), {**_MODULES, kind: "eddi_runtime"}
        for node in tree.body[1 if ast.get_docstring(tree) is not None else 0 :]:
            is_large = isinstance(node, ast.ClassDef | ast.FunctionDef)
            taken = "" if is_large else ast.unparse(node)
            new = [_FIXED.get(taken, "")]
            match node:
                case _ if taken in _FIXED:
                    pass
                case ast.ImportFrom() if of := re.fullmatch(_IMPORT, taken):
                    new = of[2].split(", ")
                    if any(of[1] != modules.get(name, f"eddi_runtime.{kind}") for name in new):
                        raise UnprovedError(node)
                case ast.Expr() if taken.startswith("eddi_runtime.needs("):
                    more = ["expressions"] if names & {*_MODULES} - {"InputSpec"} else []
                    parts = ("eddi_runtime", kind, *more)
                    needed = ", ".join(f"{of}: {formats[of]}" for of in parts)
                    if taken != f"eddi_runtime.needs(__file__, {{{needed}}})":
                        self.differs(node, f"the runtime has the formats {needed}")
                    new = ["needs"]
                case ast.Assign(targets=[ast.Name(id=name)]) if name not in ("INF", "NAN"):
                    self.values[name], new = node.value, [name]
                case ast.ClassDef(name=name, keywords=[], decorator_list=[]):
                    self.classes[name], new = Class(node), [name]
                case ast.FunctionDef(name=name, decorator_list=[], returns=None):
                    self.functions[name], new = node, [name]
                case _:
                    raise UnprovedError(node)
            if names & {*new}:
                raise UnprovedError(node, "a name has two meanings")
            names |= {*new}
        if "needs" not in names:
            raise UnprovedError(None, "it does not say which runtime it needs")
        if names & vars(builtins).keys() or any(
            map(_COOKIE.match, re.split(_LINE, text, maxsplit=2)[:2])
        ):
            raise UnprovedError(None, "a name, or the encoding, means something else in Python")
        _check_names(tree, names | _BUILTINS)

    def differs(self, node: ast.AST | None, text: str) -> None:
        """Note a difference from the model."""
        self.findings.append(Finding(getattr(node, "lineno", 1), text, differs=True))

    def same(self, what: str, node: ast.expr | None, expected: object) -> None:
        """Compare data of the text with those of the model, element by element; types count."""
        got = Call("missing") if node is None else data(node)
        rows = node.elts if isinstance(node, ast.Tuple) else []
        if repr(got) == repr(expected):
            return
        if type(expected) is tuple and 0 < len(rows) == len(expected):
            for k, (element, of) in enumerate(zip(rows, expected, strict=True), 1):
                self.same(f"{what} {k}", element, of)
        else:
            self.differs(node, f"{what} is {got!r}, the model says {expected!r}")

    def attribute(self, of: Class, name: str, expected: object) -> None:
        """Compare an attribute of a class; ``None``: there is to be none."""
        node = of.attributes.pop(name, None)
        if expected is not None:
            self.same(name, node, expected)
        elif node is not None:
            raise UnprovedError(node)

    def monitor(self, base: str) -> Class:
        """Take the class ``Monitor``: its base, whose monitor it is, and its inputs."""
        monitor = self.classes.pop("Monitor", None)
        if monitor is None or monitor.base != base:
            at = None if monitor is None else monitor.node
            raise UnprovedError(at, f"there is no Monitor of {base}")
        self.attribute(monitor, "model_id", self.declared.model_id)
        self.attribute(monitor, "digest", self.declared.digest)
        names = (name for name, of in self.classes.items() if of.base == "expression.Expression")
        computed = (input_.id for input_ in self.declared.inputs if input_.expression is not None)
        self.expressions = dict(zip(computed, names, strict=False))
        self.attribute(monitor, "inputs", tuple(self._specs()))
        topics = [row for input_ in self.declared.inputs for row in input_.topics.items()]
        self.attribute(monitor, "topics", dict(topics) or None)
        return monitor

    def _specs(self) -> Iterator[Call]:
        for input_ in self.declared.inputs:
            computed = Call(self.expressions.get(input_.id, "a class"))
            yield called(
                "InputSpec",
                input_.id,
                input_.attribute,
                requires=input_.requires or None,
                max_age=input_.max_age,
                factor=input_.factor,
                default=input_.default,
                every_message=input_.every_message or None,
                accepts=input_.accepts or None,
                claims=input_.claims or None,
                expression=None if input_.expression is None else computed,
            )

    def end(self, of: Class | None = None) -> None:
        """Refuse what no form has taken, of a class that was taken or of the module."""
        classes = [rest.node for rest in self.classes.values()]
        left = [*classes, *self.functions.values(), *self.values.values()]
        for node in left if of is None else [*of.attributes.values(), *of.methods.values()]:
            raise UnprovedError(node)


def reading(attribute: str) -> str:
    """Return the text that reads an attribute of the input."""
    is_name = attribute.isascii() and attribute.isidentifier() and len(attribute) <= _LONGEST
    is_name = is_name and not keyword.iskeyword(attribute)
    return f"source.{attribute}" if is_name else f"getattr(source, {attribute!r})"


def unpacked(lines: Lines, value: str, number: int, lost: str = "") -> list[str]:
    """Take the line that takes a tuple apart; return the names, of which ``lost`` may repeat."""
    names = getattr(lines.rest[0], "targets", lines.rest)[0]
    found = [of.id for of in getattr(names, "elts", ()) if isinstance(of, ast.Name)]
    used = [*(name for name in found if name != lost), "self", "source", "raw", "t"]
    if len(found) != number or len({*used}) < len(used):
        raise UnprovedError(names, "a name has two meanings")
    lines.expect(f"({', '.join(found)},) = {value}")
    return found


def read_inputs(
    lines: Lines, attributes: Sequence[tuple[str, tuple[int, int] | None]], kept: str
) -> list[str]:
    """Take the lines that read the inputs in order, each perhaps in another unit; return names.

    ``kept`` is the line that keeps what was read.
    """
    if not attributes:
        return []
    reads = [
        reading(name)
        if factor is None
        else f"expressions.scaled({reading(name)}, {factor[0]}, {factor[1]})"
        for name, factor in attributes
    ]
    values = f"({', '.join(reads)},)"
    lines.expect(
        f"try:\n    raw = {values}\nexcept Exception:\n    raw = self.read(source)\n{kept}"
    )
    return unpacked(lines, "raw", len(attributes), lost="_")

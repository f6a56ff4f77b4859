"""Types and units of expressions, and their nodes in the intermediate form."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from eddi_scaffold.common.problems import SimilarNames
from eddi_scaffold.common.units import root
from eddi_scaffold.conditions.alignment import Pair, Value, aligned
from eddi_scaffold.conditions.findings import TextFindings
from eddi_scaffold.conditions.form_builder import GraphBuilder, capacity
from eddi_scaffold.conditions.lists import Elements, elements_of, reduced, unit_of_list
from eddi_scaffold.conditions.scope import BOOL, NUMBER, TEXT, Scope, Type
from eddi_scaffold.conditions.signatures import arguments_of, result_of
from eddi_scaffold.conditions.syntax import OPERATORS, EventDeclaration, File, SyntaxNode, word_of
from eddi_scaffold.conditions.uses import Bounds, bounds, decided
from eddi_scaffold.program.builder import MAX_CAPACITY
from eddi_scaffold.program.instructions import BUFFERED
from eddi_scaffold.program.instructions import WINDOWS as WINDOW_OPS

_ORDER = ("lt", "le", "gt", "ge")
_SAME_UNIT = ("add", "sub", *_ORDER, "eq", "ne", "least", "greatest", "hypot")
_UNIT_OF_BOTH = ("add", "sub", "least", "greatest", "hypot")
_KEEPS_UNIT = ("neg", "abs", "average", "max", "min", "sum", "stddev", "median")
_SECONDS = ("elapsed", "age")
_VAR_ADVICE = "declare it: VAR {0} : NUMBER, or VAR {0} : BOOL"


class Checker:
    """Checks the expressions of one text and adds them to a graph.

    Attributes:
        used: variables in the order of their first use; their numbers in the graph.
    """

    def __init__(
        self,
        file: File,
        scope: Scope,
        findings: TextFindings,
        builder: GraphBuilder,
        locate: Callable[[int], tuple[int, int]],
        *,
        any_rate: bool = False,
    ) -> None:
        self.used: dict[str, int] = {}
        self._elements = elements_of(file)
        self._inside: Elements | None = None
        self._outer = builder
        self._file = file
        self._scope = scope
        self._findings = findings
        self._locate = locate
        self._any_rate = any_rate
        self._events: dict[str, Value | None] = {}
        self._reported: set[str] = set()
        self._near: SimilarNames | None = None

    def event(self, event: EventDeclaration) -> Value | None:
        """Check one expression; return ``None`` when something is wrong with it."""
        values: dict[int, Value | None] = {}
        for k in range(event.first, event.root + 1):
            node = self._file.nodes[k]
            args = [values.pop(arg) for arg in node.args]
            self._inside = self._elements.get(k)
            values[k] = self._value(k, node, args)
        found = values[event.root]
        root = self._file.nodes[event.root]
        if (
            found is not None
            and found.type != BOOL
            and not (event.anonymous and found.type == NUMBER)
        ):
            self._findings.add("E007.event", root.start, type=found.type)
            found = None
        self._events[event.name] = found
        return found

    @property
    def _builder(self) -> GraphBuilder:
        """The graph of the text, or that of the elements of a list."""
        return self._outer if self._inside is None else self._inside.builder

    def _value(self, k: int, node: SyntaxNode, args: list[Value | None]) -> Value | None:
        at = self._locate(node.at)
        if self._is_misplaced(node):
            return None
        if node.op == "number":
            return Value(NUMBER, node.unit, self._builder.number(float(node.text), at))
        if node.op == "truth":
            truth = 2 if node.text.upper() == "TRUE" else 0
            return Value(BOOL, None, self._builder.truth(truth, at))
        if node.op == "name":
            return self._name(node, at)
        if not self._arguments_fit(node, args):
            return None
        known = [arg for arg in args if arg is not None]
        if len(known) != len(args):
            return None
        if node.options is not None:
            return self._reduction(k, node, known, at)
        if node.op in WINDOW_OPS:
            return self._window(node, known[0], at)
        if node.op == "age":
            return self._age(node, known[0], at)
        return self._operation(node, known, at)

    def _is_misplaced(self, node: SyntaxNode) -> bool:
        """Report a list that nothing reduces, and what a reduction cannot hold."""
        if self._inside is None:
            if not node.is_list or node.op != "name":
                return False
            self._findings.add("E007.list", node.start, list=node.text)
            return True
        why = self._inside.objection(node, self._scope)
        if why:
            self._findings.add("E007.objection", node.start, reason=why)
        return bool(why)

    def _reduction(
        self, k: int, node: SyntaxNode, args: list[Value], at: tuple[int, int]
    ) -> Value | None:
        """Return the value of a list; it is a variable that a message gives."""
        elements = self._elements[node.args[0]]
        self._inside = elements
        limited = Value(NUMBER, unit_of_list(elements, self._scope), args[0].node)
        bounds = [
            self._aligned(node, limited, argument, operands=(0, n))
            for n, argument in enumerate(args[1:], start=1)
        ]
        self._inside = None
        if None in bounds:
            return None
        nodes = [args[0].node, *(pair[1].node for pair in bounds if pair is not None)]
        made = reduced(self._file, k, elements, nodes, self._scope, self._findings)
        if made is None:
            return None
        unit = args[0].unit if result_of(node.op) == NUMBER and node.op != "list_count" else None
        self._scope.reductions.setdefault(made.name, replace(made, unit=unit))
        number = self.used.setdefault(made.name, len(self.used))
        return Value(result_of(node.op), unit, self._outer.variable("variable", number, at))

    # names

    def _name(self, node: SyntaxNode, at: tuple[int, int]) -> Value | None:
        name, scope = node.text, self._scope
        if name in scope.literals:
            enum, number = scope.literals[name]
            return Value(Type("enum", enum), None, self._builder.literal(number, at))
        if name in scope.constants:
            bound = scope.constants[name]
            return Value(NUMBER, bound.unit, self._builder.number(bound.value, at))
        if name in scope.variables:
            return self._variable(node, at)
        if scope.knows(name):
            return self._events.get(name)
        # without declarations, only a text with another error has names that are not inferred
        if scope.closed and name not in self._reported and name not in self._file.broken:
            self._reported.add(name)
            self._near = self._near or SimilarNames(scope.names, "there are")
            self._findings.add(
                "E008.unknown_variable", node.start, hint=self._near.hint(name), name=name
            )
        return None

    def _variable(self, node: SyntaxNode, at: tuple[int, int]) -> Value | None:
        variable = self._scope.variables[node.text]
        if variable.type is None:
            if not variable.declared and node.text not in self._reported:
                self._reported.add(node.text)
                hint = variable.advice or _VAR_ADVICE.format(node.text)
                self._findings.add("E008.list_type", node.start, hint=hint, node=node.text)
            return None
        used = self.used if self._inside is None else self._inside.used
        number = used.setdefault(node.text, len(used))
        made = self._builder.variable("variable", number, at)
        return Value(variable.type, variable.unit, made)

    # types

    def _arguments_fit(self, node: SyntaxNode, args: list[Value | None]) -> bool:
        """Report operands of a wrong type."""
        if node.op in ("known", "age"):
            return self._is_no_text(node, args)
        if node.op in ("eq", "ne"):
            return self._same_types(node, args)
        types = arguments_of(node.op)
        wrong = [k for k, arg in enumerate(args) if arg is not None and arg.type != types[k]]
        if not wrong:
            return True
        if node.op in _ORDER and len(wrong) == 2:
            shown = " and ".join(sorted({str(arg.type) for arg in args if arg is not None}))
            self._findings.add("E007.order", node.at, shown=shown, operators=OPERATORS[node.op])
            return False
        for k in wrong:
            self._wrong_type(node, self._file.nodes[node.args[k]], args[k], types[k])
        return False

    def _is_no_text(self, node: SyntaxNode, args: list[Value | None]) -> bool:
        if not any(arg is not None and arg.type == TEXT for arg in args):
            return True
        operand = self._file.nodes[node.args[0]]
        self._findings.add("E007.text", operand.start, operand=operand.text)
        return False

    def _wrong_type(
        self, node: SyntaxNode, operand: SyntaxNode, value: Value | None, wanted: Type
    ) -> None:
        assert value is not None
        shown = word_of(node.op)
        variable = self._scope.variables.get(operand.text) if operand.op == "name" else None
        if variable is not None and not variable.declared:
            hint = _VAR_ADVICE.format(operand.text)
            self._findings.add(
                "E008.elsewhere",
                operand.start,
                hint=hint,
                operand=operand.text,
                type=value.type,
                shown=shown,
                expected=wanted,
            )
        else:
            self._findings.add(
                "E007.operand", operand.start, shown=shown, expected=wanted, type=value.type
            )

    def _same_types(self, node: SyntaxNode, args: list[Value | None]) -> bool:
        left, right = args
        if left is None or right is None:
            return True
        if left.type == right.type:
            return self._is_no_text(node, args)
        self._findings.add("E007.comparison", node.at, left=left.type, right=right.type)
        return False

    # operations

    def _operation(self, node: SyntaxNode, args: list[Value], at: tuple[int, int]) -> Value | None:
        op, unit = node.op, None
        if op == "number_of":
            return self._number_of(node, args[0])
        if op in _SAME_UNIT and args[0].type == NUMBER:
            pair = self._aligned(node, args[0], args[1])
            if pair is None:
                return None
            args = list(pair)
            if op in (*_ORDER, "eq", "ne"):
                self._warn_decided(node, args)
            unit = args[0].unit or args[1].unit if op in _UNIT_OF_BOTH else None
        if op == "hypot":
            return self._hypot(args, unit, at)
        if op in ("hysteresis", "clamp"):
            return self._bounded(node, args, at)
        if op in ("eq", "ne", "known") and args[0].type != NUMBER:
            op = f"{op}_{args[0].type.kind}"
        if op in _KEEPS_UNIT:
            unit = args[0].unit
        elif op in _SECONDS:
            unit = "s"
        elif op == "sqrt":
            unit = root(args[0].unit)
        made = self._builder.operation(op, tuple(arg.node for arg in args), at)
        return Value(result_of(op), unit, made)

    def _warn_decided(self, node: SyntaxNode, args: list[Value]) -> None:
        """Warn of a comparison that the declared range of its variable decides alone."""
        both = [self._bounds(k, arg) for k, arg in zip(node.args, args, strict=True)]
        truth = decided(node.op, *both)
        if truth is None or all(self._builder.is_constant(arg.node) for arg in args):
            return
        left, right = (
            f"{low:g} .. {high:g}" if low < high else f"{low:g}" for low, high in filter(None, both)
        )
        unit = args[0].unit or args[1].unit
        self._findings.add(
            "W004.decided",
            node.at,
            value="TRUE" if truth else "FALSE",
            left=left,
            operators=OPERATORS[node.op],
            right=right,
            unit=f", in {unit}" if unit else "",
        )

    def _bounds(self, k: int, arg: Value) -> Bounds | None:
        if self._builder.is_constant(arg.node):
            value = self._builder.value(arg.node)
            return None if value is None else (value, value)
        return bounds(self._file.nodes, self._file.nodes[k], self._range)

    def _range(self, name: str) -> Bounds | None:
        found = self._scope.variables.get(name)
        return None if found is None or found.infinite else found.range

    def _number_of(self, node: SyntaxNode, arg: Value) -> Value | None:
        operand = self._file.nodes[node.args[0]]
        if operand.op != "name":
            self._findings.add("E007.number", operand.start)
            return None
        return Value(NUMBER, None, arg.node)

    def _hypot(self, args: list[Value], unit: str | None, at: tuple[int, int]) -> Value:
        """Add SQRT(x * x + y * y): nothing else, so that every target rounds alike."""
        squares = (
            self._builder.operation("mul", (argument.node, argument.node), at) for argument in args
        )
        total = self._builder.operation("add", tuple(squares), at)
        return Value(NUMBER, unit, self._builder.operation("sqrt", (total,), at))

    def _bounded(self, node: SyntaxNode, args: list[Value], at: tuple[int, int]) -> Value | None:
        x, *bounds = args
        for k in (0, 1):
            pair = self._aligned(node, x, bounds[k], operands=(0, k + 1))
            if pair is None:
                return None
            bounds[k] = pair[1]
        low, high = bounds
        if self._builder.is_constant(low.node) and self._builder.is_constant(high.node):
            ends = self._builder.value(low.node), self._builder.value(high.node)
            if None not in ends and ends[0] >= ends[1]:
                self._findings.add("E006.bounds", node.at, word=node.op.upper())
                return None
        if node.op == "clamp":
            made = self._builder.operation("greatest", (x.node, low.node), at)
            made = self._builder.operation("least", (made, high.node), at)
            return Value(NUMBER, x.unit or low.unit, made)
        made = self._builder.operation("hysteresis", (x.node, low.node, high.node), at)
        return Value(BOOL, None, made)

    def _window(self, node: SyntaxNode, arg: Value, at: tuple[int, int]) -> Value | None:
        period = self._builder.period
        if not period:
            self._findings.add("E005.no_rate", node.window_at, word=node.op.upper())
            return None
        if node.window < period:
            self._findings.add("E005.short_window", node.window_at, period=period / 1000000000.0)
            return None
        too_many = node.op in BUFFERED and capacity(node.window, period) > MAX_CAPACITY
        if too_many and not self._any_rate:
            samples = -(-node.window // period)
            self._findings.add(
                "E013.window", node.window_at, samples=samples, limit=MAX_CAPACITY // 2 - 8
            )
            return None
        made = self._builder.window(node.op, arg.node, node.window, node.coverage, at)
        unit = arg.unit if node.op in _KEEPS_UNIT else None
        return Value(result_of(node.op), unit, made)

    def _age(self, node: SyntaxNode, arg: Value, at: tuple[int, int]) -> Value | None:
        operand = self._file.nodes[node.args[0]]
        if operand.op != "name" or operand.text not in self._scope.variables:
            self._findings.add("E007.age", operand.start)
            return None
        number = self.used[operand.text]
        return Value(NUMBER, "s", self._builder.variable("age", number, at))

    def _aligned(
        self, node: SyntaxNode, left: Value, right: Value, operands: tuple[int, int] = (0, 1)
    ) -> Pair | None:
        places = [self._file.nodes[node.args[k]].start for k in operands]
        return aligned(left, right, places, self._builder, self._findings)

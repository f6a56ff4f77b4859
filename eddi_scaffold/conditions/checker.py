"""Types and units of expressions, and the operations of the program."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from eddi_scaffold.common.problems import SimilarNames, has_errors
from eddi_scaffold.common.units import converted, dimension, factor, root, word
from eddi_scaffold.conditions.definition import COMPARISONS
from eddi_scaffold.conditions.graph import At, GraphBuilder, capacity
from eddi_scaffold.conditions.lists import Elements, elements_of, reduced
from eddi_scaffold.conditions.scope import BOOL, NUMBER, TEXT, Scope, Type, arguments_of, result_of
from eddi_scaffold.conditions.syntax import OPERATORS, EventDeclaration, File, SyntaxNode, word_of
from eddi_scaffold.conditions.tokens import Refused, TextFindings, line_and_column
from eddi_scaffold.program.instructions import BUFFERED, MAX_CAPACITY
from eddi_scaffold.program.instructions import WINDOWS as WINDOW_OPS
from eddi_scaffold.program.python_text import comment

_ORDER = ("lt", "le", "gt", "ge")
_UNIT_OF_BOTH = ("add", "sub", "least", "greatest", "hypot")
_SAME_UNIT = (*_UNIT_OF_BOTH, *COMPARISONS)
_KEEPS_UNIT = ("neg", "abs", "sum", "stddev", "average", "max", "min", "median")
_MOST_WORDS = 500  # characters of the text in a comment; all of a chain would take long
_VAR_ADVICE = "declare it: VAR {0} : NUMBER, or VAR {0} : BOOL"


@dataclass(frozen=True)
class Value:
    """What a node of the text is."""

    type: Type  # of its value
    unit: str | None  # of its value, `None` for none
    node: int  # its number in the graph


@dataclass
class Checker:
    """Checks the expressions of one text and adds them to a graph."""

    file: File
    scope: Scope
    findings: TextFindings
    graph: GraphBuilder
    text: str
    any_rate: bool = False

    def __post_init__(self) -> None:
        self._elements = elements_of(self.file)
        self._inside: Elements | None = None
        self._events: dict[str, Value | None] = {}
        self._locate = line_and_column(self.text)
        self._reported: set[str] = set()
        self._is_whole = not has_errors(self.findings.problems)  # no declaration is missing
        self._similar: SimilarNames | None = None

    def event(self, event: EventDeclaration) -> Value | None:
        """Check one expression; return ``None`` when something is wrong with it."""
        values: dict[int, Value | None] = {}
        for k in range(event.first, event.root + 1):
            node = self.file.nodes[k]
            self._inside = self._elements.get(k)
            args = [values.pop(arg) for arg in node.args]
            try:
                values[k] = self._value(k, node, args)
            except Refused:
                self._inside, values[k] = None, None
        value = values[event.root]
        expected = (BOOL, NUMBER) if event.anonymous else (BOOL,)
        if value is not None and value.type not in expected:
            start = self.file.nodes[event.root].start
            self.findings.add("E007.event", start, type=value.type)
            value = None
        self._events[event.name] = value
        return value

    @property
    def _builder(self) -> GraphBuilder:
        """The graph of the text, or that of the elements of a list."""
        return self.graph if self._inside is None else self._inside

    def _value(self, k: int, node: SyntaxNode, args: list[Value | None]) -> Value | None:
        line, col = self._locate(node.at)
        words = comment(self.text[node.start : min(node.end, node.start + _MOST_WORDS)])
        at = At(f"{line}:{col} {words}", (line, col))
        if self._inside is not None and not self._inside.allows(node, self.scope):
            self.findings.refuse("E007.inside", node.start, word=node.text or word_of(node.op))
        if node.op == "number":
            return Value(NUMBER, node.unit, self._builder.leaf("number", float(node.text), at))
        if node.op == "truth":
            truth = 2 if node.text.upper() == "TRUE" else 0
            return Value(BOOL, None, self._builder.leaf("truth", truth, at))
        if node.op == "name":
            return self._name(node, at)
        known = [arg for arg in args if arg is not None]
        self._check_types(node, args)
        if len(known) != len(args):
            return None
        if node.options is not None:
            return self._reduction(k, node, known, at)
        if node.op in WINDOW_OPS:
            return self._window(node, known[0], at)
        return self._operation(node, known, at)

    def _reduction(self, k: int, node: SyntaxNode, args: list[Value], at: At) -> Value:
        """Return the value of a list; it is a variable that a message gives."""
        elements = self._elements[node.args[0]]
        self._inside = elements
        element = Value(NUMBER, elements.unit(self.scope), args[0].node)
        limits = [
            self._in_one_unit(node, element, limit, operands=(0, n))[1].node
            for n, limit in enumerate(args[1:], start=1)
        ]
        self._inside = None
        nodes = [args[0].node, *limits]
        variable = reduced(self.file, k, elements, nodes, self.scope, self.findings)
        type_ = result_of(node.op)
        unit = args[0].unit if type_ == NUMBER and node.op != "list_count" else None
        self.scope.reductions.setdefault(variable.name, replace(variable, unit=unit))
        return Value(type_, unit, self.graph.variable(variable.name, at))

    # names

    def _name(self, node: SyntaxNode, at: At) -> Value | None:
        name, scope = node.text, self.scope
        if self._inside is None and node.is_list:
            self.findings.refuse("E007.list", node.start, list=name)
        if name in scope.literals:
            enum, number = scope.literals[name]
            return Value(Type("enum", enum), None, self._builder.leaf("literal", number, at))
        if name in scope.constants:
            bound = scope.constants[name]
            return Value(NUMBER, bound.unit, self._builder.leaf("number", bound.value, at))
        if name in scope.variables:
            variable = scope.variables[name]
            if variable.type is not None:
                return Value(variable.type, variable.unit, self._builder.variable(name, at))
            if not variable.declared and name not in self._reported:
                self._reported.add(name)
                advice = variable.advice or _VAR_ADVICE.format(name)
                self.findings.add("E008.list_type", node.start, hint=advice, node=name)
        elif scope.knows(name):
            return self._events.get(name)
        elif self._is_whole and name not in self._reported:
            self._reported.add(name)
            self._similar = self._similar or SimilarNames(scope.names, "there are")
            hint = self._similar.hint(name)
            self.findings.add("E008.unknown_variable", node.start, hint=hint, name=name)
        return None

    # types

    def _check_types(self, node: SyntaxNode, args: list[Value | None]) -> None:
        types = [arg.type for arg in args if arg is not None]
        if node.op in ("known", "age", "eq", "ne"):
            if len(set(types)) > 1:
                self.findings.refuse("E007.comparison", node.at, left=types[0], right=types[1])
            if TEXT in types and None not in args:
                operand = self.file.nodes[node.args[0]]
                self.findings.refuse("E007.text", operand.start, operand=operand.text)
            return
        wrong = [
            (self.file.nodes[k].start, arg.type, type_)
            for k, arg, type_ in zip(node.args, args, arguments_of(node.op), strict=False)
            if arg is not None and arg.type != type_
        ]
        if node.op in _ORDER and len(wrong) == 2:
            shown = " and ".join(sorted(set(map(str, types))))
            self.findings.refuse("E007.order", node.at, shown=shown, operators=OPERATORS[node.op])
        for start, actual, expected in wrong:
            shown = word_of(node.op)
            self.findings.add("E007.operand", start, shown=shown, expected=expected, type=actual)
        if wrong:
            raise Refused

    # operations

    def _operation(self, node: SyntaxNode, args: list[Value], at: At) -> Value:
        op, unit, builder = node.op, None, self._builder
        operand = self.file.nodes[node.args[0]]
        if op == "number_of":
            if operand.op == "name":
                return Value(NUMBER, None, args[0].node)
            self.findings.refuse("E007.number", operand.start)
        if op == "age":
            if operand.op == "name" and operand.text in self.scope.variables:
                return Value(NUMBER, "s", builder.leaf("age", self.graph.used[operand.text], at))
            self.findings.refuse("E007.age", operand.start)
        if op in ("hysteresis", "clamp"):
            return self._bounded(node, args, at)
        if op in _SAME_UNIT and args[0].type == NUMBER:
            args = list(self._in_one_unit(node, args[0], args[1]))
            if op in _ORDER:
                self._warn_decided(node, args)
            unit = args[0].unit or args[1].unit if op in _UNIT_OF_BOTH else None
        nodes = [arg.node for arg in args]
        if op == "hypot":  # nothing else, so that every target rounds alike
            squares = [builder.operation("mul", (k, k), at) for k in nodes]
            op, nodes = "sqrt", [builder.operation("add", squares, at)]
        elif op in ("eq", "ne", "known") and args[0].type != NUMBER:
            op = f"{op}_{args[0].type.kind}"
        elif op in _KEEPS_UNIT:
            unit = args[0].unit
        elif op == "elapsed":
            unit = "s"
        elif op == "sqrt":
            unit = root(args[0].unit)
        return Value(result_of(op), unit, builder.operation(op, nodes, at))

    def _warn_decided(self, node: SyntaxNode, args: list[Value]) -> None:
        """Warn of a comparison that the declared range of its variable decides alone."""
        left, right = (self._bounds(arg) for arg in args)
        if (
            left is None
            or right is None
            or all(self._builder.is_constant(arg.node) for arg in args)
        ):
            return
        truths = {COMPARISONS[node.op](a, b) for a in left for b in right}
        if len(truths) == 1:
            unit = args[0].unit or args[1].unit
            self.findings.add(
                "W004.decided",
                node.at,
                value=str(*truths).upper(),
                left=" .. ".join(f"{end:g}" for end in dict.fromkeys(left)),
                operators=OPERATORS[node.op],
                right=" .. ".join(f"{end:g}" for end in dict.fromkeys(right)),
                unit=f", in {unit}" if unit else "",
            )

    def _bounds(self, arg: Value) -> Sequence[float] | None:
        """Return between which numbers an operand lies, ``None`` where that is not known."""
        row = self._builder.operations[arg.node]
        if row.op == "number":
            return None if row.value is None else (row.value, row.value)
        variable = None
        if row.op == "variable":
            variable = self.scope.variables.get([*self._builder.used][row.value])
        return None if variable is None or variable.infinite else variable.range

    def _bounded(self, node: SyntaxNode, args: list[Value], at: At) -> Value:
        x, *limits = args
        low, high = (
            self._in_one_unit(node, x, limit, operands=(0, k))[1]
            for k, limit in enumerate(limits, 1)
        )
        builder = self._builder
        operations = [builder.operations[end.node] for end in (low, high)]
        values = [row.value for row in operations if row.op == "number"]
        if len(values) == 2 and None not in values and values[0] >= values[1]:
            self.findings.refuse("E006.bounds", node.at, word=node.op.upper())
        if node.op == "clamp":
            least = builder.operation("greatest", (x.node, low.node), at)
            clamped = builder.operation("least", (least, high.node), at)
            return Value(NUMBER, x.unit or low.unit, clamped)
        nodes = (x.node, low.node, high.node)
        return Value(BOOL, None, builder.operation("hysteresis", nodes, at))

    def _window(self, node: SyntaxNode, arg: Value, at: At) -> Value:
        period, place = self._builder.period, node.window_at
        if not period:
            self.findings.refuse("E005.no_rate", place, word=node.op.upper())
        if node.window < period:
            self.findings.refuse("E005.short_window", place, period=period / 1e9)
        is_bounded = node.op not in BUFFERED or self.any_rate
        if not is_bounded and capacity(node.window, period) > MAX_CAPACITY:
            samples, limit = -(-node.window // period), MAX_CAPACITY // 2 - 8
            self.findings.refuse("E013.window", place, samples=samples, limit=limit)
        unit = arg.unit if node.op in _KEEPS_UNIT else None
        window = self._builder.window(node.op, arg.node, node.window, node.coverage, at)
        return Value(result_of(node.op), unit, window)

    # units

    def _in_one_unit(
        self, node: SyntaxNode, left: Value, right: Value, operands: Sequence[int] = (0, 1)
    ) -> tuple[Value, Value]:
        """Bring two numbers to one unit; refuse where that cannot be."""
        starts = [self.file.nodes[node.args[k]].start for k in operands]
        constant = [self._builder.is_constant(value.node) for value in (left, right)]
        if left.unit == right.unit:
            return left, right
        if left.unit is not None and factor(left.unit, right.unit or "") == 1:
            return left, replace(right, unit=left.unit)  # another name of the same
        if left.unit is None or right.unit is None:
            plain, unit = (left if left.unit is None else right), left.unit or right.unit or ""
            other = 1 if plain is left else 0
            if not constant[other] or constant[1 - other]:
                return replace(left, unit=unit), replace(right, unit=unit)
            self.findings.refuse("E009.one_side", starts[other], unit=unit, word=word(unit))
        if dimension(left.unit) != dimension(right.unit):
            shown = " and ".join(f"{unit} ({dimension(unit)})" for unit in (left.unit, right.unit))
            at = starts[0 if constant[0] and not constant[1] else 1]
            self.findings.refuse("E009.apart", at, shown=shown)
        if not any(constant):
            units = {"unit": left.unit, "right_unit": right.unit}
            times = converted(1.0, right.unit, left.unit)
            self.findings.refuse("E009.scale", starts[1], **units, times=times)
        if constant[1]:
            return left, self._converted(right, left.unit, starts[1])
        return self._converted(left, right.unit, starts[0]), right

    def _converted(self, value: Value, unit: str, start: int) -> Value:
        """Return a constant in another unit of its dimension."""
        row = self._builder.operations[value.node]
        number = None if row.value is None else converted(row.value, value.unit or "", unit)
        if number is not None and not math.isfinite(number):
            self.findings.refuse("E013.number_in_unit", start, unit=unit)
        return Value(NUMBER, unit, self._builder.add(row._replace(value=number)))

"""Types and units of expressions, and their nodes in the intermediate form."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from eddi_runtime.event.form import BUFFERED, MAX_CAPACITY, SIGNATURES
from eddi_runtime.event.form import WINDOWS as WINDOW_OPS

from eddi_scaffold.events.diagnostics import Findings
from eddi_scaffold.events.graph import GraphBuilder, capacity
from eddi_scaffold.events.scope import BOOL, NUMBER, Scope, Type
from eddi_scaffold.events.syntax import OPERATORS, EventDeclaration, File, Node
from eddi_scaffold.events.units import converted, dimension
from eddi_scaffold.problems import did_you_mean

_KINDS = {"number": NUMBER, "bool": BOOL}
_ORDER = ("lt", "le", "gt", "ge")
_SAME_UNIT = ("add", "sub", *_ORDER, "eq", "ne")
_KEEPS_UNIT = ("neg", "abs", "average", "max", "min", "sum", "stddev", "median")
_SECONDS = ("elapsed", "age")
_VAR_ADVICE = "say what it is: VAR {0} : NUMBER, or VAR {0} : BOOL"


@dataclass(frozen=True)
class Value:
    """What a node of the text is.

    Attributes:
        type: of its value.
        unit: of its value, ``None`` for none.
        node: its number in the graph.
    """

    type: Type
    unit: str | None
    node: int


class Checker:
    """Checks the expressions of one text and adds them to a graph.

    Attributes:
        used: variables in the order of their first use; their numbers in the graph.
    """

    def __init__(
        self,
        file: File,
        scope: Scope,
        findings: Findings,
        builder: GraphBuilder,
        locate: Callable[[int], tuple[int, int]],
        *,
        any_rate: bool = False,
    ) -> None:
        self.used: dict[str, int] = {}
        self._file = file
        self._scope = scope
        self._findings = findings
        self._builder = builder
        self._locate = locate
        self._any_rate = any_rate
        self._events: dict[str, Value | None] = {}
        self._reported: set[str] = set()

    def event(self, event: EventDeclaration) -> Value | None:
        """Check one expression; return ``None`` when something is wrong with it."""
        values: dict[int, Value | None] = {}
        for k in range(event.first, event.root + 1):
            node = self._file.nodes[k]
            args = [values.pop(arg) for arg in node.args]
            values[k] = self._value(node, args)
        found = values[event.root]
        root = self._file.nodes[event.root]
        if (
            found is not None
            and found.type != BOOL
            and not (event.anonymous and found.type == NUMBER)
        ):
            message = f"an event is a boolean, this is {found.type}"
            self._findings.error("E007", root.start, message)
            found = None
        self._events[event.name] = found
        return found

    def _value(self, node: Node, args: list[Value | None]) -> Value | None:
        at = self._locate(node.at)
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
        if node.op in WINDOW_OPS:
            return self._window(node, known[0], at)
        if node.op == "age":
            return self._age(node, known[0], at)
        return self._operation(node, known, at)

    # names

    def _name(self, node: Node, at: tuple[int, int]) -> Value | None:
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
            hint = did_you_mean(name, scope.names) or f"there are: {', '.join(scope.names) or '-'}"
            self._findings.error("E008", node.start, f"there is no variable {name!r}", hint)
        return None

    def _variable(self, node: Node, at: tuple[int, int]) -> Value | None:
        variable = self._scope.variables[node.text]
        if variable.type is None:
            if not variable.declared and node.text not in self._reported:
                self._reported.add(node.text)
                message = f"nothing says what {node.text!r} is"
                hint = _VAR_ADVICE.format(node.text)
                self._findings.error("E008", node.start, message, hint)
            return None
        number = self.used.setdefault(node.text, len(self.used))
        made = self._builder.variable("variable", number, at)
        return Value(variable.type, variable.unit, made)

    # types

    def _arguments_fit(self, node: Node, args: list[Value | None]) -> bool:
        """Report operands of a wrong type."""
        if node.op in ("known", "age"):
            return True
        if node.op in ("eq", "ne"):
            return self._same_types(node, args)
        wanted = _KINDS[SIGNATURES[node.op][0][0]]
        wrong = [k for k, arg in enumerate(args) if arg is not None and arg.type != wanted]
        if not wrong:
            return True
        if node.op in _ORDER and len(wrong) == 2:
            types = " and ".join(sorted({str(arg.type) for arg in args if arg is not None}))
            message = f"{types} cannot be ordered: {OPERATORS[node.op]} compares numbers"
            self._findings.error("E007", node.at, message)
            return False
        for k in wrong:
            self._wrong_type(node, self._file.nodes[node.args[k]], args[k], wanted)
        return False

    def _wrong_type(self, node: Node, operand: Node, value: Value | None, wanted: Type) -> None:
        assert value is not None
        shown = OPERATORS.get(node.op, node.op.upper() if node.op != "neg" else "-")
        variable = self._scope.variables.get(operand.text) if operand.op == "name" else None
        if variable is not None and not variable.declared:
            message = f"{operand.text!r} is {value.type} elsewhere, but {shown} needs {wanted}"
            hint = _VAR_ADVICE.format(operand.text)
            self._findings.error("E008", operand.start, message, hint)
        else:
            message = f"{shown} needs {wanted}, this is {value.type}"
            self._findings.error("E007", operand.start, message)

    def _same_types(self, node: Node, args: list[Value | None]) -> bool:
        left, right = args
        if left is None or right is None or left.type == right.type:
            return True
        message = f"{left.type} and {right.type} cannot be compared"
        self._findings.error("E007", node.at, message)
        return False

    # operations

    def _operation(self, node: Node, args: list[Value], at: tuple[int, int]) -> Value | None:
        op, unit = node.op, None
        if op in _SAME_UNIT and args[0].type == NUMBER:
            aligned = self._aligned(node, args[0], args[1])
            if aligned is None:
                return None
            args = list(aligned)
            unit = args[0].unit or args[1].unit if op in ("add", "sub") else None
        if op == "hysteresis":
            return self._hysteresis(node, args, at)
        if op in ("eq", "ne", "known") and args[0].type != NUMBER:
            op = f"{op}_{args[0].type.kind}"
        if op in _KEEPS_UNIT:
            unit = args[0].unit
        elif op in _SECONDS:
            unit = "s"
        made = self._builder.operation(op, tuple(arg.node for arg in args), at)
        return Value(_KINDS[SIGNATURES[op][1]], unit, made)

    def _hysteresis(self, node: Node, args: list[Value], at: tuple[int, int]) -> Value | None:
        x, *bounds = args
        for k in (0, 1):
            aligned = self._aligned(node, x, bounds[k], operands=(0, k + 1))
            if aligned is None:
                return None
            bounds[k] = aligned[1]
        low, high = bounds
        if self._builder.is_constant(low.node) and self._builder.is_constant(high.node):
            ends = self._builder.value(low.node), self._builder.value(high.node)
            if None not in ends and ends[0] >= ends[1]:
                message = "the lower bound of HYSTERESIS must be below the upper one"
                self._findings.error("E006", node.at, message)
                return None
        made = self._builder.operation("hysteresis", (x.node, low.node, high.node), at)
        return Value(BOOL, None, made)

    def _window(self, node: Node, arg: Value, at: tuple[int, int]) -> Value | None:
        period = self._builder.period
        if not period:
            message = f"{node.op.upper()} needs a sampling rate"
            self._findings.error("E005", node.window_at, message, "say it: --rate 10")
            return None
        if node.window < period:
            message = f"the window is shorter than one sample period ({period / 1e9:g} s)"
            self._findings.error("E005", node.window_at, message)
            return None
        too_many = node.op in BUFFERED and capacity(node.window, period) > MAX_CAPACITY
        if too_many and not self._any_rate:
            samples = -(-node.window // period)
            message = f"the window has {samples} samples, more than {MAX_CAPACITY // 2 - 8}"
            self._findings.error("E013", node.window_at, message, "TIME and ONCE need no buffer")
            return None
        made = self._builder.window(node.op, arg.node, node.window, node.coverage, at)
        unit = arg.unit if node.op in _KEEPS_UNIT else None
        return Value(_KINDS[SIGNATURES[node.op][1]], unit, made)

    def _age(self, node: Node, arg: Value, at: tuple[int, int]) -> Value | None:
        operand = self._file.nodes[node.args[0]]
        if operand.op != "name" or operand.text not in self._scope.variables:
            self._findings.error("E007", operand.start, "AGE needs a variable")
            return None
        number = self.used[operand.text]
        return Value(NUMBER, "s", self._builder.variable("age", number, at))

    # units

    def _aligned(
        self, node: Node, left: Value, right: Value, operands: tuple[int, int] = (0, 1)
    ) -> tuple[Value, Value] | None:
        """Bring two numbers to one unit; ``None`` when that cannot be."""
        constant = [self._builder.is_constant(one.node) for one in (left, right)]
        if left.unit == right.unit:
            return left, right
        places = [self._file.nodes[node.args[k]].start for k in operands]
        if left.unit is None or right.unit is None:
            plain = 0 if left.unit is None else 1
            if constant[1 - plain] and not constant[plain]:
                unit = left.unit or right.unit
                message = f"this is in {unit}, but the other side has no unit"
                hint = f"declare the unit: VAR name : NUMBER UNIT {unit}"
                self._findings.error("E009", places[1 - plain], message, hint)
                return None
            unit = left.unit or right.unit  # a plain number is in the unit of the other side
            return replace(left, unit=unit), replace(right, unit=unit)
        if dimension(left.unit) != dimension(right.unit):
            message = (
                f"{left.unit} ({dimension(left.unit)}) and {right.unit} ({dimension(right.unit)}) "
                "do not go together"
            )
            self._findings.error(
                "E009", places[0 if constant[0] and not constant[1] else 1], message
            )
            return None
        if constant[1]:
            made = self._converted(right, left.unit, places[1])
            return None if made is None else (left, made)
        if constant[0]:
            made = self._converted(left, right.unit, places[0])
            return None if made is None else (made, right)
        factor = converted(1.0, right.unit, left.unit)
        message = f"the left side is in {left.unit}, this is in {right.unit}"
        self._findings.error("E009", places[1], message, f"multiply it by {factor:g}")
        return None

    def _converted(self, value: Value, unit: str, place: int) -> Value | None:
        """Return a constant in another unit of its dimension."""
        row = self._builder.rows[value.node]
        number = None if row["value"] is None else converted(row["value"], value.unit or "", unit)
        if number is not None and not math.isfinite(number):
            self._findings.error("E013", place, f"the number does not fit into a double in {unit}")
            return None
        line, column = row["at"]
        return Value(NUMBER, unit, self._builder.number(number, (line, column)))

"""Events by their definition: the whole history is kept, every window is looked through anew.

Written against the specification and independently of the library's evaluation: it walks the
parse tree, with None for UNKNOWN. Slow and obvious.
"""

import math
from dataclasses import dataclass, field

from eddi_scaffold.conditions.syntax import File, SyntaxNode

WINDOWS = {"average", "sum", "max", "min", "median", "stddev", "rate", "count", "time", "once"}
_ARITHMETIC = {"neg", "abs", "sqrt", "add", "sub", "mul", "div"}
_ARITHMETIC |= {"hypot", "least", "greatest", "clamp"}


class NearTie(Exception):  # noqa: N818 - no error: a verdict that nobody can know
    """Two sides of a comparison differ by rounding only: any verdict is right."""


@dataclass(frozen=True)
class Input:
    """What the definition says of a variable."""

    type: str
    range: tuple[float, float] | None = None
    timeout: int | None = None
    infinite: bool = False
    literals: tuple[str, ...] = ()


@dataclass
class Reference:
    """One text, evaluated step by step."""

    file: File  # the parse tree
    inputs: dict[str, Input]  # variable -> what is said of it
    period: int  # nanoseconds
    times: list[int] = field(default_factory=list)
    since: int = 0
    history: list[list[object]] = field(default_factory=list)
    samples: dict[str, object] = field(default_factory=dict)
    ages: dict[str, object] = field(default_factory=dict)
    last_valid: dict[str, int] = field(default_factory=dict)
    ties: set[int] = field(default_factory=set)
    last: dict[str, object] = field(default_factory=dict)

    def step(self, t: int, values: dict[str, object], stamps: dict[str, int]) -> dict[str, object]:
        """Return event -> True, False, None, a number, or NearTie."""
        if self.times and t == self.times[-1]:
            return self.last
        if self.times and t < self.times[-1]:
            self.times = []
            self.last_valid = {}
        if not self.times:
            self.since = t
            self.history = [[] for _ in self.file.nodes]
            self.ties = set()
        elif t - self.times[-1] > 2.5 * self.period:
            self.since = t
        self.times.append(t)
        self._sample(t, values, stamps)
        for k, node in enumerate(self.file.nodes):
            if any(arg in self.ties for arg in node.args) or k in self.ties:
                self.ties.add(k)
                self.history[k].append(None)
                continue
            try:
                self.history[k].append(self._value(node))
            except NearTie:
                self.ties.add(k)
                self.history[k].append(None)
        self.last = {
            event.name: NearTie if event.root in self.ties else self.history[event.root][-1]
            for event in self.file.events
        }
        return self.last

    def _sample(self, t: int, values: dict[str, object], stamps: dict[str, int]) -> None:
        for name, spec in self.inputs.items():
            value = valid(values.get(name), spec)
            stamp = stamps.get(name, t)
            if stamp > t + self.period:
                value = None
            stamp = min(stamp, t)
            if value is not None:
                self.last_valid[name] = stamp
            if spec.timeout is not None and t - stamp > spec.timeout:
                value = None
            self.samples[name] = value

    def _value(self, node: SyntaxNode) -> object:
        args = [self.history[k][-1] for k in node.args]
        if node.op == "number":
            return float(node.text)
        if node.op == "truth":
            return node.text.upper() == "TRUE"
        if node.op == "name":
            return self._name(node.text)
        if node.op in WINDOWS:
            return self._window(node)
        if node.op == "age":
            name = self.file.nodes[node.args[0]].text
            known = name in self.last_valid
            return (self.times[-1] - self.last_valid[name]) / 1e9 if known else None
        if node.op in ("rise", "fall", "edge", "latch", "hysteresis", "elapsed"):
            return self._state(node)
        return combine(node.op, args)

    def _name(self, name: str) -> object:
        if name in self.inputs:
            return self.samples[name]
        for event in self.file.events:
            if event.name == name:
                return self.history[event.root][-1]
        return name  # a literal of an ENUM

    def _window(self, node: SyntaxNode) -> object:
        now, length = self.times[-1], node.window
        inside = [k for k, t in enumerate(self.times) if now - length < t <= now]
        samples = [(self.times[k], self.history[node.args[0]][k]) for k in inside]
        full = self.since <= now - length + self.period
        values = [value for _, value in samples]
        if node.op in ("time", "once"):
            dominant = node.op == "once"
            if dominant in values:
                return dominant
            return not dominant if full and None not in values else None
        if node.op in ("average", "sum", "stddev", "rate"):  # infinity is no sample here
            samples = [(t, None if x in (math.inf, -math.inf) else x) for t, x in samples]
        known = [(t, x) for t, x in samples if x is not None]
        enough = 1.0 if node.coverage is None else node.coverage
        if not full or len(known) / len(samples) < enough:
            return None
        return aggregate(node.op, known)

    def _state(self, node: SyntaxNode) -> object:
        states = [self.history[k] for k in node.args]
        if node.op in ("rise", "fall", "edge"):
            now = states[0][-1]
            before = states[0][-2] if len(states[0]) > 1 else None
            rise = combine("and", [now, combine("not", [before])])
            fall = combine("and", [combine("not", [now]), before])
            return {"rise": rise, "fall": fall, "edge": combine("or", [rise, fall])}[node.op]
        if node.op == "latch":
            q: object = False
            for s, r in zip(*states, strict=True):
                q = combine("or", [s, combine("and", [q, combine("not", [r])])])
            return q
        if node.op == "hysteresis":
            held: object = None
            for x, low, high in zip(*states, strict=True):
                if None in (x, low, high):
                    held = None
                elif x >= high:
                    held = True
                elif x <= low:
                    held = False
            return held
        edge: int | None = None
        for k, now in enumerate(states[0]):
            if now is None:
                edge = None
            elif now and k > 0 and states[0][k - 1] is False:
                edge = self.times[k]
        return None if edge is None else (self.times[-1] - edge) / 1e9


def valid(value: object, spec: Input) -> object:
    """Return a sample, None when it does not count."""
    if spec.type == "bool":
        return value if isinstance(value, bool) else None
    if spec.type == "enum":
        return value if value in spec.literals else None
    if isinstance(value, bool) or not isinstance(value, int | float) or math.isnan(value):
        return None
    if math.isinf(value):
        return value if spec.infinite else None
    if spec.range is not None and not spec.range[0] <= value <= spec.range[1]:
        return None
    return float(value)


def aggregate(op: str, known: list[tuple[int, object]]) -> object:
    values = [x for _, x in known]
    if op == "count":
        return float(sum(x is True for x in values))
    if op in ("max", "min"):
        return max(values) if op == "max" else min(values)
    try:
        if op in ("sum", "average"):
            return finite(math.fsum(values) / (len(values) if op == "average" else 1))
        if op == "median":
            ordered = sorted(values)
            low, high = ordered[(len(ordered) - 1) // 2], ordered[len(ordered) // 2]
            return low if low == high else finite(low / 2 + high / 2)
        if len(known) < 2:
            return None
        if op == "stddev":
            mean = math.fsum(values) / len(values)
            squares = math.fsum((x - mean) * (x - mean) for x in values)
            return finite(math.sqrt(squares / (len(values) - 1)))
        (first_t, first), (last_t, last) = known[0], known[-1]
        return finite((last - first) / ((last_t - first_t) / 1e9))
    except OverflowError:
        return None


def combine(op: str, args: list[object]) -> object:
    if op == "known":
        return args[0] is not None
    if op == "and":
        return False if False in args else None if None in args else True
    if op == "or":
        return True if True in args else None if None in args else False
    if op == "implies":
        return combine("or", [combine("not", args[:1]), args[1]])
    if None in args:
        return None
    if op == "not":
        return not args[0]
    if op == "xor":
        return args[0] is not args[1]
    if op in _ARITHMETIC:
        return arithmetic(op, args)
    a, b = args
    numbers = not isinstance(a, bool | str)
    if numbers and a != b and math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-12):
        raise NearTie
    return {
        "lt": lambda: a < b,
        "le": lambda: a <= b,
        "gt": lambda: a > b,
        "ge": lambda: a >= b,
        "eq": lambda: a == b,
        "ne": lambda: a != b,
    }[op]()


def arithmetic(op: str, args: list[object]) -> object:
    if op in ("least", "greatest"):
        return min(args) if op == "least" else max(args)
    if op == "clamp":
        x, low, high = args
        return min(max(x, low), high)
    if op == "abs":
        return abs(args[0])
    if math.inf in args or -math.inf in args:
        return None
    if op == "neg":
        return -args[0]
    if op == "sqrt":
        return math.sqrt(args[0]) if args[0] >= 0 else None
    if op == "hypot":
        squares = finite(sum(x * x for x in args))
        return None if squares is None else math.sqrt(squares)
    a, b = args
    if op == "div":
        return finite(a / b) if b else None
    return finite({"add": a + b, "sub": a - b, "mul": a * b}[op])


def finite(value: float) -> float | None:
    return value if math.isfinite(value) else None

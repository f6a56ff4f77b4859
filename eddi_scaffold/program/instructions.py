"""The program that a model is compiled to: values are read, operations follow, results are given.

A front end makes it (``kinds.consert.compile``, ``conditions.analysis``); a back end prints it:
``python_step`` the step in ``compiled.py``, ``c_step`` the one of a monitor in C99. Each
operation is done once in a step, after those that it works on, and has one value. A value is

- a *truth*: 0 FALSE < 1 UNKNOWN < 2 TRUE; AND is the least and OR the greatest (strong Kleene),
- a *number*: a double, NaN is UNKNOWN; an overflow is UNKNOWN, too,
- an *enum*: the number of a literal, -1 is UNKNOWN, or a *text*, or none.

===================================  ===============================================================
``variable``                         a value that is read; it is UNKNOWN beyond its range or timeout
``number truth literal``             a constant
``neg abs sqrt add sub mul div``     arithmetic; what has no finite value is UNKNOWN
``least greatest``                   of two numbers; UNKNOWN when one is
``lt le gt ge eq ne``                comparisons of numbers; with ``_bool``, ``_enum`` of others
``and or``                           of any number of truths from two on
``not xor implies``                  logic
``known`` (``_bool``, ``_enum``)     whether a value is not UNKNOWN
``average sum max min median``       over the samples of a window: numbers;
``stddev rate count``                ``coverage``: that share must be known, else all
``time once``                        AND and OR over a window
``rise fall edge latch``             of truths; they remember the step before
``hysteresis elapsed age``           state by two limits; seconds since a change, a known sample
``is_true is_false``                 judge evidence: a truth, and what is good when it is false
``is_covered is_within``             judge evidence: a text among ``value``, a number in a
                                     range of it; FALSE for others, UNKNOWN when it is not known
``debounce majority``                a truth filtered over ``value`` steps
===================================  ===============================================================
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from eddi_scaffold.program.lists import Reduction

NUMBER, BOOL, ENUM, TEXT = "number", "bool", "enum", "text"

MAX_NS = 1 << 62  # longest duration; sums of two fit into 64 bits
LEAVES = ("variable", "number", "truth", "literal")
BUFFERED = ("average", "sum", "max", "min", "median", "stddev", "rate", "count")
WINDOWS = (*BUFFERED, "time", "once")
FILTERS = ("debounce", "majority")
STARTS = {"rise": 1, "fall": 1, "edge": 1, "latch": 0, "hysteresis": 1, "elapsed": 1}
"""Operation -> the truth that it remembers at the start."""


class Interval(NamedTuple):
    """A range of numbers; the start lies inside."""

    start: float  # smallest double inside
    end: float  # the other end
    closed: bool  # the end lies inside as well


class Read(NamedTuple):
    """A value that is read once in each step."""

    name: str  # as in the model (`motor.temps[1]`)
    type: str  # `number`, `bool`, `enum` or `text`
    range: tuple[float, float] | None = None  # least and greatest value; None for no limits
    timeout: int | None = None  # nanoseconds after which a sample is UNKNOWN; None for never
    infinite: bool = False  # infinity is a value
    literals: tuple[str, ...] = ()  # texts of an ENUM
    stamped: bool = False  # the time of its sample is asked for (`age` or a timeout)
    text: bool = False  # it comes as a text that represents a number in decimal
    # how it is made of the lists of a message; None: it comes as it is
    reduction: Reduction | None = None
    about: str = ""  # what it should be, for people
    defined: bool = False  # the definition of the message says that infinity is a measurement


class Operation(NamedTuple):
    """What is done once in a step; its number is its place in the program."""

    op: str  # see above
    args: tuple[int, ...]  # numbers of the operations whose values it works on
    type: str  # of its value
    # a constant, the number of what is read or of a literal, what is covered, or steps
    value: Any = None
    about: str = ""  # the element of the model that it comes from: its place and words
    window: int = 0  # nanoseconds
    capacity: int = 0  # samples that the buffer holds
    coverage: float | None = None  # share of known samples that is enough; None: all
    infinite: bool = False  # the value can be infinite
    at: tuple[int, int] = (0, 0)  # line and column in the text of the condition


class Result(NamedTuple):
    """A result of a step."""

    id: str  # of the event or the guarantee
    operation: int  # number of the one whose value it is
    hazard: bool = False  # UNKNOWN counts as active
    about: str = ""  # the element of the model that it comes from


class Program(NamedTuple):
    """A checked program."""

    period: int  # nanoseconds between two steps, 0 when there is no rate
    reads: tuple[Read, ...]  # what is read
    operations: tuple[Operation, ...]  # in the order of evaluation
    results: tuple[Result, ...]  # what is given


def reads_of_results(program: Program) -> list[list[int]]:
    """Return for each result the numbers of the reads that it depends on, in order."""
    masks: list[int] = []  # of each operation, whose arguments are before it
    for operation in program.operations:
        mask = 1 << int(operation.value) if operation.op in ("variable", "age") else 0
        for k in operation.args:
            mask |= masks[k]
        masks.append(mask)
    count = range(len(program.reads))
    return [[k for k in count if masks[result.operation] >> k & 1] for result in program.results]


def must_be_finite(program: Program) -> frozenset[int]:
    """Return the operations where an overflow must become NaN at once.

    Inside of sums and products it need not: infinity ends as infinity or NaN whatever follows.
    """
    absorbing = ("add", "sub", "mul")
    used = {result.operation for result in program.results}
    for operation in program.operations:
        if operation.op not in absorbing:
            used.update(operation.args)
    return frozenset(used)


@dataclass(frozen=True)
class HostInput:
    """One value that a host gives in each step."""

    name: str  # as in the text (`scan.ranges[*]`)
    type: str  # `number`, `bool`, `enum` or `text`
    list: bool = False  # it is a list of these
    literals: tuple[str, ...] = ()  # texts of an ENUM


class Sampling:
    """Which values of a host each read of a program is made of."""

    def __init__(self, program: Program) -> None:
        by_name: dict[str, HostInput] = {}
        names: list[list[str]] = []
        for read in program.reads:
            inputs = [
                HostInput(read.name, "text" if read.text else read.type, False, read.literals)
            ]
            if read.reduction is not None:
                parts = read.reduction.inputs
                inputs = [HostInput(part.name, part.type, part.is_list) for part in parts]
            names.append([input_.name for input_ in inputs])
            for input_ in inputs:
                by_name.setdefault(input_.name, input_)
        # what the host gives, once each, in the order of the reads
        self.inputs = tuple(by_name.values())
        numbers = {name: k for k, name in enumerate(by_name)}
        # for each read the numbers of the inputs that it is made of
        self.uses = [[numbers[name] for name in used] for used in names]


_SIGNATURES: tuple[tuple[str, tuple[str, ...], str], ...] = (
    ("neg abs sqrt average sum max min median stddev rate", (NUMBER,), NUMBER),
    ("least greatest add sub mul div", (NUMBER, NUMBER), NUMBER),
    ("lt le gt ge eq ne", (NUMBER, NUMBER), BOOL),
    ("eq_bool ne_bool and or xor implies latch", (BOOL, BOOL), BOOL),
    ("eq_enum ne_enum", (ENUM, ENUM), BOOL),
    ("not time once rise fall edge known_bool", (BOOL,), BOOL),
    ("count elapsed", (BOOL,), NUMBER),
    ("hysteresis", (NUMBER, NUMBER, NUMBER), BOOL),
    ("known", (NUMBER,), BOOL),
    ("known_enum", (ENUM,), BOOL),
    ("age", (), NUMBER),
)
SIGNATURES = {
    name: (arguments, type_) for names, arguments, type_ in _SIGNATURES for name in names.split()
}
"""Operation -> types of its arguments and of its value; ``age`` names a variable."""
MAX_CAPACITY = 1 << 20  # samples in one window: 16 MB in C


class Builder:
    """A program in the making; equal reads are one."""

    def __init__(self) -> None:
        self._reads: dict[Read, int] = {}
        self._operations: list[Operation] = []

    def add(self, operation: Operation) -> int:
        """Add an operation; return its number."""
        self._operations.append(operation)
        return len(self._operations) - 1

    def append(self, program: Program, computed: Mapping[int, int] | None = None) -> list[int]:
        """Add the operations of a program, but reads that are ``given``; return the new numbers."""
        computed = computed or {}
        numbers = {
            k: self._reads.setdefault(read, len(self._reads))
            for k, read in enumerate(program.reads)
            if k not in computed
        }
        places: list[int] = []
        for operation in program.operations:
            op, value = operation.op, operation.value
            if op == "variable" and value in computed:
                places.append(computed[value])
                continue
            value = numbers[value] if op in ("variable", "age") else value
            args = tuple(places[k] for k in operation.args)
            places.append(self.add(operation._replace(args=args, value=value)))
        return places

    def program(self, period: int, results: Sequence[Result]) -> Program:
        """Return the program."""
        return Program(period, tuple(self._reads), tuple(self._operations), tuple(results))


def joined(programs: Sequence[Program]) -> Program:
    """Return one program with the first result of each, in which equal reads are one."""
    builder = Builder()
    results = []
    for program in programs:
        places = builder.append(program)
        result = program.results[0]
        results.append(result._replace(operation=places[result.operation]))
    return builder.program(programs[0].period, results)

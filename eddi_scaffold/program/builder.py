"""Programs in the making, of operations and of other programs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from eddi_scaffold.program.instructions import BOOL, ENUM, NUMBER, Operation, Program, Read, Result


def _signatures() -> Iterator[tuple[str, tuple[tuple[str, ...], str]]]:
    for operations, arguments, type_ in (
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
    ):
        yield from ((operation, (arguments, type_)) for operation in operations.split())


SIGNATURES: Mapping[str, tuple[tuple[str, ...], str]] = dict(_signatures())
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

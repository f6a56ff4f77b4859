"""Programs put together of operations and of other programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from eddi_scaffold.compiling.program.instructions import Operation, Program, Read, Result


class Builder:
    """A program in the making; equal reads are one."""

    def __init__(self) -> None:
        self._reads: dict[Read, int] = {}
        self._operations: list[Operation] = []

    def add(self, one: Operation) -> int:
        """Add an operation; return its number."""
        self._operations.append(one)
        return len(self._operations) - 1

    def append(self, program: Program, given: Mapping[int, int] | None = None) -> list[int]:
        """Add the operations of a program; return the new number of each.

        Args:
            program: what is added.
            given: what it reads -> the operation here that gives that.
        """
        given = given or {}
        numbers = {
            k: self._reads.setdefault(read, len(self._reads))
            for k, read in enumerate(program.reads)
            if k not in given
        }
        places: list[int] = []
        for operation in program.operations:
            if operation.op == "variable" and operation.value in given:
                places.append(given[operation.value])
                continue
            value = (
                numbers[operation.value] if operation.op in ("variable", "age") else operation.value
            )
            args = tuple(places[k] for k in operation.args)
            places.append(self.add(operation._replace(args=args, value=value)))
        return places

    def program(self, period: int, results: Sequence[Result]) -> Program:
        """Return the program."""
        return Program(period, tuple(self._reads), tuple(self._operations), tuple(results))

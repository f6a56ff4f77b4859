"""Events in this process: a program, compiled once, stepped with raw values.

Time is passed in. Memory is fixed when the engine is built; a step costs the same whatever the
length of the windows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from eddi_scaffold.compiling.execution import module_of
from eddi_scaffold.compiling.expressions.form import read_form
from eddi_scaffold.compiling.program.instructions import Program
from eddi_scaffold.compiling.program.python import Printer, names_of, stamp_name
from eddi_scaffold.compiling.program.sampling import Sampling
from eddi_scaffold.compiling.text import assignment, tuple_of, unpacked

Values = tuple[float | int, ...]
"""One value per output: 0, 1, 2 for a truth value, NaN for an UNKNOWN number."""
_HEAD = [
    "from eddi_runtime import expressions",
    "from eddi_runtime.expressions import hold, lists, stacks, window, windows",
    "",
    'INF = float("inf")',
    'NAN = float("nan")',
]


class Engine:
    """A compiled program. Not thread-safe.

    Attributes:
        program: what was compiled.
        sampling: what a step is given.
    """

    def __init__(self, program: Program) -> None:
        self.program = program
        self.sampling = Sampling(program)
        self._machine: Any = module_of("\n".join([*_HEAD, *_lines(program)]), "event").Engine()

    def step(
        self, t: int, values: Sequence[Any], stamps: Sequence[int | None] | None = None
    ) -> Values:
        """Evaluate once; never raises, whatever the values are.

        Args:
            t: nanoseconds, by any clock that the caller keeps to. The same time again: the step is
                ignored. An earlier one: the clock went back, all is forgotten first.
            values: one per input of ``sampling``; None, NaN and what is of a wrong type are
                UNKNOWN.
            stamps: when each was sampled, by the same clock; None: now.
        """
        known = [t] * len(values) if stamps is None else [t if s is None else s for s in stamps]
        found: Values = self._machine.step(t, values, known)
        return found

    def reset(self) -> None:
        """Forget everything of former steps."""
        self._machine.restart()

    @property
    def overflows(self) -> int:
        """How many samples were dropped because the host steps too often."""
        return sum(window.overflows for window in self._machine.windows)


def build_engine(document: Mapping[str, Any]) -> Engine:
    """Compile checked conditions."""
    return Engine(read_form(document))


def _lines(program: Program) -> list[str]:
    sampling = Sampling(program)
    inputs, names = names_of(program, sampling)
    printer = Printer(program, names)
    lines = ["class Engine(expressions.Conditions):", *printer.members(), ""]
    lines += ["    def step(self, t, values, stamps):", *unpacked(inputs, "values")]
    for k, (read, used) in enumerate(zip(program.reads, sampling.uses, strict=True)):
        if read.reduction is not None:
            raws = tuple_of(inputs[one] for one in used)
            lines += assignment("raw", raws, 8)
            lines += [f"        {names[k]}, _ = expressions.reduced(self.reduce_{k}, raw)"]
        elif names[k] != inputs[used[0]]:
            lines += [f"        {names[k]} = {inputs[used[0]]}"]
        if read.stamped:
            lines += [f"        {stamp_name(names[k])} = stamps[{used[0]}]"]
    return [*lines, *printer.evaluation(raw=True)]

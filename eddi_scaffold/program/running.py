"""Compiled text in this process: a package's module, and conditions stepped with raw values."""

from __future__ import annotations

import linecache
from collections.abc import Callable, Sequence
from importlib.abc import Loader
from importlib.machinery import ModuleSpec
from pathlib import PurePath
from types import ModuleType
from typing import Any

from eddi_scaffold.program.instructions import Program, Sampling
from eddi_scaffold.program.python_step import Printer, names_of, stamp_name
from eddi_scaffold.program.python_text import assignment, tuple_of, unpacked

Values = tuple[float | int, ...]
"""One value per output: 0, 1, 2 for a truth value, NaN for an UNKNOWN number."""
_NAME = "compiled"
_HEAD = """\
from eddi_runtime import expressions
from eddi_runtime.expressions import hold, lists, stacks, window, windows

INF = float("inf")
NAN = float("nan")
"""


class _Files(Loader):
    """Gives a module in memory its data files, as loaders of files do (PEP 302)."""

    def __init__(self, data: Callable[[str], bytes]) -> None:
        self._data = data

    def get_data(self, path: str) -> bytes:
        """Return the bytes of a file next to the module."""
        return self._data(PurePath(path).name)


def _no_data(name: str) -> bytes:
    raise FileNotFoundError(name)


def module_of(text: str, model_id: str, data: Callable[[str], bytes] = _no_data) -> ModuleType:
    """Return the module of a compiled text; tracebacks and debuggers show its lines."""
    name = f"<{model_id}>/compiled.py".replace("\0", "?")  # which no name of a file may hold
    linecache.cache[name] = (len(text), None, text.splitlines(keepends=True), name)
    module = ModuleType(_NAME)
    module.__file__ = name
    module.__spec__ = ModuleSpec(_NAME, _Files(data), origin=name)
    exec(compile(text, name, "exec"), vars(module))  # noqa: S102 - our own text, in the generator
    return module


class Engine:
    """A compiled program. Not thread-safe.

    Memory is fixed when it is built; a step costs the same whatever the length of the windows.
    """

    def __init__(self, program: Program) -> None:
        self.program = program
        self.sampling = Sampling(program)
        text = "\n".join([_HEAD, *_lines(program, self.sampling)])
        self._machine: Any = module_of(text, "event").Engine()

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
        results: Values = self._machine.step(t, values, known)
        return results

    def reset(self) -> None:
        """Forget everything of former steps."""
        self._machine.restart()


def _lines(program: Program, sampling: Sampling) -> list[str]:
    inputs, names = names_of(program, sampling)
    printer = Printer(program, names)
    lines = ["class Engine(expressions.Conditions):", *printer.members(), ""]
    lines += ["    def step(self, t, values, stamps):", *unpacked(inputs, "values")]
    for k, (read, used) in enumerate(zip(program.reads, sampling.uses, strict=True)):
        if read.reduction is not None:
            lines += assignment("raw", tuple_of(inputs[use] for use in used), 8)
            lines += [f"        {names[k]}, _ = expressions.reduced(self.reduce_{k}, raw)"]
        elif names[k] != inputs[used[0]]:
            lines += [f"        {names[k]} = {inputs[used[0]]}"]
        if read.stamped:
            lines += [f"        {stamp_name(names[k])} = stamps[{used[0]}]"]
    return [*lines, *printer.evaluation(raw=True)]

"""Events in this process: a form, compiled once, stepped with raw values.

Time is passed in. Memory is fixed when the engine is built; a step costs the same whatever the
length of the windows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from eddi_scaffold.compiling.execution import module_of
from eddi_scaffold.compiling.expressions.form import Form, read_form
from eddi_scaffold.compiling.expressions.sampling import Sampling
from eddi_scaffold.compiling.expressions.source import Source, names_of, stamp_name
from eddi_scaffold.compiling.text import assignment, tuple_of, unpacked

Values = tuple[float | int, ...]
"""One value per output: 0, 1, 2 for a truth value, NaN for an UNKNOWN number."""
_HEAD = [
    "from eddi_runtime import expressions",
    "from eddi_runtime.expressions import lists, stacks, windows",
    "",
    'INF = float("inf")',
    'NAN = float("nan")',
]


class Engine:
    """A compiled form. Not thread-safe.

    Attributes:
        form: what was compiled.
        sampling: what a step is given.
    """

    def __init__(self, form: Form) -> None:
        self.form = form
        self.sampling = Sampling(form)
        self._machine: Any = module_of("\n".join([*_HEAD, *_lines(form)]), "event").Engine()

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
    """Compile an intermediate form, as ``json`` gives it.

    Raises:
        ModelError: the form is damaged.
    """
    return Engine(read_form(document))


def _lines(form: Form) -> list[str]:
    sampling = Sampling(form)
    inputs, names = names_of(form, sampling)
    source = Source(form, names)
    lines = ["class Engine(expressions.Conditions):", *source.members(), ""]
    lines += [
        "    def step(self, t, values, stamps):",
        *(unpacked(inputs, "values") if inputs else []),
    ]
    for k, (variable, used) in enumerate(zip(form.variables, sampling.uses, strict=True)):
        if variable.reduction is not None:
            raws = tuple_of(inputs[one] for one in used)
            lines += assignment("raw", raws, 8)
            lines += [f"        {names[k]}, _ = expressions.reduced(self.reduce_{k}, raw)"]
        elif names[k] != inputs[used[0]]:
            lines += [f"        {names[k]} = {inputs[used[0]]}"]
        if variable.stamped:
            lines += [f"        {stamp_name(names[k])} = stamps[{used[0]}]"]
    return [*lines, *source.evaluation(raw=True)]

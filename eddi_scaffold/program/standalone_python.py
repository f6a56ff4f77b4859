"""Monitors in one Python module with SESAME D7.2's four parts, standard library only."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable
from functools import cache
from importlib.resources import files

from eddi_runtime.expressions import (
    Conditions,
    Unknown,
    hold,
    lists,
    reduced,
    stacks,
    window,
    windows,
)

from eddi_scaffold.common.escaping import python_literal
from eddi_scaffold.program.instructions import BUFFERED, WINDOWS, Read
from eddi_scaffold.program.python_step import CLASSES, class_lines
from eddi_scaffold.program.standalone import HEADER, StandaloneMonitor, region
from eddi_scaffold.program.three_valued import BoolVal, NumVal

_NOQA = re.compile(r"\s*# noqa.*$", re.MULTILINE)
_MODULES = {
    module.__name__.rpartition(".")[2]: module for module in (hold, window, windows, stacks)
}
"""In the order of the library: a base class comes first."""
_TYPES = {"number": "NumVal", "bool": "BoolVal", "enum": "str", "text": "str"}


def python_module(model: StandaloneMonitor) -> dict[str, str]:
    """Return file name -> text of the monitor's module."""
    parts = (_head(model), _variables(model), _functions(model), _types(), _main(model))
    return {f"{model.name}_event.py": "\n".join(parts)}


def _head(model: StandaloneMonitor) -> str:
    source = "".join(f"    {line}".rstrip() + "\n" for line in model.source[:200])
    more = {"Sequence", "Union"} if _needs_lists(model) else set()
    names = ", ".join(sorted({"Any", "Callable", "Deque", "List", "Optional", "Tuple"} | more))
    return f'''"""Monitor of events, {HEADER}; edit between the markers only.

{source}
Step it at its rate: Monitor().step(t_ns). Several monitors may live side by side.
"""

from __future__ import annotations

import math
import time
from bisect import bisect_left, insort
from collections import deque
from typing import {names}

PERIOD_NS = {model.program.period}
NEVER = -(1 << 64)
INF = math.inf
NAN = math.nan

'''


def _title(number: int, name: str) -> str:
    return f"# {'-' * 20} {number}. {name} {'-' * 20}\n\n\n"


def _variables(model: StandaloneMonitor) -> str:
    methods = []
    for argument in model.arguments:
        name, kind = argument.input.name, argument.input.type
        returns = "Sequence" if argument.input.list else _TYPES[kind]
        methods += ["", f"    def read_{argument.name}(self) -> {returns}:"]
        methods += [f'        """Return {argument.description}.', ""]
        methods += ["        None, NaN and what is of a wrong type are UNKNOWN."]
        if argument.stamped:
            methods += ["        (value, t_ns) gives the time of the sample; without it: now."]
        methods += ['        """']
        body = [f"        raise NotImplementedError({python_literal(name)})"]
        methods += region(f"variable:{name}", body, indent="        ")
    pairs = zip(model.events, model.program.results, strict=True)
    for event, result in () if model.numeric else pairs:
        for what in ("raised", "cleared"):
            methods += ["", f"    def on_{what}_{event}(self, t_ns: int) -> None:"]
            methods += [f'        """Called when the event {result.id} is {what}."""']
            methods += region(f"{what}:{result.id}", ["        pass"], indent="        ")
    lines = methods or ["", "    __slots__ = ()"]
    return f'''{_title(1, "Variables")}class Variables:
    """Where the values come from; each is read once in a step."""
{_text(lines)}'''


def _functions(model: StandaloneMonitor) -> str:
    used: set[type] = set()
    for operation in model.program.operations:
        if operation.op in WINDOWS:
            module, _, name = CLASSES[operation.op].partition(".")
            used.update(getattr(_MODULES[module], name).__mro__[:-1])
        if operation.op in BUFFERED and operation.coverage is not None:
            used.add(window.Covered)
    places = [module.__name__ for module in _MODULES.values()]
    order = sorted(used, key=lambda cls: (places.index(cls.__module__), _line(cls)))
    parts: list[str] = []
    if _needs_lists(model):  # the module of lists, without its head
        text = _NOQA.sub("", inspect.getsource(lists))
        begin = re.search(r"(?m)^MAX_", text)
        assert begin is not None
        parts = [_source(Unknown), _source(reduced), text[begin.start() :].rstrip() + "\n"]
    parts += map(_source, (*order, Conditions))
    parts += [_text(class_lines(model.program, [f"v_{name}" for name in model.variables]))]
    return _title(2, "Functions") + "\n\n".join(parts)


def _types() -> str:
    return f"{_title(3, 'Types')}{_source(BoolVal)}\n\n{_source(NumVal)}"


def _main(model: StandaloneMonitor) -> str:
    unknown = f"        self.verdicts = {(1,) * len(model.events)!r}"
    returned = "the number, NaN for UNKNOWN" if model.numeric else "event -> BoolVal"
    readings, calls = _arguments(model)
    results = ["        return values[0]"]
    if not model.numeric:
        results = ["        before, self.verdicts = self.verdicts, values"]
        for k, event in enumerate(model.events):
            results += [f"        if values[{k}] == 2 and before[{k}] != 2:"]
            results += [f"            self.on_raised_{event}(t_ns)"]
            results += [f"        elif before[{k}] == 2 and values[{k}] != 2:"]
            results += [f"            self.on_cleared_{event}(t_ns)"]
        results += ["        return {"]
        for k, result in enumerate(model.program.results):
            results += [f"            {python_literal(result.id)}: BoolVal.of(values[{k}]),"]
        results += ["        }"]
    conversions = f"{files(__package__).joinpath('conversions.txt').read_text('utf-8')}\n\n"
    if not model.has_lists:
        conversions = conversions.partition("def as_samples(")[0]
    return f'''{_title(4, "Main")}{conversions}class Monitor(Variables):
    """The monitor: reads the variables, evaluates, calls what is raised."""

    def __init__(self):
        self.engine = Engine()
        self.evaluate = self.engine.evaluate
{unknown}

    def reset(self):
        """Forget everything of former steps."""
        self.engine.restart()
{unknown}

    def step(self, t_ns=None):
        """Evaluate once at a time in nanoseconds, and return {returned}."""
        if t_ns is None:
            t_ns = time.monotonic_ns()
{_text(readings)}        values = self.evaluate(
            t_ns,
{_text(f"            {argument}," for argument in calls)}        )
{_text(results)}

def main():
    """Step at the rate until Ctrl-C."""
    monitor = Monitor()
    due = time.monotonic_ns()
    while True:
        print(monitor.step(due))
        due += {model.program.period or 10**9}
        time.sleep(max(0.0, (due - time.monotonic_ns()) / 1e9))


if __name__ == "__main__":
    main()
'''


def _arguments(model: StandaloneMonitor) -> tuple[list[str], list[str]]:
    """Return the lines that read what lists and stamps need, and the arguments of a step."""
    lines: list[str] = []
    calls: list[str] = []
    values = []
    for argument in model.arguments:
        name, value = argument.name, f"self.read_{argument.name}()"
        if argument.stamped:
            take = "as_samples" if argument.input.list else "as_sample"
            lines += [f"        value_{name}, stamp_{name} = {take}({value}, t_ns)"]
            value = f"value_{name}"
        elif model.has_lists:  # several reductions may read it
            lines += [f"        value_{name} = {value}"]
            value = f"value_{name}"
        values.append(value)
    reads = zip(model.variables, model.program.reads, model.sampling.uses, strict=True)
    for k, (name, read, uses) in enumerate(reads):
        value = values[uses[0]]
        if read.reduction is not None:
            # Lists as they are, numbers without NumVal.
            parts = "".join(
                f"as_number({values[use]}), "
                if not model.arguments[use].input.list
                and model.arguments[use].input.type == "number"
                else f"{values[use]}, "
                for use in uses
            )
            called = f"reduced(self.engine.reduce_{k}, ({parts.rstrip()}))"
            lines += [f"        value_{name}, _ = {called}"]
            value = f"value_{name}"
        calls += [_conversion(read, value)]
        calls += [f"stamp_{model.arguments[uses[0]].name}"] if read.stamped else []
    return lines, calls


def _conversion(read: Read, value: str) -> str:
    if read.text:
        return f"number_in({value})"
    if read.type == "enum":
        return f"as_literal({value}, {read.literals!r})"
    return f"as_{'number' if read.type == 'number' else 'truth'}({value})"


def _needs_lists(model: StandaloneMonitor) -> bool:
    texts = any(read.text for read in model.program.reads)
    return (
        model.has_lists
        or texts
        or any(operation.op == "sqrt" for operation in model.program.operations)
    )


def _text(lines: Iterable[str]) -> str:
    return "".join(f"{line}\n" for line in lines)


@cache
def _line(cls: type) -> int:
    return inspect.getsourcelines(cls)[1]


@cache
def _source(cls: Callable[..., object]) -> str:
    return _NOQA.sub("", inspect.getsource(cls)).rstrip() + "\n"

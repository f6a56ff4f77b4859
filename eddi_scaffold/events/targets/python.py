"""Target ``python``: one module with SESAME D7.2's four parts, standard library only."""

from __future__ import annotations

import inspect
import re

from eddi_runtime.event import stacks, values, windows
from eddi_runtime.event.form import BUFFERED, WINDOWS
from eddi_runtime.event.source import CLASSES, class_lines

from eddi_scaffold.events.targets.monitor_model import MonitorModel, describe
from eddi_scaffold.events.targets.regions import HEADER, region

_NOQA = re.compile(r"\s*# noqa.*$", re.MULTILINE)
_KIND = {"number": "NumVal", "bool": "BoolVal", "enum": "str"}


def python_module(model: MonitorModel) -> dict[str, str]:
    """Return file name -> text of the monitor's module."""
    parts = [_head(model), _variables(model), _functions(model), _types(), _main(model)]
    return {f"{model.name}_event.py": "\n\n".join("\n".join(part) for part in parts) + "\n"}


def _head(model: MonitorModel) -> list[str]:
    shown = [f"    {line}" for line in model.source[:200]]
    return [
        f'"""Monitor of events, {HEADER}; edit between the markers only.',
        "",
        *(line.rstrip() for line in shown),
        "",
        "Step it at its rate: Monitor().step(t_ns). Several monitors may live side by side.",
        '"""',
        "",
        "from __future__ import annotations",
        "",
        "import math",
        "import time",
        "from bisect import bisect_left, insort",
        "from collections import deque",
        "from typing import Any, Callable, Deque, List, Optional, Tuple",
        "",
        f"PERIOD_NS = {model.form.period}",
        "NEVER = -(1 << 64)",
        "nan = math.nan",
        "",
    ]


def _title(number: int, name: str) -> list[str]:
    return [f"# {'-' * 20} {number}. {name} {'-' * 20}", "", ""]


def _variables(model: MonitorModel) -> list[str]:
    lines = _title(1, "Variables")
    lines += [
        "class Variables:",
        '    """Where the values come from; each is read once in a step."""',
    ]
    for k, name in enumerate(model.variables):
        variable = model.form.variables[k]
        kind = _KIND[variable.type]
        lines += ["", f"    def read_{name}(self) -> {kind}:"]
        lines += [f'        """Return {describe(model, k)}.', ""]
        lines += ["        None, NaN and what is of a wrong type are UNKNOWN."]
        if variable.stamped:
            lines += ["        (value, t_ns) says when it was sampled; without it: now."]
        lines += ['        """']
        body = [f"raise NotImplementedError({variable.name!a})"]
        body = [f"        {line}" for line in body]
        lines += region(f"variable:{variable.name}", body, indent="        ")
    for k, name in enumerate(model.events if not model.numeric else ()):
        event = model.form.outputs[k]
        for what in ("raised", "cleared"):
            lines += ["", f"    def on_{what}_{name}(self, t_ns: int) -> None:"]
            lines += [f'        """Called when the event {event.id} is {what}."""']
            lines += region(f"{what}:{event.id}", ["        pass"], indent="        ")
    if len(lines) == 5:
        lines += ["", "    __slots__ = ()"]
    return lines


def _functions(model: MonitorModel) -> list[str]:
    used: dict[type, None] = {}
    for node in model.form.nodes:
        if node.op in WINDOWS:
            name = CLASSES[node.op]
            found = getattr(windows, name, None) or getattr(stacks, name)
            used.update(dict.fromkeys(reversed(found.__mro__[:-1])))
        if node.op in BUFFERED and node.coverage is not None:
            used[windows.Covered] = None
    # As they stand in the library: a base class comes first.
    order = sorted(used, key=lambda cls: (cls.__module__ == stacks.__name__, _line(cls)))
    lines = _title(2, "Functions")
    for cls in order:
        lines += [*_source(cls), "", ""]
    arguments = [f"v_{name}" for name in model.variables]
    lines += class_lines(model.form, "Engine", arguments)
    return lines


def _types() -> list[str]:
    lines = _title(3, "Types")
    return [*lines, *_source(values.BoolVal), "", "", *_source(values.NumVal)]


def _line(cls: type) -> int:
    return inspect.getsourcelines(cls)[1]


def _source(cls: type) -> list[str]:
    return _NOQA.sub("", inspect.getsource(cls)).rstrip().split("\n")


_CONVERSIONS = '''\
def as_number(value):
    """Return a number, NaN for UNKNOWN."""
    if isinstance(value, NumVal):
        return value.number
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return nan
    try:
        return float(value)
    except OverflowError:
        return nan


def as_truth(value):
    """Return 0, 1 or 2."""
    if isinstance(value, BoolVal):
        return value.truth
    return (2 if value else 0) if isinstance(value, bool) else 1


def as_literal(value, literals):
    """Return the number of a literal, -1 for UNKNOWN."""
    return literals.index(value) if isinstance(value, str) and value in literals else -1


def as_sample(value, t_ns):
    """Return a value and when it was sampled."""
    if isinstance(value, tuple) and len(value) == 2:
        return value[0], t_ns if value[1] is None else value[1]
    return value, t_ns
'''


def _main(model: MonitorModel) -> list[str]:
    lines = [*_title(4, "Main"), *_CONVERSIONS.split("\n"), ""]
    lines += ["class Monitor(Variables):"]
    lines += ['    """The monitor: reads the variables, evaluates, calls what is raised."""', ""]
    lines += ["    def __init__(self):", "        self.engine = Engine()"]
    lines += ["        self.evaluate = self.engine.evaluate"]
    lines += [f"        self.verdicts = {tuple(1 for _ in model.events)!r}", ""]
    lines += ["    def reset(self):", '        """Forget everything of former steps."""']
    lines += ["        self.engine.reset()"]
    lines += [f"        self.verdicts = {tuple(1 for _ in model.events)!r}", ""]
    lines += ["    def step(self, t_ns=None):"]
    result = "the number, NaN for UNKNOWN" if model.numeric else "event -> BoolVal"
    lines += [f'        """Evaluate once at a time in nanoseconds, and return {result}."""']
    lines += ["        if t_ns is None:", "            t_ns = time.monotonic_ns()"]
    calls = []
    for k, name in enumerate(model.variables):
        variable = model.form.variables[k]
        value = f"self.read_{name}()"
        if variable.stamped:
            lines += [f"        value_{name}, stamp_{name} = as_sample({value}, t_ns)"]
            value = f"value_{name}"
        calls.append(_conversion(variable.type, value, variable.literals))
        calls += [f"stamp_{name}"] if variable.stamped else []
    lines += ["        values = self.evaluate(", "            t_ns,"]
    lines += [f"            {call}," for call in calls] + ["        )"]
    lines += _results(model)
    lines += ["", "", "def main():", '    """Step at the rate until Ctrl-C."""']
    period = model.form.period or 10**9
    lines += ["    monitor = Monitor()", "    due = time.monotonic_ns()", "    while True:"]
    lines += ["        print(monitor.step(due))", f"        due += {period}"]
    lines += ["        time.sleep(max(0.0, (due - time.monotonic_ns()) / 1e9))"]
    lines += ["", "", 'if __name__ == "__main__":', "    main()"]
    return lines


def _conversion(kind: str, value: str, literals: tuple[str, ...]) -> str:
    if kind == "enum":
        return f"as_literal({value}, {literals!r})"
    return f"as_{'number' if kind == 'number' else 'truth'}({value})"


def _results(model: MonitorModel) -> list[str]:
    if model.numeric:
        return ["        return values[0]"]
    lines = ["        before, self.verdicts = self.verdicts, values"]
    for k, name in enumerate(model.events):
        lines += [f"        if values[{k}] == 2 and before[{k}] != 2:"]
        lines += [f"            self.on_raised_{name}(t_ns)"]
        lines += [f"        elif before[{k}] == 2 and values[{k}] != 2:"]
        lines += [f"            self.on_cleared_{name}(t_ns)"]
    lines += ["        return {"]
    for k, output in enumerate(model.form.outputs):
        lines += [f"            {output.id!a}: BoolVal.of(values[{k}]),"]
    return [*lines, "        }"]

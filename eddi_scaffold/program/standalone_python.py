"""Target ``python``: one module with SESAME D7.2's four parts, standard library only."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from functools import cache

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
from eddi_scaffold.program import three_valued
from eddi_scaffold.program.instructions import BUFFERED, WINDOWS, Read
from eddi_scaffold.program.kept_bodies import HEADER, region
from eddi_scaffold.program.python_step import CLASSES, class_lines
from eddi_scaffold.program.standalone import HostArgument, StandaloneMonitor

_NOQA = re.compile(r"\s*# noqa.*$", re.MULTILINE)
_MODULES = {"hold": hold, "stacks": stacks, "windows": windows}
_KIND = {"number": "NumVal", "bool": "BoolVal", "enum": "str", "text": "str"}


def python_module(model: StandaloneMonitor) -> dict[str, str]:
    """Return file name -> text of the monitor's module."""
    parts = [_head(model), _variables(model), _functions(model), _types(), _main(model)]
    return {f"{model.name}_event.py": "\n\n".join("\n".join(part) for part in parts) + "\n"}


def _head(model: StandaloneMonitor) -> list[str]:
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
        f"from typing import {', '.join(_typing(model))}",
        "",
        f"PERIOD_NS = {model.program.period}",
        "NEVER = -(1 << 64)",
        "INF = math.inf",
        "NAN = math.nan",
        "",
    ]


def _typing(model: StandaloneMonitor) -> list[str]:
    names = {"Any", "Callable", "Deque", "List", "Optional", "Tuple"}
    more = {"Sequence", "Union"} if _needs_lists(model) else set()
    return sorted(names | more)


def _title(number: int, name: str) -> list[str]:
    return [f"# {'-' * 20} {number}. {name} {'-' * 20}", "", ""]


def _variables(model: StandaloneMonitor) -> list[str]:
    lines = _title(1, "Variables")
    lines += [
        "class Variables:",
        '    """Where the values come from; each is read once in a step."""',
    ]
    for one in model.given:
        kind = "Sequence" if one.input.list else _KIND[one.input.type]
        lines += ["", f"    def read_{one.word}(self) -> {kind}:"]
        lines += [f'        """Return {one.description}.', ""]
        lines += ["        None, NaN and what is of a wrong type are UNKNOWN."]
        if one.stamped:
            lines += ["        (value, t_ns) gives the time of the sample; without it: now."]
        lines += ['        """']
        body = [f"        raise NotImplementedError({python_literal(one.input.name)})"]
        lines += region(f"variable:{one.input.name}", body, indent="        ")
    for k, name in enumerate(model.events if not model.numeric else ()):
        event = model.program.results[k]
        for what in ("raised", "cleared"):
            lines += ["", f"    def on_{what}_{name}(self, t_ns: int) -> None:"]
            lines += [f'        """Called when the event {event.id} is {what}."""']
            lines += region(f"{what}:{event.id}", ["        pass"], indent="        ")
    if len(lines) == 5:
        lines += ["", "    __slots__ = ()"]
    return lines


def _functions(model: StandaloneMonitor) -> list[str]:
    used: dict[type, None] = {}
    for node in model.program.operations:
        if node.op in WINDOWS:
            module, _, name = CLASSES[node.op].partition(".")
            found = getattr(_MODULES[module], name)
            used.update(dict.fromkeys(reversed(found.__mro__[:-1])))
        if node.op in BUFFERED and node.coverage is not None:
            used[window.Covered] = None
    # In the order of the library: a base class comes first.
    places = [module.__name__ for module in (hold, window, windows, stacks)]
    order = sorted(used, key=lambda cls: (places.index(cls.__module__), _line(cls)))
    lines = _title(2, "Functions")
    if _needs_lists(model):
        lines += [*_lists(), "", ""]
    for cls in (*order, Conditions):
        lines += [*_source(cls), "", ""]
    arguments = [f"v_{name}" for name in model.variables]
    lines += class_lines(model.program, arguments)
    return lines


def _needs_lists(model: StandaloneMonitor) -> bool:
    texts = any(variable.text for variable in model.program.reads)
    return model.has_lists or texts or any(node.op == "sqrt" for node in model.program.operations)


def _lists() -> list[str]:
    """Return the module of lists, without its head."""
    lines = _NOQA.sub("", inspect.getsource(lists)).rstrip().split("\n")
    begin = next(k for k, line in enumerate(lines) if line.startswith("MAX_"))
    return [*_source(Unknown), "", "", *_source(reduced), "", "", *lines[begin:]]


def _types() -> list[str]:
    lines = _title(3, "Types")
    return [*lines, *_source(three_valued.BoolVal), "", "", *_source(three_valued.NumVal)]


@cache
def _line(cls: type) -> int:
    return inspect.getsourcelines(cls)[1]


@cache
def _source(cls: Callable[..., object]) -> tuple[str, ...]:
    return tuple(_NOQA.sub("", inspect.getsource(cls)).rstrip().split("\n"))


_CONVERSIONS = '''\
def as_number(value):
    """Return a number, NaN for UNKNOWN."""
    if isinstance(value, NumVal):
        return value.number
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return NAN
    try:
        return float(value)
    except OverflowError:
        return NAN


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


_SAMPLES = '''

def as_samples(values, t_ns):
    """Return a list and when it was sampled."""
    if isinstance(values, tuple) and len(values) == 2 and hasattr(values[0], "__len__"):
        return values[0], t_ns if values[1] is None else values[1]
    return values, t_ns
'''


def _main(model: StandaloneMonitor) -> list[str]:
    conversions = _CONVERSIONS + (_SAMPLES if model.has_lists else "")
    lines = [*_title(4, "Main"), *conversions.split("\n"), ""]
    lines += ["class Monitor(Variables):"]
    lines += ['    """The monitor: reads the variables, evaluates, calls what is raised."""', ""]
    lines += ["    def __init__(self):", "        self.engine = Engine()"]
    lines += ["        self.evaluate = self.engine.evaluate"]
    lines += [f"        self.verdicts = {tuple(1 for _ in model.events)!r}", ""]
    lines += ["    def reset(self):", '        """Forget everything of former steps."""']
    lines += ["        self.engine.restart()"]
    lines += [f"        self.verdicts = {tuple(1 for _ in model.events)!r}", ""]
    lines += ["    def step(self, t_ns=None):"]
    result = "the number, NaN for UNKNOWN" if model.numeric else "event -> BoolVal"
    lines += [f'        """Evaluate once at a time in nanoseconds, and return {result}."""']
    lines += ["        if t_ns is None:", "            t_ns = time.monotonic_ns()"]
    more, calls = _arguments(model)
    lines += more
    lines += ["        values = self.evaluate(", "            t_ns,"]
    lines += [f"            {call}," for call in calls] + ["        )"]
    lines += _results(model)
    lines += ["", "", "def main():", '    """Step at the rate until Ctrl-C."""']
    period = model.program.period or 10**9
    lines += ["    monitor = Monitor()", "    due = time.monotonic_ns()", "    while True:"]
    lines += ["        print(monitor.step(due))", f"        due += {period}"]
    lines += ["        time.sleep(max(0.0, (due - time.monotonic_ns()) / 1e9))"]
    lines += ["", "", 'if __name__ == "__main__":', "    main()"]
    return lines


def _arguments(model: StandaloneMonitor) -> tuple[list[str], list[str]]:
    """Return the lines that read what lists and stamps need, and the arguments of a step."""
    lines: list[str] = []
    calls: list[str] = []
    three_valued = {}
    for one in model.given:
        word, value = one.word, f"self.read_{one.word}()"
        if one.stamped:
            take = "as_samples" if one.input.list else "as_sample"
            lines += [f"        value_{word}, stamp_{word} = {take}({value}, t_ns)"]
            value = f"value_{word}"
        elif model.has_lists:  # several reductions may read it
            lines += [f"        value_{word} = {value}"]
            value = f"value_{word}"
        three_valued[word] = value
    for k, name in enumerate(model.variables):
        variable = model.program.reads[k]
        used = [model.given[number] for number in model.sampling.uses[k]]
        value = three_valued[used[0].word]
        if variable.reduction is not None:
            parts = "".join(f"{_part(one, three_valued[one.word])}, " for one in used)
            called = f"reduced(self.engine.reduce_{k}, ({parts.rstrip()}))"
            lines += [f"        value_{name}, _ = {called}"]
            value = f"value_{name}"
        calls.append(_conversion(variable, value))
        calls += [f"stamp_{used[0].word}"] if variable.stamped else []
    return lines, calls


def _part(one: HostArgument, value: str) -> str:
    """Return what a reduction takes: lists as they are, numbers without NumVal."""
    return f"as_number({value})" if not one.input.list and one.input.type == "number" else value


def _conversion(variable: Read, value: str) -> str:
    if variable.text:
        return f"number_in({value})"
    if variable.type == "enum":
        return f"as_literal({value}, {variable.literals!r})"
    return f"as_{'number' if variable.type == 'number' else 'truth'}({value})"


def _results(model: StandaloneMonitor) -> list[str]:
    if model.numeric:
        return ["        return values[0]"]
    lines = ["        before, self.verdicts = self.verdicts, values"]
    for k, name in enumerate(model.events):
        lines += [f"        if values[{k}] == 2 and before[{k}] != 2:"]
        lines += [f"            self.on_raised_{name}(t_ns)"]
        lines += [f"        elif before[{k}] == 2 and values[{k}] != 2:"]
        lines += [f"            self.on_cleared_{name}(t_ns)"]
    lines += ["        return {"]
    for k, output in enumerate(model.program.results):
        lines += [f"            {python_literal(output.id)}: BoolVal.of(values[{k}]),"]
    return [*lines, "        }"]

"""Monitors in one Python module with SESAME D7.2's four parts, standard library only."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable
from functools import cache
from importlib.resources import files
from string import Template

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

_NOQA = re.compile(r"\s*# noqa.*$", re.MULTILINE)
_MODULES = {
    module.__name__.rpartition(".")[2]: module for module in (hold, window, windows, stacks)
}
"""In the order of the library: a base class comes first."""
_TYPES = {"number": "NumVal", "bool": "BoolVal", "enum": "str", "text": "str"}


def python_module(model: StandaloneMonitor) -> dict[str, str]:
    """Return file name -> text of the monitor's module."""
    template = files(__package__).joinpath("module.txt").read_text("utf-8")
    if not model.has_lists:
        template = re.sub(r"(?s)def as_samples\(.*?\n\n\n", "", template)
    more = {"Sequence", "Union"} if _needs_lists(model) else set()
    names = sorted({"Any", "Callable", "Deque", "List", "Optional", "Tuple"} | more)
    readings, calls = _arguments(model)
    text = Template(template).substitute(
        header=HEADER,
        source=_text(f"    {line}".rstrip() for line in model.source[:200]),
        names=", ".join(names),
        period=model.program.period,
        variables=_text(_variables(model)),
        functions=_functions(model),
        unknown=repr((1,) * len(model.events)),
        returned="the number, NaN for UNKNOWN" if model.numeric else "event -> BoolVal",
        readings=_text(readings),
        arguments=_text(f"            {argument}," for argument in calls),
        results=_text(_results(model)),
        pause=model.program.period or 10**9,
    )
    return {f"{model.name}_event.py": text}


def _variables(model: StandaloneMonitor) -> list[str]:
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
    return methods or ["", "    __slots__ = ()"]


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
    return "\n\n".join(parts)


def _results(model: StandaloneMonitor) -> list[str]:
    if model.numeric:
        return ["        return values[0]"]
    results = ["        before, self.verdicts = self.verdicts, values"]
    for k, event in enumerate(model.events):
        results += [f"        if values[{k}] == 2 and before[{k}] != 2:"]
        results += [f"            self.on_raised_{event}(t_ns)"]
        results += [f"        elif before[{k}] == 2 and values[{k}] != 2:"]
        results += [f"            self.on_cleared_{event}(t_ns)"]
    results += ["        return {"]
    for k, result in enumerate(model.program.results):
        results += [f"            {python_literal(result.id)}: BoolVal.of(values[{k}]),"]
    return [*results, "        }"]


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
    if read.type == "enum":
        return f"as_literal({value}, {read.literals!r})"
    name = "as_number" if read.type == "number" else "as_truth"
    return f"{'number_in' if read.text else name}({value})"


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

"""Events in this process: an intermediate form, compiled once, stepped with raw values.

Time is passed in. Memory is fixed when the engine is built; a step costs the same whatever the
length of the windows.
"""

from __future__ import annotations

import math
from functools import partial
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

from ..plain_values import plain, show
from . import stacks, windows
from .elements import number_in
from .form import BOOL, NUMBER, Form, Variable, read_form
from .sampling import HostInput
from .source import class_lines

Values = Tuple[Union[float, int], ...]
"""One value per output: 0, 1, 2 for a truth value, NaN for an UNKNOWN number."""
_FAR_NS = 2**64
"""Farther in the future than any sample whose clock is a little ahead."""


class Engine:
    """A compiled form. Not thread-safe.

    Attributes:
        form: what was compiled.
        evaluate: the step without any conversion: time, then values (float with NaN; 0, 1, 2;
            number of the literal, -1) and, behind stamped ones, time stamps.
        step: ``step(t, values, stamps=None)``, one evaluation of raw values; never raises,
            whatever the values are. ``t``: nanoseconds, by any clock that the caller keeps to. The
            same time again: the step is ignored. An earlier one: the clock went back, all is
            forgotten first. ``values``: one per variable; None, NaN and what is of a wrong type
            are UNKNOWN. ``stamps``: when each value was sampled, by the same clock; None: now.
    """

    def __init__(self, form: Form) -> None:
        names: Dict[str, Any] = {**vars(windows), **vars(stacks), "stamp_of": _stamp_of}
        text = "\n".join([*class_lines(form), *_step_lines(form)])
        exec(compile(text, "<event>", "exec"), names)  # noqa: S102 - our own text, numbers only
        self.form = form
        self._machine = names["Engine"]()
        self.evaluate: Callable[..., Values] = self._machine.evaluate
        names["evaluate"] = self.evaluate
        names.update((f"c{k}", converter(variable)) for k, variable in enumerate(form.variables))
        self.step: Callable[..., Values] = names["step"]

    def reset(self) -> None:
        """Forget everything of former steps."""
        self._machine.reset()

    @property
    def overflows(self) -> int:
        """How many samples were dropped because the host steps too often."""
        return sum(window.overflows for window in self._machine.windows)


def _step_lines(form: Form) -> List[str]:
    """Return the function that converts raw values; a float needs no call."""
    lines, arguments = ["def step(t, values, stamps=None):"], ["t"]
    for k, variable in enumerate(form.variables):
        lines.append(f"    x{k} = values[{k}]")
        plain = variable.type == NUMBER and not variable.text
        quick = f"x{k} if type(x{k}) is float else " if plain else ""
        arguments.append(f"{quick}c{k}(x{k})")
        if variable.stamped:
            arguments.append(f"stamp_of(stamps, {k}, t)")
    return [*lines, f"    return evaluate({', '.join(arguments)})"]


def stamp_at(t: int, age: Optional[float]) -> Optional[int]:
    """Return when a sample of an age was made; None when that is not known, which counts as now.

    One that can be of any age lies in the future: behind no limit, and nothing is asked of it.
    """
    if age is None:
        return None
    return t - round(age * 1e9) if math.isfinite(age) else t + _FAR_NS


def _stamp_of(stamps: Optional[Sequence[Optional[int]]], k: int, t: int) -> int:
    stamp = None if stamps is None else stamps[k]
    return t if stamp is None else stamp


def build_engine(document: Mapping[str, Any]) -> Engine:
    """Compile an intermediate form, as ``json`` gives it.

    Raises:
        ModelError: the form is damaged.
    """
    return Engine(read_form(document))


def converter(variable: Variable) -> Callable[[object], Union[float, int]]:
    """Return the function that takes a raw value of a variable to ``evaluate``; never raises."""
    if variable.type == NUMBER:
        return number_in if variable.text else _number
    if variable.type == BOOL:
        return _truth
    return partial(_literal, {text: k for k, text in enumerate(variable.literals)})


def fault(one: HostInput, raw: object) -> str:
    """Return what is wrong with a raw value, empty when it is fine or simply missing."""
    if raw is None:
        return ""
    if one.list:
        is_list = hasattr(raw, "__len__") and not isinstance(raw, str)
        return "" if is_list else f"expected a list, got {show(raw)}"
    try:
        value = plain(raw)
    except Exception:  # noqa: BLE001 - a hostile object
        value = None
    if isinstance(value, float) and math.isnan(value):
        return ""
    if one.type == NUMBER and isinstance(value, (int, float)) and not isinstance(value, bool):
        return ""
    if one.type == BOOL and isinstance(value, bool):
        return ""
    if isinstance(value, str) and (one.type == "text" or value in one.literals):
        return ""
    wanted = {NUMBER: "a number", BOOL: "True or False", "text": "a text"}.get(one.type)
    return f"expected {wanted or ', '.join(one.literals)}, got {show(raw)}"


def _number(raw: object) -> float:
    try:
        value = plain(raw)
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            return float(value)
    except Exception:  # noqa: BLE001, S110 - a hostile object, or a number beyond any double
        pass
    return math.nan


def _truth(raw: object) -> int:
    if raw is True:
        return 2
    if raw is False:
        return 0
    try:
        value = plain(raw)
    except Exception:  # noqa: BLE001 - a hostile object
        return 1
    return (2 if value else 0) if isinstance(value, bool) else 1


def _literal(numbers: Mapping[str, int], raw: object) -> int:
    try:
        value = plain(raw)
    except Exception:  # noqa: BLE001 - a hostile object
        return -1
    return numbers.get(value, -1) if isinstance(value, str) else -1

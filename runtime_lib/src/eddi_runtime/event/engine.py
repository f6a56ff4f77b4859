"""Events in this process: an intermediate form, compiled once, stepped with raw values.

Time is passed in. Memory is fixed when the engine is built; a step costs the same whatever the
length of the windows.
"""

from __future__ import annotations

import math
from functools import partial
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

from ..plain_values import plain
from . import windows
from .form import BOOL, NUMBER, Form, Variable, read_form
from .source import class_lines

Values = Tuple[Union[float, int], ...]
"""One value per output: 0, 1, 2 for a truth value, NaN for an UNKNOWN number."""


class Engine:
    """A compiled form. Not thread-safe.

    Attributes:
        form: what was compiled.
        evaluate: the step without any conversion: time, then values (float with NaN; 0, 1, 2;
            number of the literal, -1) and, behind stamped ones, time stamps.
        faults: number of a variable -> type name of its last value, when that type is wrong.
    """

    def __init__(self, form: Form) -> None:
        names: Dict[str, Any] = {**vars(windows)}
        text = "\n".join(class_lines(form))
        exec(compile(text, "<event>", "exec"), names)  # noqa: S102 - our own text, numbers only
        self.form = form
        self._machine = names["Engine"]()
        self.evaluate: Callable[..., Values] = self._machine.evaluate
        self._convert = [converter(variable) for variable in form.variables]
        self._stamped = [variable.stamped for variable in form.variables]
        self._any_stamped = any(self._stamped)
        self.faults: Dict[int, str] = {}

    def step(
        self, t: int, values: Sequence[object], stamps: Sequence[Optional[int]] = ()
    ) -> Values:
        """Evaluate once; never raises, whatever the values are.

        Args:
            t: nanoseconds, by any clock that the caller keeps to. The same time again: the step
                is ignored. An earlier one: the clock went back, all is forgotten first.
            values: one per variable; None, NaN and what is of a wrong type are UNKNOWN.
            stamps: when each value was sampled, by the same clock; None or nothing: now.
        """
        if self.faults:
            self.faults = {}
        found: List[Any] = []
        for k, (convert, raw) in enumerate(zip(self._convert, values)):
            value, fault = convert(raw)
            if fault:
                self.faults[k] = type(raw).__name__
            found.append(value)
            if self._any_stamped and self._stamped[k]:
                stamp = stamps[k] if k < len(stamps) else None
                found.append(t if stamp is None else stamp)
        return self.evaluate(t, *found)

    def reset(self) -> None:
        """Forget everything of former steps."""
        self._machine.reset()

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


Converted = Tuple[Union[float, int], bool]
"""The value for ``evaluate``, and whether the raw value was of a wrong type."""


def converter(variable: Variable) -> Callable[[object], Converted]:
    """Return the function that takes a raw value of a variable; it never raises."""
    if variable.type == NUMBER:
        return _number
    if variable.type == BOOL:
        return _truth
    return partial(_literal, {text: k for k, text in enumerate(variable.literals)})


def _number(raw: object) -> Converted:
    if type(raw) is float:
        return raw, False
    if raw is None:
        return math.nan, False
    try:
        value = plain(raw)
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            return float(value), False
    except Exception:  # noqa: BLE001, S110 - a hostile object, or a number beyond any double
        pass
    return math.nan, True


def _truth(raw: object) -> Converted:
    if raw is True:
        return 2, False
    if raw is False:
        return 0, False
    if raw is None:
        return 1, False
    try:
        value = plain(raw)
    except Exception:  # noqa: BLE001 - a hostile object
        value = None
    if isinstance(value, bool):
        return (2 if value else 0), False
    # NaN stands for UNKNOWN in recordings of any type.
    return 1, not (isinstance(value, float) and math.isnan(value))


def _literal(numbers: Mapping[str, int], raw: object) -> Converted:
    if raw is None:
        return -1, False
    try:
        value = plain(raw)
    except Exception:  # noqa: BLE001 - a hostile object
        value = None
    if isinstance(value, str):
        return numbers.get(value, -1), value not in numbers
    return -1, not (isinstance(value, float) and math.isnan(value))

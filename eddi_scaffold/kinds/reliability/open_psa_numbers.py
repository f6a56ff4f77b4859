"""Probabilities of Open-PSA files: expressions of numbers and parameters, and laws over time."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Sequence
from typing import Any

from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.eddi_xml.parsing import Element, feature_of, line_of, select
from eddi_scaffold.kinds.reliability.system import Law

_UNITS = {"hours-1": 1.0, "years-1": 1.0 / 8760.0, "fit": 1e-9, "hours": 1.0, "years": 8760.0}
_NO_UNITS = ("", "bool", "int", "float", "demands")
_OPERATIONS: dict[str, Callable[[Sequence[float]], float]] = {
    "add": math.fsum,
    "sub": lambda of: of[0] - math.fsum(of[1:]),
    "mul": math.prod,
    "div": lambda of: of[0] / math.prod(of[1:]),
    "neg": lambda of: operator.neg(*of),
    "exp": lambda of: math.exp(*of),
    "pow": lambda of: math.pow(*of),
}
_MEANS: dict[str, Callable[[Sequence[float]], float]] = {
    "lognormal-deviate": lambda of: of[0] if len(of) == 3 else math.exp(of[0] + of[1] ** 2 / 2.0),
    "normal-deviate": lambda of: of[0],
    "uniform-deviate": lambda of: (of[0] + of[1]) / 2.0,
    "gamma-deviate": lambda of: of[0] * of[1],
    "beta-deviate": lambda of: of[0] / (of[0] + of[1]),
}
_MISSION = "system-mission-time"
_DEEPEST = 100


def arguments(element: Element) -> list[Element]:
    """Return what an element is made of, without its labels."""
    return [one for one in select(element, "*") if feature_of(one) not in ("label", "attributes")]


def place_of(element: Element, file: str) -> Place:
    """Return the place of an element."""
    return Place(file, line_of(element))


class Numbers:
    """Reads expressions of one file.

    Args:
        file: its name, for places.
        parameter: name of a parameter, and the containers around what names it -> its definition
            and the containers around that; None: there is none.
    """

    def __init__(
        self,
        file: str,
        parameter: Callable[[str, tuple[str, ...]], tuple[Element, tuple[str, ...]] | None],
    ) -> None:
        self._file, self._parameter = file, parameter
        self._known: dict[Element, float] = {}
        self._doubts: dict[str, Problem] = {}

    @property
    def doubts(self) -> list[Problem]:
        """What is assumed, once for the file (R004, R018)."""
        return list(self._doubts.values())

    def law(self, element: Element, path: tuple[str, ...], name: str, *, house: bool) -> Law | None:
        """Return the law of a basic event or a house event; None where nothing is given.

        Raises:
            EddiError: it cannot be read (R002, R012, R017).
        """
        parts = arguments(element)
        if len(parts) > 1:
            raise self._fault("R017.event", parts[1], name=name, number=len(parts))
        if house:
            is_true = [
                feature_of(part) == "constant" and part.get("value") == "true" for part in parts
            ]
            return Law("fixed", (float(is_true == [True]),))
        if not parts:
            return None
        of, values = feature_of(parts[0]).lower(), arguments(parts[0])
        times = self._missions(values[-1], path) if values else None
        if of == "exponential" and len(values) == 2:
            rate = self._not_negative(values[0], path)
            if times is not None:
                self._unit(values[0], path, "1/h")
                return Law("exponential", (rate * times,))
            time = self._not_negative(values[1], path)
            return Law("fixed", (-math.expm1(-rate * time),))
        if of == "weibull" and len(values) == 4 and times == 1.0:
            scale, shape, start = (self.number(value, path) for value in values[:3])
            if scale <= 0.0 or not 1e-6 <= shape <= 1e6 or start != 0.0:
                raise self._fault("R002.weibull", parts[0], name=name)
            self._unit(values[0], path, "h")
            return Law("weibull", (scale, shape))
        probability = self.number(parts[0], path)
        if not 0.0 <= probability <= 1.0:
            raise self._fault("R002.probability", parts[0], name=name, probability=probability)
        return Law("fixed", (probability,))

    def _missions(self, element: Element, path: tuple[str, ...]) -> float | None:
        """Return how many mission times an expression is, ``None`` where it is not so many."""
        parts = arguments(element) if feature_of(element) == "mul" else [element]
        others = [part for part in parts if feature_of(part) != _MISSION]
        if len(others) != len(parts) - 1:
            return None
        return math.prod(self._not_negative(other, path) for other in others)

    def number(self, element: Element, path: tuple[str, ...], depth: int = 0) -> float:
        """Return the value of an expression, in hours and 1/h where it has a unit.

        Raises:
            EddiError: it is no finite number that can be read (R001, R002, R012, R017).
        """
        of = feature_of(element)
        if depth > _DEEPEST:
            raise self._fault("R012.expressions", element)
        if of in ("float", "int"):
            return self._written(element)
        if of == "parameter":
            return self._of_parameter(element, path, depth)
        operation = _OPERATIONS.get(of) or _MEANS.get(of)
        if operation is None:
            raise EddiError(problem("R017.expression", place_of(element, self._file), type=of))
        if of in _MEANS:
            self._doubts.setdefault(
                of[-7:], problem("R018.deviates", place_of(element, self._file))
            )
        values = [self.number(argument, path, depth + 1) for argument in arguments(element)]
        try:
            found = operation(values)
        except (ArithmeticError, ValueError, IndexError, TypeError):
            found = math.nan
        if not math.isfinite(found):
            raise self._fault("R002.no_number", element, expression=of)
        return found

    def _written(self, element: Element) -> float:
        text = (element.get("value") or "").strip()
        try:
            found = float(text) if text.isascii() and "_" not in text else math.nan
        except ValueError:
            found = math.nan
        if not math.isfinite(found):
            raise self._fault("R002.number", element, value=text)
        return found

    def _of_parameter(self, element: Element, path: tuple[str, ...], depth: int) -> float:
        defined, within = self._definition(element, path)
        if defined not in self._known:
            parts, unit = arguments(defined), (defined.get("unit") or "").strip()
            if len(parts) != 1:
                raise self._fault("R017.parameter", defined, number=len(parts))
            if unit not in _UNITS and unit not in _NO_UNITS:
                place = place_of(defined, self._file)
                raise EddiError(
                    problem(
                        "R004.unit", place, unit=unit, known=", ".join([*_UNITS, *_NO_UNITS[1:]])
                    )
                )
            value = self.number(parts[0], within, depth + 1)
            self._known[defined] = value * _UNITS.get(unit, 1.0)
        return self._known[defined]

    def _definition(
        self, element: Element, path: tuple[str, ...]
    ) -> tuple[Element, tuple[str, ...]]:
        name = (element.get("name") or "").strip()
        found = self._parameter(name, path)
        if found is None:
            raise self._fault("R001.parameter", element, name=name)
        return found

    def _not_negative(self, element: Element, path: tuple[str, ...]) -> float:
        found = self.number(element, path)
        if found < 0.0:
            raise self._fault("R002.negative", element, value=found)
        return found

    def _unit(self, element: Element, path: tuple[str, ...], assumed: str) -> None:
        """Say once for the file that a unit is assumed (R004)."""
        is_named = feature_of(element) == "parameter"
        if is_named and self._definition(element, path)[0].get("unit") in _UNITS:
            return
        doubt = problem("R004.no_unit_in_file", place_of(element, self._file), assumed=assumed)
        self._doubts.setdefault("unit", doubt)

    def _fault(self, case: str, element: Element, /, **fields: Any) -> EddiError:
        return EddiError(problem(case, place_of(element, self._file), **fields))

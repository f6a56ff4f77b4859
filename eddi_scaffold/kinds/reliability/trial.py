"""Results of the runtime for a system at the start of the mission, with the code of the robot."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
from eddi_runtime.reliability import Reliability, ReliabilityResult

from eddi_scaffold.kinds.reliability.compile import compile_system
from eddi_scaffold.kinds.reliability.component_text import STATES_WRITTEN_OUT
from eddi_scaffold.kinds.reliability.inputs import MISSION_END, inputs_of
from eddi_scaffold.kinds.reliability.lowering import used
from eddi_scaffold.kinds.reliability.system import NAME, Chain, FaultTree, ReliabilitySystem
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import Declaration, module_text
from eddi_scaffold.program.running import module_of

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_TOO_MANY = 300
_STEPS = 2000
"""Evaluations for one mean life; four times what a smooth reliability needs."""


class _TooRoughError(Exception):
    """The integral needs more evaluations than there may be."""


def at_start(
    system: ReliabilitySystem, *, known: bool = True, seconds_left: float | None = None
) -> ReliabilityResult:
    """Return the first result with everything in order, or with nothing known.

    Args:
        system: the models.
        known: everything is in order.
        seconds_left: to the end of the mission, where that is an input; None: the longest.
    """
    monitor: Reliability = _module(system).Monitor()
    values = _start(system) if known else {}
    if seconds_left is not None:
        values[MISSION_END] = seconds_left
    return monitor.execute_step(SimpleNamespace(**values), 0)


def mean_life(system: ReliabilitySystem) -> float | None:
    """Return the mean time to failure of the top in hours from the start of the mission.

    The integral of the reliability with everything in order (adaptive Gauss-Legendre, relative
    1e-9); None for models that are too large or too rough to be evaluated that often, or without a
    limit.
    """
    first = at_start(system)
    if not math.isnan(first.mttf):
        return first.mttf
    if _size(system) > _TOO_MANY:
        return None
    values = SimpleNamespace(**_start(system))
    compiled = _module(replace(system, mission_end=False, thresholds=()), states=0)
    if hasattr(compiled, "battery"):  # what a battery prepares is the same for every horizon
        batteries = vars(compiled)["battery"].Battery
        vars(compiled)["battery"] = SimpleNamespace(Battery=cache(batteries))
    left = iter(range(_STEPS))

    def reliability(hours: float) -> float:
        if next(left, None) is None:
            raise _TooRoughError
        return look_ahead(compiled, hours).execute_step(values, 0).reliability

    try:
        return _integral(reliability)
    except _TooRoughError:
        return None


def _integral(reliability: Any) -> float | None:
    """Return the integral of a survival function over [0, inf)."""
    scale = 1.0
    while reliability(scale) > 0.5:
        scale *= 4.0
        if scale > 1e18:
            return None
    while reliability(scale) < 0.5 and scale > 1e-12:
        scale /= 2.0
    total, left, width = 0.0, 0.0, scale / 2.0
    for _ in range(80):
        whole = _gauss(reliability, left, left + width)
        part = _panel(reliability, left, left + width, whole, total, 6)
        total += part
        left += width
        width *= 1.5
        if part <= 1e-12 * total:
            return total
    return None


def _panel(
    reliability: Any, left: float, right: float, whole: float, before: float, depth: int
) -> float:
    """Return the integral from left to right, as exact as the sum with what is before needs it."""
    middle = 0.5 * (left + right)
    low, high = _gauss(reliability, left, middle), _gauss(reliability, middle, right)
    halves = low + high
    if depth == 0 or abs(whole - halves) <= 1e-11 * abs(before + halves):
        return halves
    below = _panel(reliability, left, middle, low, before, depth - 1)
    return below + _panel(reliability, middle, right, high, before + below, depth - 1)


def _gauss(reliability: Any, left: float, right: float) -> float:
    half, middle = 0.5 * (right - left), 0.5 * (right + left)
    values = [w * reliability(middle + half * x) for x, w in zip(_NODES, _WEIGHTS, strict=True)]
    return half * math.fsum(values)


def _size(system: ReliabilitySystem) -> int:
    size = 0
    for component in used(system).components.values():
        if isinstance(component.content, Chain):
            size += len(component.content.states)
        elif isinstance(component.content, FaultTree):
            size += len(component.content.gates) + len(component.content.events)
    return size


def look_ahead(compiled: ModuleType, hours: float) -> Reliability:
    """Return the monitor of a module with another horizon, at the start of the mission.

    Args:
        compiled: a model whose horizon is no input, compiled without numbers of one horizon.
        hours: at least 0.
    """
    for made in vars(compiled).values():
        if isinstance(made, type) and "horizon" in vars(made):
            type.__setattr__(made, "horizon", hours)
    monitor: Reliability = compiled.Monitor()
    return monitor


def _module(system: ReliabilitySystem, states: int = STATES_WRITTEN_OUT) -> ModuleType:
    """Return the module of a system whose inputs have no names but their ids."""
    inputs = tuple(BoundInput(input_.id, input_.id) for input_ in inputs_of(used(system)))
    declaration = Declaration("m", "", inputs)
    compiled = compile_system(system, declaration, states=states)
    text = module_text(NAME, compiled, declaration.model_id)
    return module_of(text, declaration.model_id)


def _start(system: ReliabilitySystem) -> dict[str, Any]:
    """Return inputs that report no failure."""
    return {input_.id: input_.sample for input_ in inputs_of(used(system))}


def proximity(
    one: Sequence[Sequence[float]], other: Sequence[Sequence[float]], distance: float
) -> tuple[float, float]:
    """Return the fraction of samples with less than a distance, as lower and upper bound.

    Args:
        one: track (samples, coordinates) in m; both tracks at the same times.
        other: track of the same shape.
        distance: m; a sample exactly as far away is not counted.

    Returns:
        Both bounds, equal unless a coordinate is not finite: such a sample counts for the upper
        one only. NaN, NaN without samples.

    Raises:
        ValueError: the tracks do not have the same shape.
    """
    a, b = np.asarray(one, dtype=float), np.asarray(other, dtype=float)
    if a.shape != b.shape or a.ndim > 2:
        raise ValueError(f"the tracks have the shapes {a.shape} and {b.shape}")
    if not a.size:
        return float("nan"), float("nan")
    known = (np.isfinite(a) & np.isfinite(b)).all(axis=1)
    near = int((np.linalg.norm(a[known] - b[known], axis=1) < distance).sum())
    return near / len(a), (near + int((~known).sum())) / len(a)

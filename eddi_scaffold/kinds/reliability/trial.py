"""Results of the runtime for a system at the start of the mission, with the code of the robot."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from types import ModuleType, SimpleNamespace
from typing import Any

from eddi_runtime.reliability import Reliability, ReliabilityResult

from eddi_scaffold.kinds.reliability.chains import STATES_WRITTEN_OUT
from eddi_scaffold.kinds.reliability.compile import compile_system
from eddi_scaffold.kinds.reliability.system import MISSION_END, NAME, ReliabilitySystem
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import Declaration, module_text
from eddi_scaffold.program.running import module_of

_TOO_MANY = 300
_STEPS = 2000  # Evaluations for one mean life; several times what a smooth reliability needs


class _TooRoughError(Exception):
    """The integral has no end, or needs more evaluations than there may be."""


def at_start(
    system: ReliabilitySystem, *, known: bool = True, seconds_left: float | None = None
) -> ReliabilityResult:
    """Return the first result with everything in order, or nothing known."""
    monitor: Reliability = _module(system).Monitor()
    inputs = system.without_unused().inputs() if known else ()
    values: dict[str, Any] = {input_.id: input_.sample for input_ in inputs}
    if seconds_left is not None:
        values[MISSION_END] = seconds_left
    return monitor.execute_step(SimpleNamespace(**values), 0)


def mean_life(system: ReliabilitySystem) -> float | None:
    """Return the mean time to failure of the top in hours with everything in order, to 1e-9.

    None: it is too large or too rough to be evaluated that often, or its life has no end.
    """
    first = at_start(system)
    if not math.isnan(first.mttf):
        return first.mttf
    counts = system.without_unused().counts()
    if sum(counts.values()) - counts["models"] > _TOO_MANY:
        return None
    inputs = system.without_unused().inputs()
    values = SimpleNamespace(**{input_.id: input_.sample for input_ in inputs})
    compiled = _module(replace(system, mission_end=False, thresholds=()), states=0)
    if hasattr(compiled, "battery"):  # what a battery prepares is the same for every horizon
        batteries = vars(compiled)["battery"].Battery
        vars(compiled)["battery"] = SimpleNamespace(Battery=cache(batteries))
    steps = iter(range(_STEPS))

    def reliability(hours: float) -> float:
        if next(steps, None) is None:
            raise _TooRoughError
        return look_ahead(compiled, hours).execute_step(values, 0).reliability

    try:
        return _integral(reliability)
    except _TooRoughError:
        return None


def _integral(reliability: Callable[[float], float]) -> float:
    # the trapezoidal rule in the logarithm of time converges exponentially
    scale = 1.0
    while reliability(scale) > 0.5:
        scale *= 4.0
        if scale > 1e18:
            raise _TooRoughError
    while reliability(scale) < 0.5 and scale > 1e-12:
        scale /= 2.0

    def terms(first: float, step: float) -> Iterator[float]:
        """Yield terms in one direction from the median life on, until they are negligible."""
        for k in itertools.count():
            hours = scale * math.exp(first + k * step)
            if hours > 1e18:
                raise _TooRoughError
            yield (term := hours * reliability(hours))
            if term <= 1e-13 * scale:
                return

    step = 0.5
    total = step * math.fsum([*terms(0.0, step), *terms(-step, -step)])
    while True:
        between = math.fsum([*terms(step / 2.0, step), *terms(-step / 2.0, -step)])
        last, total = total, 0.5 * total + 0.5 * step * between
        if abs(total - last) <= 1e-9 * total:
            return total
        step /= 2.0


def look_ahead(compiled: ModuleType, hours: float) -> Reliability:
    """Return the monitor of a module with no number of one horizon, with another horizon."""
    for made in vars(compiled).values():
        if isinstance(made, type) and "horizon" in vars(made):
            type.__setattr__(made, "horizon", hours)
    monitor: Reliability = compiled.Monitor()
    return monitor


def _module(system: ReliabilitySystem, states: int = STATES_WRITTEN_OUT) -> ModuleType:
    inputs = system.without_unused().inputs()
    declaration = Declaration("m", "", tuple(BoundInput(i.id, i.id) for i in inputs))
    compiled = compile_system(system, declaration, states=states)
    text = module_text(NAME, compiled, declaration.model_id)
    return module_of(text, declaration.model_id)

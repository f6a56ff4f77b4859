"""Results of the runtime for a system at the start of the mission, with the code of the robot."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from eddi_runtime.reliability import Reliability, ReliabilityResult

from eddi_scaffold.kinds.reliability.compile import compile_system
from eddi_scaffold.kinds.reliability.system import NAME, ReliabilitySystem
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import Declaration, module_text
from eddi_scaffold.program.running import module_of


def at_start(system: ReliabilitySystem, *, known: bool = True) -> ReliabilityResult:
    """Return the first result with everything in order, or nothing known."""
    inputs = system.without_unused().inputs()
    declaration = Declaration("m", "", tuple(BoundInput(i.id, i.id) for i in inputs))
    text = module_text(NAME, compile_system(system, declaration), declaration.model_id)
    monitor: Reliability = module_of(text, declaration.model_id).Monitor()
    values: dict[str, Any] = {input_.id: input_.sample for input_ in inputs} if known else {}
    return monitor.execute_step(SimpleNamespace(**values), 0)

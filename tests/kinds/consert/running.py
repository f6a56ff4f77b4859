"""The monitor of a typed ConSert, compiled as for a package and run in this process."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

from eddi_scaffold.kinds.consert.compile import STRAIGHT_LINE_LIMIT
from eddi_scaffold.kinds.consert.consert_model import ConSertModel
from eddi_scaffold.kinds.consert.options import ConSertOptions
from eddi_scaffold.program.monitor_text import Declaration
from runtime_lib.tests.bound_models import DIGEST, BoundModel, bound_input


def monitor_of(
    model: ConSertModel,
    limit: int = STRAIGHT_LINE_LIMIT,
    options: ConSertOptions | None = None,
) -> tuple[Any, Callable[[Mapping[str, Any]], Any]]:
    """Return the monitor, and what makes its input from values by id."""
    configured = replace(model, options=options or ConSertOptions())
    bound = tuple(bound_input(one.id) for one in model.inputs())
    made = BoundModel(configured, Declaration(model.name, DIGEST, bound)).monitor(limit=limit)
    return made, lambda values: SimpleNamespace(**values)

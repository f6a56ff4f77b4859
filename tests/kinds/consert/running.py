"""The monitor of a typed ConSert, compiled as for a package and run in this process."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from eddi_runtime.testing import inputs

from eddi_scaffold.compiling.consert.emission import STRAIGHT_LINE_LIMIT
from eddi_scaffold.compiling.document import digest_of
from eddi_scaffold.kinds.consert.functions import FUNCTIONS
from eddi_scaffold.kinds.consert.model import ConSertModel
from runtime_lib.tests.conserts import compiled


def document_of(model: ConSertModel, settings: Mapping[str, Any]) -> dict[str, Any]:
    data = {
        "format": 1,
        "kind": "consert",
        "id": model.name,
        "source": {},
        "inputs": [
            {"id": one.id, "attribute": one.id, "requires": []} for one in FUNCTIONS.inputs(model)
        ],
        "model": FUNCTIONS.runtime_model(model),
        "settings": settings,
    }
    return dict(data, sha256=digest_of(data))


def monitor_of(
    model: ConSertModel, limit: int = STRAIGHT_LINE_LIMIT, **settings: Any
) -> tuple[Any, Callable[[Mapping[str, Any]], Any]]:
    """Return the monitor, and what makes its input from values by id."""
    monitor = compiled(document_of(model, settings), allow_unsupported=True, limit=limit)
    return monitor, lambda values: inputs(monitor, values)

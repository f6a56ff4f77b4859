"""A model document as a running monitor: the text that its package gets, executed here."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from eddi_runtime import model_file as loaded
from eddi_runtime import monitor as loading

from eddi_scaffold.compiling.compilation import KINDS
from eddi_scaffold.compiling.document import parse_model
from eddi_scaffold.compiling.execution import build

if TYPE_CHECKING:
    from eddi_runtime import Monitor as RuntimeMonitor


def monitor_of(text: str, name: str, data: Mapping[str, bytes]) -> RuntimeMonitor:
    """Return the monitor of a model document; hand-written code is not in it.

    Args:
        text: of ``config/model.json``.
        name: used in errors.
        data: bulk files that belong to the model, by name.

    Raises:
        ModelError: the model cannot be compiled; the message has name and reason.
    """
    model_file = parse_model(text, name, data)
    if model_file.kind in KINDS:
        made: RuntimeMonitor = build(model_file)
        return made
    return loading.build(loaded.parse_model(text, name, data))

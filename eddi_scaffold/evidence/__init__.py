"""Evidence that a generated monitor is its model: test vectors, from the typed model alone.

What compiles a model is not imported here: vectors of its tables would prove nothing.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from eddi_scaffold.evidence.consert import consert_vectors
from eddi_scaffold.kinds.consert.consert import ConSert
from eddi_scaffold.kinds.consert.options import ConSertOptions

if TYPE_CHECKING:
    from eddi_scaffold.kinds import Model
    from eddi_scaffold.program.input_expressions import BoundInput


def vectors_of(model: Model, inputs: Sequence[BoundInput], about: Mapping[str, str]) -> str:
    """Return the test vectors of a configured model; empty for a kind that has none."""
    data, options = getattr(model, "data", None), getattr(model, "options", None)
    if isinstance(data, ConSert) and isinstance(options, ConSertOptions):
        return consert_vectors(data, options, inputs, about)
    return ""

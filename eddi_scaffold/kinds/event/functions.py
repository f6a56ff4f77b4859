"""What is done with events."""

from __future__ import annotations

from eddi_scaffold.kinds import Functions
from eddi_scaffold.kinds.event.claims import acceptances, limits, meanings, support
from eddi_scaffold.kinds.event.events import (
    configure,
    counts,
    export,
    inputs,
    model_part,
    outline,
    parts,
    read_file,
    readme,
    skeleton,
)
from eddi_scaffold.kinds.event.read_eddi import in_map, read_eddi

FUNCTIONS = Functions(
    in_map=in_map,
    read_eddi=read_eddi,
    read_file=read_file,
    counts=counts,
    outline=outline,
    export=export,
    inputs=inputs,
    runtime_model=model_part,
    configure=configure,
    readme=readme,
    parts=parts,
    meanings=meanings,
    accepted=acceptances,
    limits=limits,
    support=support,
    skeleton=skeleton,
)

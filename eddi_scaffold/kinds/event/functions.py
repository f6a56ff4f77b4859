"""What is done with events."""

from __future__ import annotations

from eddi_scaffold.kinds import Functions
from eddi_scaffold.kinds.event import runtime_model as document
from eddi_scaffold.kinds.event.claims import acceptances, claims, field_meanings, input_timeouts
from eddi_scaffold.kinds.event.compile import compile_events
from eddi_scaffold.kinds.event.events import (
    configure,
    counts,
    export,
    inputs,
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
    runtime_model=document.model_part,
    configure=configure,
    readme=readme,
    parts=parts,
    compile=compile_events,
    claims=claims,
    acceptances=acceptances,
    input_timeouts=input_timeouts,
    field_meanings=field_meanings,
    meanings=document.meanings,
    accepted=document.acceptances,
    limits=document.limits,
    support=document.support,
    skeleton=skeleton,
)

"""What is done with events."""

from __future__ import annotations

from collections.abc import Sequence

from eddi_scaffold.common.claims import Element
from eddi_scaffold.kinds import Functions
from eddi_scaffold.kinds.event.claims import acceptances, claims, field_meanings, input_timeouts
from eddi_scaffold.kinds.event.compile import compile_events
from eddi_scaffold.kinds.event.events import (
    EventModel,
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


def elements(model: EventModel) -> Sequence[Element]:
    """Return the events, in a file of their own with the line of each condition."""
    form = model.data.analysis.form
    assert form is not None
    in_eddi = model.place.path is not None
    return [
        Element(
            "event",
            output["id"],
            line=None if in_eddi else form["nodes"][output["node"]]["at"][0],
        )
        for output in form["outputs"]
    ]


FUNCTIONS = Functions(
    in_map=in_map,
    read_eddi=read_eddi,
    read_file=read_file,
    counts=counts,
    outline=outline,
    export=export,
    inputs=inputs,
    configure=configure,
    readme=readme,
    parts=parts,
    compile=compile_events,
    claims=claims,
    acceptances=acceptances,
    input_timeouts=input_timeouts,
    field_meanings=field_meanings,
    elements=elements,
    skeleton=skeleton,
)

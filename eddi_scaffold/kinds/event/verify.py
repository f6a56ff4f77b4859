"""Whether the text of a monitor of events is what was read: its conditions, all else as data."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from eddi_scaffold.evidence.conditions import needs_of, of_inputs
from eddi_scaffold.evidence.emitted import Emitted, called

if TYPE_CHECKING:
    from eddi_scaffold.program.instructions import Program


def verify(
    program: Program,
    units: Mapping[str, str],
    accepted: Sequence[tuple[str, ...]],
    emitted: Emitted,
) -> Iterator[str]:
    """Compare a text with events, and what each accepts of silence; yield what is proved."""
    monitor = emitted.monitor("event.EventMonitor")
    needs = needs_of(program, emitted.declared.inputs)
    rows = zip(program.results, needs, accepted, strict=True)
    events = (
        called("event.Event", of.id, of.hazard, places, accepts=words or None)
        for of, places, words in rows
    )
    emitted.attribute(monitor, "events", tuple(events))
    of_inputs(emitted, monitor, program, units)
    emitted.end(monitor)
    yield f"conditions of {', '.join(result.id for result in program.results)}"

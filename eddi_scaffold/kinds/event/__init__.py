"""The kind ``event``: conditions over time, as monitors of their own (SESAME D7.2 section 3.5)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from eddi_scaffold.common.claims import StatusReading, Verdict, state_of
from eddi_scaffold.kinds import ClaimField, Kind, messages_in

if TYPE_CHECKING:
    from eddi_scaffold.common.files import Source

MESSAGES = messages_in(__path__[0])  # ROS message name -> text of its `.msg` file
_FALSE, _UNKNOWN = 0, 1


def _status(event: Any) -> StatusReading:
    unknown = event.verdict == _UNKNOWN  # also of a hazard, which is active then
    reasons = ("unknown counts as there",) if unknown and event.active else ()
    if event.verdict == _FALSE:
        reasons = ("the condition is FALSE",)
    verdict = Verdict(event.id, state_of(active=event.active, known=not unknown), reasons)
    return StatusReading((verdict,), accepted=tuple(event.accepted), is_complete=False)


def _recognises(source: Source) -> bool:
    return source.name.lower().endswith(".events")


KIND = Kind(
    name="event",
    title="Event",
    config_types=("Event", "Events"),
    recognises=_recognises,
    messages=MESSAGES,
    output_message="EventOutput",
    verdicts={"EventOutput": _status},
    model="event_model.EventModel",
    topic="events",
    claim=ClaimField("EventOutput", apart=True),
    in_eddi='descendant-or-self::*[local-name()="keyValueMaps"][@key="eddi.events"]',
)
"""What the generator knows of events."""

"""The kind ``event``: conditions over time, as monitors of their own (SESAME D7.2 section 3.5)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eddi_scaffold.kinds import Functions, Kind
from eddi_scaffold.kinds.event.messages import MESSAGES, VERDICTS

if TYPE_CHECKING:
    from eddi_scaffold.common.files import Source
    from eddi_scaffold.kinds.event.events import EventModel


def _sniff(source: Source) -> bool:
    return source.name.lower().endswith(".events")


def _functions() -> Functions[EventModel]:
    from eddi_scaffold.kinds.event.functions import FUNCTIONS  # noqa: PLC0415 - the language

    return FUNCTIONS


KIND = Kind(
    name="event",
    title="Event",
    config_types=("Event", "Events"),
    sniff=_sniff,
    messages=MESSAGES,
    output_message="EventOutput",
    verdicts=VERDICTS,
    load=_functions,
    topic="events",
    in_eddi='descendant-or-self::*[local-name()="keyValueMaps"][@key="eddi.events"]',
)
"""What the generator knows of events."""

"""The kind ``event``: conditions over time, as monitors of their own (SESAME D7.2 section 3.5)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from eddi_scaffold.kinds import Kind, Reading
from eddi_scaffold.kinds.event.claims import acceptances, limits, meanings, support
from eddi_scaffold.kinds.event.messages import MESSAGES
from eddi_scaffold.kinds.event.model import (
    NAME,
    configure,
    counts,
    export,
    inputs,
    model_part,
    outline,
    parts,
    read_file,
    readme,
)

if TYPE_CHECKING:
    from eddi_scaffold.problems import Problem
    from eddi_scaffold.readers.document import EddiDocument
    from eddi_scaffold.source import Source


def _read_eddi(_document: EddiDocument, _source: Source, _marks: Sequence[str]) -> Reading:
    """Return nothing: the metamodel of EDDI XML has no conditional events."""
    return Reading((), ())


def _sniff(source: Source) -> bool:
    return source.name.lower().endswith(".events")


def _check(_: object) -> Sequence[Problem]:
    """Return nothing: the reader has seen all there is to see without a rate."""
    return ()


KIND = Kind(
    name=NAME,
    title="Event",
    config_types=("Event", "Events"),
    read_eddi=_read_eddi,
    sniff=_sniff,
    read_file=read_file,
    check=_check,
    counts=counts,
    outline=outline,
    export=export,
    inputs=inputs,
    runtime_model=model_part,
    messages=MESSAGES,
    output_message="EventOutput",
    configure=configure,
    readme=readme,
    parts=parts,
    meanings=meanings,
    accepted=acceptances,
    limits=limits,
    support=support,
)
"""What the generator knows of events."""

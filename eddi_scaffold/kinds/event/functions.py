"""What is done with events."""

from __future__ import annotations

from collections.abc import Sequence

from eddi_scaffold.kinds import Functions, Reading
from eddi_scaffold.kinds.event.claims import acceptances, limits, meanings, support
from eddi_scaffold.kinds.event.model import (
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
from eddi_scaffold.readers.document import EddiDocument
from eddi_scaffold.source import Source


def _read_eddi(_document: EddiDocument, _source: Source, _marks: Sequence[str]) -> Reading:
    """Return nothing: the metamodel of EDDI XML has no conditional events."""
    return Reading((), ())


FUNCTIONS = Functions(
    read_eddi=_read_eddi,
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
)

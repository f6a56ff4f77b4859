"""What the message of an event says."""

from __future__ import annotations

from typing import Any

from eddi_scaffold.verdicts import Listen, Said, Verdict, state_of

_FALSE, _UNKNOWN = 0, 1


def _said(event: Any) -> Said:
    unknown = event.verdict == _UNKNOWN  # also of a hazard, which is active then
    reasons = ("unknown counts as there",) if unknown and event.active else ()
    if event.verdict == _FALSE:
        reasons = ("the condition is FALSE",)
    one = Verdict(event.id, state_of(active=event.active, known=not unknown), reasons)
    return Said((one,), accepted=tuple(event.accepted), whole=False)


VERDICTS: dict[str, Listen] = {"EventOutput": _said}

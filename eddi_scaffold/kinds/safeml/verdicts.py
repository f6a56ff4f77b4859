"""What the status of a SafeML monitor says."""

from __future__ import annotations

import math
from typing import Any

from eddi_scaffold.verdicts import Listen, Said, Verdict, state_of

WORDS = {
    "empty": "a message has no samples",
    "filling": "the window is not full yet",
    "not_finite": "a sample is not finite",
    "stale": "the last sample is too old",
    "wrong_length": "a sample has the wrong length",
}
"""Reason of an omission -> words; the node's diagnostics add the numbers."""
_DIFFERS = "the samples differ from the reference"


def _said(status: Any) -> Said:
    text = "" if math.isnan(status.statistic) else f"distance {status.statistic:.3g}"
    reason = status.reason if status.omission else "" if status.in_scope else _DIFFERS
    reasons = (WORDS.get(reason, reason),) if reason else ()
    state = state_of(active=status.in_scope, known=not status.omission)
    return Said((Verdict("in_scope", state, reasons, text),), accepted=tuple(status.acceptances))


VERDICTS: dict[str, Listen] = {"SafeMLStatus": _said}

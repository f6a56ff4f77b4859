"""What the status of a SafeML monitor says."""

from __future__ import annotations

import math
from typing import Any

from eddi_scaffold.verdicts import Listen, Said, Verdict, state_of


def _said(status: Any) -> Said:
    text = "" if math.isnan(status.statistic) else f"distance {status.statistic:.3g}"
    reasons = (status.reason,) if status.omission and status.reason else ()
    state = state_of(active=status.in_scope, known=not status.omission)
    return Said((Verdict("in_scope", state, reasons, text),), accepted=tuple(status.acceptances))


VERDICTS: dict[str, Listen] = {"SafeMLStatus": _said}

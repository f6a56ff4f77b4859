"""What the status of a ConSert says."""

from __future__ import annotations

from typing import Any

from eddi_scaffold.verdicts import Listen, Said, Verdict, state_of

_UNKNOWN, _TRUE = 1, 2


def _said(status: Any) -> Said:
    verdicts = tuple(
        Verdict(
            one.id,
            state_of(active=one.verdict == _TRUE, known=one.verdict != _UNKNOWN),
            tuple(one.missing),
        )
        for one in status.guarantees
    )
    return Said(verdicts, status.model_id, status.model_digest, tuple(status.accepted))


VERDICTS: dict[str, Listen] = {"ConSertStatus": _said}

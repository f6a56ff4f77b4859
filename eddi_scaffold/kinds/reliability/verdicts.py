"""What the result of a reliability monitor says."""

from __future__ import annotations

from typing import Any

from eddi_scaffold.verdicts import Listen, Said, Verdict, state_of


def _said(output: Any) -> Said:
    reasons = tuple(output.unknown_inputs) or ((output.reason,) if output.reason else ())
    text = f"p_fail {output.p_fail:.3g}"
    valid = Verdict("valid", state_of(active=output.valid, known=False), reasons, text)
    thresholds = (
        Verdict(
            one.id,
            state_of(active=one.active, known=not output.reason),
            () if one.active else reasons,
        )
        for one in output.evidence
    )
    return Said((valid, *thresholds), output.model, accepted=tuple(output.accepted))


VERDICTS: dict[str, Listen] = {"ReliabilityOutput": _said}

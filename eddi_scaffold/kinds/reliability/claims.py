"""Meaning of the messages of a reliability monitor."""

from __future__ import annotations

from eddi_scaffold.common.claims import Meaning, Meanings, ValidityField

_THRESHOLD = "`field: evidence[ID].active` of a threshold"
_NUMBER = Meaning(
    given=(ValidityField("ReliabilityOutput", "valid", value=True),),
    refused="the numbers mean something only where `valid` is true",
    instead=f"{_THRESHOLD}, or `valid AND ...`",
    known=(("valid", True),),
)
MEANINGS: Meanings = {
    "ReliabilityOutput": {
        "valid": Meaning(
            (False,), refused="`valid` is false when something is unknown", instead=_THRESHOLD
        ),
        "evidence[].active": Meaning(
            (False,),
            refused="`active` of a threshold is false also when it is unknown",
            instead="a threshold on the other side",
            known=(("reason", ""),),
        ),
        "p_fail": _NUMBER,
        "p_fail_high": _NUMBER,
        "reliability": _NUMBER,
        "mttf_hours": _NUMBER,
        "p_fail_low": Meaning(
            refused="`p_fail_low` is what is certain at least, not the worst case",
            instead=_THRESHOLD,
            known=(("valid", True),),
        ),
    },
}
"""Message -> field -> its meaning."""

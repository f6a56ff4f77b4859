"""Meaning of the messages of a SafeML monitor."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from eddi_scaffold.common.claims import Meaning, Meanings, ValidityField

_IN_SCOPE = "`field: in_scope` of SafeMLStatus"
_VERDICT = (("omission", False),)


def _fields(message: str) -> dict[str, Meaning]:
    return {
        "omission": Meaning(
            (True,), refused="an omission is also silence", instead=f"NOT of it, or {_IN_SCOPE}"
        ),
        "odd_violation": Meaning(
            given=(ValidityField(message, "omission", value=False),),
            refused="`odd_violation` has no meaning while there is no verdict",
            instead=f"{_IN_SCOPE}, or `NOT omission` with it",
            known=_VERDICT,
        ),
    }


MEANINGS: Meanings = {
    "SafeMLOutput": _fields("SafeMLOutput"),
    "SafeMLStatus": {
        **_fields("SafeMLStatus"),
        "in_scope": Meaning(
            (False,),
            refused="`in_scope` is false also when there is no verdict",
            instead="`NOT omission AND odd_violation`: known to be a violation",
            known=_VERDICT,
        ),
    },
}
"""Message -> field -> its meaning."""


def limits(document: Mapping[str, Any]) -> Mapping[str, float]:
    """Return the age after which a frame is an omission."""
    age = document["settings"]["max_age"]
    return {} if age is None else {spec["id"]: age for spec in document["inputs"]}


def support(document: Mapping[str, Any]) -> Mapping[str, frozenset[str]]:
    """Return what "in scope" rests on: the frames."""
    return {"in_scope": frozenset(spec["id"] for spec in document["inputs"])}

"""What a report is about: items with a state, and the links between them."""

from __future__ import annotations

import hashlib
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

Key = tuple[str, str, str]
"""Kind, monitor (empty for what belongs to none), id in the model."""

KINDS = (
    *("hazard", "requirement", "measure", "guarantee", "gate", "evidence", "topic", "region"),
    "testcase",
)


@dataclass(frozen=True)
class Item:
    """One element of the models, or what was shown about it."""

    key: Key
    text: str  # what a person wrote about it
    state: str  # a state of a hazard, or a verdict
    # relation -> what it is related to (``mitigates``, ``rests on``)
    links: Mapping[str, Sequence[Key]] = field(default_factory=dict)
    place: str = ""  # file and line, or the path in the EDDI
    sha256: str = ""  # of the file in which it stands


def export_ids(keys: Iterable[Key]) -> dict[Key, str]:
    """Return the id of each item in other tools: of its key alone, so it never changes.

    It matches ``[A-Z0-9_]{5,}``. Where two keys would have the same, each has six digits of its
    own behind.
    """
    ids: dict[Key, str] = {}
    for key in keys:
        parts = (re.sub(r"[^A-Z0-9]+", "_", part.upper()).strip("_") for part in key if part)
        ids[key] = "_".join(part or "X" for part in parts)
    counts = Counter(ids.values())
    for key, id_ in ids.items():
        if counts[id_] > 1:
            digest = hashlib.sha256("\0".join(key).encode()).hexdigest()
            ids[key] = f"{id_}_{digest[:6].upper()}"
    return ids

"""Files that tests read: our own oracles, and other people's models where this machine has them."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

ORACLES = Path(__file__).parent / "data" / "oracles"
FOREIGN = Path(os.environ.get("EDDI_FOREIGN_DATA", Path(__file__).parents[2] / "shared" / "data"))
"""Other people's models, which are not part of the project; see ``left_out``."""

ABSENT = "other people's models are not on this machine"


def data_file(name: str) -> Path:
    """Return the path of an oracle or of a foreign file, or skip the test where that is absent."""
    path = ORACLES / name
    if path.exists():
        return path
    if not (FOREIGN / name).exists():
        pytest.skip(f"{ABSENT}: {name}")
    return FOREIGN / name


def data_text(name: str) -> str:
    """Return a text that tests write: a model, a configuration, an old file, what is expected."""
    return (Path(__file__).parent / "data" / "texts" / name).read_bytes().decode()


def left_out(reasons: list[str]) -> str | None:
    """Return the line that a run ends with where tests were skipped for want of foreign files."""
    count = sum(ABSENT in reason for reason in reasons)
    return f"{count} tests left out: {ABSENT} ({FOREIGN})" if count else None

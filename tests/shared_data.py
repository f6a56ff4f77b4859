"""Where the oracles and other people's models lie; tests that need them skip without them."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

ROOT = Path(os.environ.get("EDDI_SHARED", Path(__file__).parents[2] / "shared" / "data"))


def shared(name: str) -> Path:
    """Return the path of one shared file, or skip the test with the reason."""
    path = ROOT / name
    if not path.exists():
        pytest.skip(f"the shared data are not on this machine: {path}")
    return path

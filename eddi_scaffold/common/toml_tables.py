"""Tables of our own that are data: TOML files of the distribution."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any


def read_toml(path: Path) -> dict[str, Any]:
    """Return the tables of a file."""
    if sys.version_info >= (3, 11):
        import tomllib  # noqa: PLC0415 - a command may need none
    else:
        import tomli as tomllib  # noqa: PLC0415
    return tomllib.loads(path.read_text("utf-8"))

"""Other Python interpreters that this machine may have."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

SINCE = "3.8"
"""The oldest Python that a robot may have."""
CACHE = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "eddi-scaffold"
"""What is installed once on a machine; some tests give a home of their own to what they run."""
_VERSIONS = Path.home() / ".pyenv" / "versions"


def old_python() -> str:
    """Find a Python 3.8."""
    pyenv = sorted(_VERSIONS.glob(f"{SINCE}.*/bin/python"))
    named = shutil.which(f"python{SINCE}")
    for found in [*([named] if named else []), *map(str, pyenv)]:
        asked = subprocess.run([found, "--version"], capture_output=True, text=True, check=False)
        if asked.stdout.startswith(f"Python {SINCE}."):
            return found
    return pytest.skip(f"there is no Python {SINCE} on this machine")

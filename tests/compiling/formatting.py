"""What the formatter of this project would change in a text."""

from __future__ import annotations

import subprocess
import sys


def reformatted(text: str) -> str:
    """Return the difference, empty when the formatter agrees.

    Raises:
        AssertionError: the formatter cannot read the text.
    """
    command = [sys.executable, "-m", "ruff", "format", "--diff", "--isolated", "-"]
    command += ["--line-length", "100", "--stdin-filename", "made.py"]
    done = subprocess.run(command, input=text, capture_output=True, text=True, check=False)
    assert done.returncode in (0, 1), done.stderr
    return done.stdout

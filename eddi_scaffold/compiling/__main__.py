"""Command line for Copier's tasks and migrations: ``python <this folder> write``.

The working directory is the package. It ends with 0 whatever it finds, because a failing task
would make Copier drop hand edits.
"""

from __future__ import annotations

import sys
import traceback
from pathlib import Path

if not __package__:  # run as a folder: make the template's checkout importable, leave no trace
    sys.dont_write_bytecode = True
    sys.path[0] = str(Path(__file__).resolve().parents[2])

from eddi_scaffold.compiling.package import write_compiled

_USAGE = "usage: python <template>/eddi_scaffold/compiling write   (in the package's folder)\n"


def main(arguments: list[str] | None = None, root: Path | None = None) -> int:
    """Compile the model of the package in ``root`` (default: the working directory)."""
    words = sys.argv[1:] if arguments is None else arguments
    if words != ["write"]:
        sys.stderr.write(_USAGE)
        return 0 if words in (["-h"], ["--help"]) else 2
    try:
        problem = write_compiled(root or Path.cwd())
    except Exception:  # noqa: BLE001 - a failing task makes Copier drop hand edits
        problem = f"our bug; hand edits are not lost\n{traceback.format_exc()}"
    if problem is not None:
        sys.stderr.write(f"error: {problem}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())

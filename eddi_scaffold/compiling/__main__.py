"""Command line for Copier's tasks and migrations: ``python <this folder> write [TABLES]``.

``TABLES`` is the folder of large tables of numbers, which Copier does not render. The working
directory is the package. It ends with 0 whatever it finds, because a failing task
would make Copier drop hand edits.
"""

from __future__ import annotations

import sys
import traceback
from pathlib import Path

if not __package__:  # run as a folder: make the template's checkout importable, leave no trace
    sys.dont_write_bytecode = True
    sys.path[0] = str(Path(__file__).resolve().parents[2])

from eddi_scaffold.compiling.package import place_tables, write_compiled
from eddi_scaffold.compiling.sources import lost_inputs

_USAGE = "usage: python <template>/eddi_scaffold/compiling write [TABLES]   (in the package)\n"


def main(arguments: list[str] | None = None, root: Path | None = None) -> int:
    """Compile the model of the package in ``root`` (default: the working directory)."""
    words = sys.argv[1:] if arguments is None else arguments
    if words[:1] != ["write"] or len(words) > 2:
        sys.stderr.write(_USAGE)
        return 0 if words in (["-h"], ["--help"]) else 2
    package = root or Path.cwd()
    try:
        problem = write_compiled(package)
        missing = place_tables(package, Path(words[1]) if any(words[1:]) else None)
        if missing:
            told = f"{', '.join(missing)} of the answers is not there"
            problem = problem or f"{told}: give its folder, as with `-d tables=FOLDER`"
        sys.stderr.write("".join(f"note: {line}\n" for line in lost_inputs(package)))
    except Exception:  # noqa: BLE001 - a failing task makes Copier drop hand edits
        problem = f"our bug; hand edits are not lost\n{traceback.format_exc()}"
    if problem is not None:
        sys.stderr.write(f"error: {problem}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""Command line for Copier's tasks: ``python <this folder> write RENDERING [TABLES]``.

``RENDERING`` is a folder of the package, which is the working directory; ``TABLES`` is that of
large tables of numbers, which Copier does not render.
"""

from __future__ import annotations

import sys
from pathlib import Path

if not __package__:  # run as a folder: make the template's checkout importable, leave no trace
    sys.dont_write_bytecode = True
    sys.path[0] = str(Path(__file__).resolve().parents[2])

from eddi_scaffold.compiling.package import place_tables, write_compiled
from eddi_scaffold.compiling.sources import lost_inputs

_USAGE = (
    "usage: python <template>/eddi_scaffold/compiling write RENDERING [TABLES]   (in the package)\n"
)


def main(arguments: list[str] | None = None, root: Path | None = None) -> int:
    """Compile the model of the package in ``root`` (default: the working directory)."""
    words = sys.argv[1:] if arguments is None else arguments
    if words[:1] != ["write"] or len(words) not in {2, 3}:
        sys.stderr.write(_USAGE)
        return 0 if words in (["-h"], ["--help"]) else 2
    package = root or Path.cwd()
    rendering = package / words[1]
    problem = write_compiled(rendering)
    missing = place_tables(package, rendering, Path(words[2]) if any(words[2:]) else None)
    if missing:
        told = f"{', '.join(missing)} of the answers is not there"
        problem = problem or f"{told}: give its folder, as with `-d tables=FOLDER`"
    sys.stderr.write("".join(f"note: {line}\n" for line in lost_inputs(package, rendering)))
    if problem is not None:
        sys.stderr.write(f"error: {problem}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())

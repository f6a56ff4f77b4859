"""``eddi-scaffold example``: a worked example to start from."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def example(
    name: Annotated[str, typer.Argument(help="Name of the example; `list` prints them.")],
    folder: Annotated[Path | None, typer.Argument(help="New folder for its files.")] = None,
) -> None:
    """Write a worked example: model, configurations, a recording.

    Example: eddi-scaffold example two-conserts demo
    """
    from eddi_scaffold.cli.console import console
    from eddi_scaffold.common.problems import EddiError, Place, did_you_mean, problem
    from eddi_scaffold.packages.examples import described, example_files, names
    from eddi_scaffold.packages.transaction import write

    if name == "list":
        width = max(map(len, names()), default=0)
        for known, heading in described().items():
            console.data(f"{known.ljust(width)}  {heading}")
        return
    if name not in names():
        hint = did_you_mean(name, names()) or f"examples: {', '.join(names())}"
        raise EddiError(problem("G008.example", hint=hint, name=name))
    target = folder or Path(name)
    if target.exists() and (not target.is_dir() or any(target.iterdir())):
        case = "G006.not_empty" if target.is_dir() else "G006.file"
        raise EddiError(problem(case, Place(str(target))))
    files = example_files(name)
    write(target, files)
    for file in sorted(files):
        console.data(str(target / file))
    console.say(f"next: read {target / 'README.md'}")

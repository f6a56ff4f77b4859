"""``eddi-scaffold merge-driver``: what git runs to merge two branches of an editable file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def merge_driver(
    base: Annotated[Path, typer.Argument(help="%O: the file where the branches part.")],
    ours: Annotated[Path, typer.Argument(help="%A: of this branch; gets the result.")],
    theirs: Annotated[Path, typer.Argument(help="%B: of the other branch.")],
    path: Annotated[str, typer.Argument(help="%P: the file in the repository.")],
) -> None:
    """Merge branches of an editable file; git runs it.

    Example: eddi-scaffold merge-driver %O %A %B %P
    """
    from eddi_scaffold.regions import driver

    raise typer.Exit(driver.merge_driver(base, ours, theirs, path))

"""``eddi-scaffold regions``: what was written by hand, and what needs a look."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from eddi_scaffold.cli import exit_status
from eddi_scaffold.cli.console import console
from eddi_scaffold.cli.options import WherePackagesAre


def regions(
    path: Annotated[Path, typer.Argument()] = Path(),
    workspace: WherePackagesAre = None,
    check: bool = False,
    accept: list[str] | None = None,
    as_json: bool = False,
) -> None:
    """List the regions of hand-written code and their state.

    Example: eddi-scaffold regions --check catkin_ws

    Args:
        path: A package, or a folder that holds packages.
        check: Exit with 3 when a person must look; for CI.
        accept: Region id or unfit file that was looked at and is right; repeatable.
    """
    from eddi_scaffold.packages.handwritten import accept_regions, inventory

    path = path if workspace is None else workspace
    for region_id in accept_regions(path, accept) if accept else ():
        console.success(f"accepted {region_id}")
    entries = inventory(path)
    if as_json:
        keys = ("id", "file", "line", "state", "notes")
        console.json({"regions": [{key: getattr(entry, key) for key in keys} for entry in entries]})
    else:
        for entry in entries:
            place = f"{entry.file}:{entry.line}" if entry.line else entry.file
            console.data(f"{entry.state:9} {entry.id}  {place}")
            for note in entry.notes:
                console.data(f"          {note}")
    if check and any(entry.review for entry in entries):
        raise typer.Exit(exit_status.LOOK)

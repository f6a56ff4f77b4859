"""Where packages go: a workspace or a folder, as the platform wants it."""

from __future__ import annotations

from pathlib import Path

from eddi_scaffold.common.problems import EddiError, Place, error
from eddi_scaffold.packages.rendering import ANSWERS_FILE
from eddi_scaffold.platforms import Platform, platforms


def destination(platform: Platform, workspace: Path | None, output: Path | None) -> Path:
    """Return the one of ``-w`` and ``-o`` that the platform takes.

    Raises:
        EddiError: it is missing or a package (G006), or the other one is given as well (G014).
    """
    in_workspace = platform.workspace is not None
    place, option = (workspace, "-w WORKSPACE") if in_workspace else (output, "-o FOLDER")
    if place is None:
        given = output if in_workspace else workspace
        known = platforms().items()
        others = [name for name, one in known if (one.workspace is None) == in_workspace]
        hint = f"{'-o' if in_workspace else '-w'} is for --platform {' or '.join(others)}"
        message = f"the platform {platform.name} needs {option}"
        raise EddiError(error("G006", message, hint=hint if given is not None else None))
    if workspace is not None and output is not None:
        message = f"the platform {platform.name} takes {option} alone"
        raise EddiError(error("G014", message, hint="leave the other one out"))
    if (place / ANSWERS_FILE).is_file():
        message = "this folder is a package, and packages do not lie in one another"
        hint = f"the folder of its packages is {place.absolute().parent}"
        raise EddiError(error("G006", message, Place(str(place)), hint))
    return place

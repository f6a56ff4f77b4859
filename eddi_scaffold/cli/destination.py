"""Where packages go: a workspace or a folder, as the platform wants it."""

from __future__ import annotations

from pathlib import Path

from eddi_scaffold.platforms import Platform
from eddi_scaffold.problems import EddiError, Place, error


def destination(platform: Platform, workspace: Path | None, output: Path | None) -> Path:
    """Return the one of ``-w`` and ``-o`` that the platform takes.

    Raises:
        EddiError: it is missing (G006), the other one is given as well (G014), or it is no
            workspace (G007).
    """
    expected = platform.workspace
    place, option = (output, "-o FOLDER") if expected is None else (workspace, "-w WORKSPACE")
    if place is None:
        raise EddiError(error("G006", f"the platform {platform.name} needs {option}"))
    if workspace is not None and output is not None:
        message = f"the platform {platform.name} takes {option} alone"
        raise EddiError(error("G014", message, hint="leave the other one out"))
    if expected is not None and not place.is_dir():
        message = f"there is no such {expected.title}"
        hint = f"mkdir -p {place}/{expected.sources}"
        raise EddiError(error("G007", message, Place(str(place)), hint))
    inside = expected is not None and place.resolve().name == expected.sources
    if expected is not None and inside and not (place / expected.sources).exists():
        message = f"this is the `{expected.sources}` of a workspace"
        hint = f"name the folder above: -w {place.parent}"
        raise EddiError(error("G007", message, Place(str(place)), hint))
    return place

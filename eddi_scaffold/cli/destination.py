"""Where packages go: a workspace or a folder, as the platform wants it."""

from __future__ import annotations

from pathlib import Path

from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.packages.rendering import ANSWERS_FILE
from eddi_scaffold.platforms import Platform, platforms


def destination(platform: Platform, workspace: Path | None, output: Path | None) -> Path:
    """Return the one of ``-w`` and ``-o`` that the platform takes.

    Raises:
        EddiError: it is missing or a package (G006), or the other one is given as well (G000).
    """
    in_workspace = platform.workspace is not None
    place, option = (workspace, "-w WORKSPACE") if in_workspace else (output, "-o FOLDER")
    if place is None:
        given = output if in_workspace else workspace
        known = platforms().items()
        others = [name for name, one in known if (one.workspace is None) == in_workspace]
        hint = f"{'-o' if in_workspace else '-w'} is for --platform {' or '.join(others)}"
        raise EddiError(
            problem(
                "G006.platform",
                hint=hint if given is not None else None,
                platform=platform.name,
                option=option,
            )
        )
    if workspace is not None and output is not None:
        raise EddiError(problem("G000.alone", platform=platform.name, option=option))
    if (place / ANSWERS_FILE).is_file():
        raise EddiError(
            problem("G006.inside_package", Place(str(place)), parent=place.absolute().parent)
        )
    return place

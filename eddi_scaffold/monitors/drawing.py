"""``diagram`` as a function: the pictures of the models of a file."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from eddi_scaffold.diagrams import drawn
from eddi_scaffold.identifiers import free_name
from eddi_scaffold.kinds import kinds
from eddi_scaffold.monitors.choosing import select
from eddi_scaffold.monitors.loading import checked_models, unfit
from eddi_scaffold.problems import EddiError, Place, Problem, error


def pictures(
    path: Path, name: str | None, default_guarantees: Sequence[str], *, single: bool
) -> tuple[dict[str, str], list[Problem]]:
    """Return file name -> SVG of each model, and why no monitor can be made of one as it is.

    Args:
        path: the file.
        name: which model, ``None`` for all.
        default_guarantees: marks of the command line.
        single: only one picture is asked for.

    Raises:
        EddiError: the file cannot be used, no model in it can be drawn (G018), or one picture is
            asked for and there are several models (G019).
    """
    every = checked_models(path, default_guarantees).models
    models = select(every, name) if name is not None else every
    found: dict[str, str] = {}
    stems: set[str] = set()
    for model in models:
        draw = kinds()[model.kind].functions.diagram
        if draw is not None:
            plain = re.sub(r"[^\w.-]", "_", model.name).lstrip(".") or model.kind
            stem = free_name(plain, stems)
            stems.add(stem)
            found[f"{stem}.svg"] = drawn(draw(model))
    if not found:
        names = ", ".join(kinds()[model.kind].title for model in models)
        message = f"there is no picture of this kind of model ({names})"
        raise EddiError(error("G018", message, Place(str(path))))
    if single and len(found) > 1:
        names = ", ".join(model.name for model in models)
        hint = "choose one with --name, or name a folder: -o FOLDER"
        message = f"there are several models in the file: {names}"
        raise EddiError(error("G019", message, Place(str(path)), hint))
    return found, unfit(models)

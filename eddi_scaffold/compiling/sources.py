"""Inputs that a new rendering leaves to a person, where the one before made them of messages.

Our own commands see this in the answers; plain Copier shows only what it has rendered.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from eddi_scaffold.regions.marked_file import Region, parse
from eddi_scaffold.regions.package import read_file

_MODULE = "EDDIInput.py"
_WAITS = re.compile(r"self\.\w+ = None")


def lost_inputs(root: Path, rendering: Path) -> Iterator[str]:
    """Yield a line for each input of a package that has no source any more.

    Args:
        root: the package.
        rendering: folder of all its new files.
    """
    for path in rendering.rglob(_MODULE):
        name = path.relative_to(rendering).as_posix()
        try:
            file = read_file(root, name)
        except OSError:
            file = None
        before = file.sides[0].regions if file is not None and not file.faults else {}
        for region in parse(path.read_text("utf-8"))[0].regions.values():
            names = [one for one in (region.id, *region.was) if one in before]
            for was in names[:1]:
                made = _statement(before[was])
                own = before[was].untouched
                if own and made and not _WAITS.fullmatch(made) and _waits(region):
                    yield (
                        f"input {region.id.removeprefix('process_')!r} has no source any more: "
                        f"it was made by `{made}`"
                    )


def _waits(region: Region) -> bool:
    return _WAITS.fullmatch(_statement(region)) is not None


def _statement(region: Region) -> str:
    """Return the last line of a body, which sets the input."""
    return (region.body.splitlines() or [""])[-1].strip()

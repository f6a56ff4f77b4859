"""Inputs that a new rendering leaves to a person, where the one before made them of messages.

Our own commands see this in the answers; plain Copier shows only what it has rendered.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from eddi_scaffold.regions.bases import read_bases
from eddi_scaffold.regions.marked_file import Region, parse
from eddi_scaffold.regions.store import PRISTINE, files_below, read_text

_MODULE = "EDDIInput.py"
_WAITS = re.compile(r"self\.\w+ = None")


def lost_inputs(root: Path) -> Iterator[str]:
    """Yield a line for each input of a package that has no source any more.

    Args:
        root: the package, rendered and not yet merged.
    """
    bases = read_bases(root)
    for name in files_below(root / PRISTINE):
        if name.rpartition("/")[2] != _MODULE:
            continue
        before, new, mine = (
            _regions(text)
            for text in (bases.get(name), read_text(root / PRISTINE / name), read_text(root / name))
        )
        for region in new.values():
            names = [one for one in (region.id, *region.was) if one in before and one in mine]
            for was in names[:1]:
                made, own = _statement(before[was]), mine[was].body == before[was].body
                if own and made and not _WAITS.fullmatch(made) and _waits(region):
                    yield (
                        f"input {region.id.partition(':')[2]!r} has no source any more: "
                        f"it was made by `{made}`"
                    )


def _waits(region: Region) -> bool:
    return _WAITS.fullmatch(_statement(region)) is not None


def _statement(region: Region) -> str:
    """Return the last line of a body, which sets the input."""
    return (region.body.splitlines() or [""])[-1].strip()


def _regions(text: object) -> dict[str, Region]:
    document, faults = parse(text) if isinstance(text, str) else (None, [])
    return document.regions if document is not None and not faults else {}

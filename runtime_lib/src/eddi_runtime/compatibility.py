"""Whether a compiled monitor and this runtime fit: asked once, when the monitor is imported."""

from __future__ import annotations

import hashlib
from types import ModuleType
from typing import Mapping

__version__ = "1.0.0"
"""Of this runtime."""

_MARK = b"\n# sha256 of the lines below: "


class ModelError(ValueError):
    """A monitor cannot run."""

    def __init__(self, path: str, reason: str) -> None:
        super().__init__(f"{path}: {reason}" if path else reason)
        # the file of the compiled monitor, or another name for where it came from
        self.path = path
        self.reason = reason  # what is wrong, one sentence without a full stop


def needs(file: str, formats: Mapping[ModuleType, int]) -> None:
    """Refuse a compiled monitor that was changed, or needs another runtime (``ModelError``)."""
    for part, wanted in formats.items():
        if wanted != part.FORMAT:
            reason = (
                f"compiled for format {wanted} of {part.__name__}, but eddi_runtime {__version__}"
                f" runs {part.FORMAT}: run `eddi-scaffold upgrade`"
            )
            raise ModelError(file, reason)
    try:
        with open(file, "rb") as opened:  # noqa: PTH123 - pathlib would double the time of a start
            _, mark, rest = opened.read().partition(_MARK)
    except OSError:
        return  # byte code alone, or a text that was compiled in memory
    digest, _, below = rest.partition(b"\n")
    if not mark or digest.decode("ascii", "replace") != hashlib.sha256(below).hexdigest():
        reason = "the file was changed after it was generated: run `eddi-scaffold upgrade`"
        raise ModelError(file, f"{reason} or `copier recopy --trust --force` in the package")

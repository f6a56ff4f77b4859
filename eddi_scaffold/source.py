"""Input files as bytes, read once and with a limit: the only place where models are opened."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from eddi_scaffold.problems import EddiError, Place, error

MAX_BYTES = 64 * 1024 * 1024


@dataclass(frozen=True)
class Source:
    """One input file.

    Attributes:
        name: path as the user gave it, for messages.
        data: its bytes.
    """

    name: str
    data: bytes

    @cached_property
    def sha256(self) -> str:
        """Hex digest of the bytes, for traceability."""
        return hashlib.sha256(self.data).hexdigest()

    @property
    def stem(self) -> str:
        """File name without folder and suffix."""
        return Path(self.name).stem

    @property
    def file_name(self) -> str:
        """File name without folder: what a generated file may mention."""
        return Path(self.name).name


def read_source(path: str | Path, limit: int = MAX_BYTES) -> Source:
    """Read a file.

    Raises:
        EddiError: the file is missing, unreadable, a folder, or larger than ``limit`` bytes (F001).
    """
    name = str(path)
    try:
        size = Path(path).stat().st_size
        if size > limit:
            message = f"the file has {size} bytes, more than the limit of {limit}"
            raise EddiError(error("F001", message, Place(name)))
        return Source(name, Path(path).read_bytes())
    except OSError as problem:
        reason = problem.strerror or str(problem)
        raise EddiError(error("F001", f"cannot read the file: {reason}", Place(name))) from None

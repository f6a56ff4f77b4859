"""Input files as bytes, read once and with a limit: the only place where models are opened."""

from __future__ import annotations

import hashlib
import io
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import BinaryIO

from eddi_scaffold.problems import EddiError, Place, Problem, error

MAX_BYTES = 64 * 1024 * 1024
KEPT_BYTES = 4 * 1024 * 1024
"""Larger files are not kept in memory beside what is made of them."""


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
        digest = hashlib.sha256()
        with self.open() as stream:
            while block := stream.read(1 << 20):
                digest.update(block)
        return digest.hexdigest()

    def open(self) -> BinaryIO:
        """Return the bytes as a seekable stream, which the caller closes."""
        return io.BytesIO(self.data)

    @property
    def stem(self) -> str:
        """File name without folder and suffix."""
        return Path(self.name).stem

    @property
    def file_name(self) -> str:
        """File name without folder: what a generated file may mention."""
        return Path(self.name).name


class LargeSource(Source):
    """A file that is read again each time that its bytes are asked for."""

    def __init__(self, name: str) -> None:
        object.__setattr__(self, "name", name)  # the dataclass is frozen

    @property
    def data(self) -> bytes:  # a field there, computed here
        """The bytes of the file as it is now."""
        with self.open() as stream:
            return stream.read()

    def open(self) -> BinaryIO:
        """Open the file.

        Raises:
            EddiError: it has gone since (F001).
        """
        try:
            return Path(self.name).open("rb")
        except OSError as problem:
            raise EddiError(_unreadable(self.name, problem)) from None


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
        if size > KEPT_BYTES:
            large = LargeSource(name)
            large.open().close()  # say now that it cannot be read
            return large
        return Source(name, Path(path).read_bytes())
    except OSError as problem:
        raise EddiError(_unreadable(name, problem)) from None


def _unreadable(name: str, problem: OSError) -> Problem:
    reason = problem.strerror or str(problem)
    return error("F001", f"cannot read the file: {reason}", Place(name))

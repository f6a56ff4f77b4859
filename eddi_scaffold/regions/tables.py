"""Files of bytes that belong to a package: Copier renders texts only."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from pathlib import Path

from .package import is_relative, kind_of


def place_tables(
    root: Path, rendering: Path, tables: Mapping[str, str], folder: Path | None
) -> Iterator[str]:
    """Put tables into a rendering; yields those that are missing.

    That of the rendering before is taken if it is the right one.

    Args:
        root: the package.
        rendering: folder of all its new files.
        tables: path of each in the package -> SHA-256 of its bytes.
        folder: where they are, by their names alone; ``None`` for none.

    Raises:
        OSError: a file cannot be written.
    """
    for name, digest in tables.items():
        places = [root / name, *([folder / Path(name).name] if folder is not None else [])]
        contents = (_bytes_of(place, digest) for place in places if is_relative(name))
        data = next((content for content in contents if content is not None), None)
        if data is None:
            yield name
        else:
            (rendering / name).write_bytes(data)


def _bytes_of(path: Path, digest: str) -> bytes | None:
    """Return the bytes of a file if they are the right ones."""
    try:
        data = path.read_bytes() if kind_of(path.resolve()) is None else b""
    except OSError:
        return None
    return data if hashlib.sha256(data).hexdigest() == digest else None

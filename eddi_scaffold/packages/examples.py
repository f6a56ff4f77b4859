"""The worked examples that travel with eddi-scaffold."""

from __future__ import annotations

import os
from pathlib import Path

from eddi_scaffold.packages.transaction import NEW, NEW_PROGRAM, FileState

_PACKAGE = Path(__file__).resolve().parents[1]


def described() -> dict[str, str]:
    """Return name -> the heading of its README, of every example, sorted."""
    texts = {path.parent.name: path.read_text("utf-8") for path in _folder().glob("*/README.md")}
    return {name: text.partition("\n")[0].lstrip("# ") for name, text in sorted(texts.items())}


def example_files(name: str) -> dict[str, FileState]:
    """Return the files of one example: relative path -> content."""
    folder = _folder() / name
    paths = {path.relative_to(folder).as_posix(): path for path in folder.rglob("*")}
    return {
        name: FileState(path.read_bytes(), NEW_PROGRAM if os.access(path, os.X_OK) else NEW)
        for name, path in sorted(paths.items())
        if path.is_file() and not name.startswith("expected/") and "__pycache__/" not in name
    }


def _folder() -> Path:
    """Return the folder of the checkout, or the copy in an installed wheel."""
    checkout = _PACKAGE.parent / "examples"
    return checkout if checkout.is_dir() else _PACKAGE / "_examples"

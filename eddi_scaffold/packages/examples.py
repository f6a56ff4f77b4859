"""The worked examples that travel with eddi-scaffold."""

from __future__ import annotations

import os
from pathlib import Path

from eddi_scaffold.packages.transaction import NEW, NEW_PROGRAM, FileState

_PACKAGE = Path(__file__).resolve().parents[1]


def names() -> list[str]:
    """Return the names of the examples, sorted."""
    folder = _folder()
    return (
        sorted(path.name for path in folder.iterdir() if (path / "README.md").is_file())
        if folder.is_dir()
        else []
    )


def described() -> dict[str, str]:
    """Return name -> the heading of its README, of every example."""
    texts = {name: (_folder() / name / "README.md").read_text("utf-8") for name in names()}
    return {name: text.partition("\n")[0].lstrip("# ") for name, text in texts.items()}


def example_files(name: str) -> dict[str, FileState]:
    """Return the files of one example: relative path -> content."""
    folder = _folder() / name
    found = {
        path.relative_to(folder).as_posix(): path for path in folder.rglob("*") if path.is_file()
    }
    return {
        name: FileState(path.read_bytes(), NEW_PROGRAM if os.access(path, os.X_OK) else NEW)
        for name, path in sorted(found.items())
        if not name.startswith("expected/") and "__pycache__/" not in name
    }


def _folder() -> Path:
    """Return the folder of the checkout, or the copy in an installed wheel."""
    checkout = _PACKAGE.parent / "examples"
    return checkout if checkout.is_dir() else _PACKAGE / "_examples"

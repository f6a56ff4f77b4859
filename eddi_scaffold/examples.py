"""The worked examples that travel with eddi-scaffold."""

from __future__ import annotations

from pathlib import Path

from eddi_scaffold.transaction import FileState, tree_of

_PACKAGE = Path(__file__).resolve().parent


def names() -> list[str]:
    """Return the names of the examples, sorted."""
    folder = _folder()
    return (
        sorted(path.name for path in folder.iterdir() if (path / "README.md").is_file())
        if folder.is_dir()
        else []
    )


def example_files(name: str) -> dict[str, FileState]:
    """Return the files of one example: relative path -> content."""
    return {
        path: state
        for path, state in tree_of(_folder() / name).items()
        if not path.startswith("expected/")
    }


def _folder() -> Path:
    """Return the folder of the checkout, or the copy in an installed wheel."""
    checkout = _PACKAGE.parent / "examples"
    return checkout if checkout.is_dir() else _PACKAGE / "_examples"

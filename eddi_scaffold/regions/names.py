"""The folder of a package's records: a template chooses its name before the rest is imported."""

from __future__ import annotations

folder = ".eddi"


def choose(name: str = "") -> None:
    """Take another name.

    Raises:
        SystemExit: it is no name of a hidden folder.
    """
    global folder  # noqa: PLW0603 - one process works for one template
    if not (name.startswith(".") and name[1:].replace("-", "").replace("_", "").isalnum()):
        raise SystemExit(f"--folder: {name!r} is no name such as .regions")
    if name == ".git":
        raise SystemExit("--folder: .git is git's")
    folder = name

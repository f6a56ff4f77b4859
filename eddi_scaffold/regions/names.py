"""What a template calls things: it chooses before the rest is imported."""

from __future__ import annotations

folder = ".eddi"
"""The folder of a package's records."""

upgrade = "run `eddi-scaffold upgrade` for this package, or "
"""What people can do in place of a command of Copier's; begins the sentence about that."""


def choose(name: str = "") -> None:
    """Take another name for the folder, of a template that has no commands of its own.

    Raises:
        SystemExit: it is no name of a hidden folder.
    """
    global folder, upgrade
    if not (name.startswith(".") and name[1:].replace("-", "").replace("_", "").isalnum()):
        raise SystemExit(f"--folder: {name!r} is no name such as .regions")
    if name == ".git":
        raise SystemExit("--folder: .git is git's")
    folder, upgrade = name, ""

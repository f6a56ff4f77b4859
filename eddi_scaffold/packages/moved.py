"""Packages that a person moved or removed: what was written by hand in them is still somewhere."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from eddi_scaffold.packages.rendering import ANSWERS_FILE, read_answers
from eddi_scaffold.platforms import platforms
from eddi_scaffold.problems import EddiError
from eddi_scaffold.regions.bases import BASES, FORMER, bases_of, read_bases
from eddi_scaffold.regions.files import read_regular
from eddi_scaffold.regions.git import committed_text, last_commit_with
from eddi_scaffold.regions.store import EDDI

_DEPTH = 4
"""How far below a workspace a moved package is looked for."""
_SKIPPED = {"build", "devel", "install", "log"}


def committed_base(target: Path, path: str, commit: str = "HEAD") -> str | None:
    """Return what a file in git was made of, ``None`` where git does not have it."""
    bases = bases_of(committed_text(target, f"{EDDI}/{BASES}", commit) or "")
    return bases.get(path) or committed_text(target, f"{FORMER}/{path}", commit)


def moved_out(root: Path) -> dict[str, Path]:
    """Return the monitors of a workspace that were moved out of the folder of all packages.

    Args:
        root: that folder, directly in the one of the sources.

    Returns:
        Name of the package -> where it is; none of which another one is in its place.
    """
    templates = {one.templates.monitor for one in platforms().values() if one.workspace is not None}
    return {
        answers["package"]: place
        for place, answers in _monitors_below(root.parent)
        if str(answers["template"]) in templates
        and place.parent != root
        and not (root / answers["package"]).exists()
    }


def _monitors_below(top: Path) -> Iterator[tuple[Path, Mapping[str, Any]]]:
    """Yield the packages of monitors near the top of a folder, with their answers."""
    for root, folders, files in os.walk(top):
        here = Path(root)
        found = ANSWERS_FILE in files
        if found or len(here.relative_to(top).parts) >= _DEPTH:
            folders.clear()
        folders[:] = sorted(one for one in folders if one[0] != "." and one not in _SKIPPED)
        if found:
            with suppress(EddiError):  # told where the package is used
                answers = read_answers(here) or {}
                if "model_json" in answers and isinstance(answers.get("package"), str):
                    yield here, answers


def way_back(place: Path, target: Path) -> str:
    """Return the command that brings a moved package, or the folder of all packages, back."""
    whole = not target.parent.exists() and place.name == target.name
    old, new = (place.parent, target.parent) if whole else (place, target)
    return shlex.join(["mv", str(old), str(new)])


def gone(root: Path, folder: str, top: Path) -> str | None:
    """Return what is to be said of a package that is made and was there before, with hand edits.

    Args:
        root: folder of all packages.
        folder: of the package, in which there is nothing.
        top: where a person may have moved it: workspace, or folder of all packages.
    """
    target = root / folder
    end = "its hand-written lines are not in the new package"
    for place, answers in _monitors_below(top):
        if answers["package"] == folder and place != target and _own_lines(place):
            command = f"{shlex.join(['rm', '-r', str(target)])} && {way_back(place, target)}"
            where = f"{folder} was here and is gone (moved to {place}?)"
            return f"{where}: {end}; `{command}` brings them back"
    commit = last_commit_with(target, f"{EDDI}/{BASES}")
    lines = _own_lines(target, commit) if commit is not None else set()
    if commit is None or not lines or _are_beside(root, lines):
        return None
    command = shlex.join(["git", "-C", str(root), "checkout", commit, "--", folder])
    return f"{folder} was here and is gone: {end}; `{command}` brings them back"


def _own_lines(package: Path, commit: str | None = None) -> set[str]:
    """Return the lines of the editable files of a package that were not generated."""
    if commit is None:
        bases = read_bases(package)
        texts = {name: _text(package / name) for name in bases}
    else:
        bases = bases_of(committed_text(package, f"{EDDI}/{BASES}", commit) or "")
        texts = {name: committed_text(package, name, commit) or "" for name in bases}
    return {
        line
        for name, base in bases.items()
        for line in set(texts[name].splitlines()) - set(base.splitlines())
    }


def _are_beside(root: Path, lines: set[str]) -> bool:
    """Return whether a package of another name has these lines: a declared rename took them."""
    folders = (answers.parent for answers in root.glob(f"*/{ANSWERS_FILE}"))
    return any(
        lines <= {line for name in read_bases(one) for line in _text(one / name).splitlines()}
        for one in folders
    )


def _text(path: Path) -> str:
    try:
        return read_regular(path).decode("utf-8", "replace")
    except OSError:
        return ""

"""Editable files that are links: the link stays, and the file that it leads to gets the merge."""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping
from pathlib import Path

from eddi_scaffold.packages.transaction import FileState, FolderContent
from eddi_scaffold.regions.bases import read_bases
from eddi_scaffold.regions.files import LINK, kind_of, read_regular, resolved
from eddi_scaffold.regions.marked_file import parse
from eddi_scaffold.regions.paths import is_relative
from eddi_scaffold.regions.store import EDDI, read_text


def follow(
    package: Path,
    tree: FolderContent,
    rendered: Collection[str],
    within: Path | None,
    taken: Collection[Path] = (),
) -> Mapping[str, Path]:
    """Take the text behind links to editable files for theirs; return link -> real file.

    A link may lead to any file of the package that we do not write ourselves. Out of the package it
    may lead only below the folder that the person named, and to a file with regions of this one:
    a package may be a stranger's, and name whatever it likes.

    Args:
        package: its folder.
        tree: what is in it; the links that are followed become files.
        rendered: the files that the package will have.
        within: the folder that was named, ``None`` for the package alone.
        taken: files that links of other packages lead to: one merge for each.
    """
    found: dict[str, Path] = {}
    for link in [path for path, kind in tree.others.items() if kind == LINK]:
        if f"{EDDI}/pristine/{link}" not in rendered:
            continue
        real = _real(package, link, rendered, within)
        if real is None or real in {*found.values(), *taken}:
            continue
        try:
            state = FileState(read_regular(real, follow=False), real.stat().st_mode & 0o777)
        except OSError:
            continue
        found[link] = real
        tree.files[link] = state
        del tree.others[link]
    return found


def _real(package: Path, link: str, rendered: Collection[str], within: Path | None) -> Path | None:
    top = Path(os.path.realpath(package))
    real = resolved(top, package / link)
    if real is None and within is not None and _is_of_this_file(package, link):
        top = Path(os.path.realpath(within))
        real = resolved(top, package / link)
    if real is None or kind_of(real) is not None or not real.is_file():
        return None
    name = real.relative_to(top).as_posix()
    ours = EDDI in name.split("/") or os.path.relpath(real, os.path.realpath(package)) in rendered
    return real if is_relative(name) and not ours else None


def _is_of_this_file(package: Path, link: str) -> bool:
    """Return whether the file behind a link has a region of the file that is in its place."""
    texts = read_text(package / link), read_bases(package).get(link)
    mine, base = (parse(text)[0].regions.keys() if isinstance(text, str) else () for text in texts)
    return bool(set(mine) & set(base))

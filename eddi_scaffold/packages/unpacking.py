"""Take the templates out of git once per command.

Copier clones its source for every package that it renders, which costs more than all the rest. A
plain folder it takes as it is; what it would then not know (the recorded path and commit) is kept
here.
"""

from __future__ import annotations

import io
import os
import shutil
import tarfile
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from eddi_scaffold.common.problems import EddiError, problem
from eddi_scaffold.regions.git import GitError, git

PATHS = ("copier.yml", "copier_templates", "runtime_lib/src")
"""All that rendering reads; the tasks, which need more, do not run from here."""
MADE_BY = (*PATHS, "eddi_scaffold/regions")
"""All that the files of a package come from, but for the answers."""
_MEMORY = Path("/dev/shm")  # noqa: S108 - `mkdtemp` makes a folder that only its user reads
_ENOUGH = 512 * 2**20  # five hundred packages need a quarter of it


@dataclass(frozen=True)
class Unpacked:
    """Templates of one version, for the time of one command."""

    commit: str | None  # what Copier would record as `_commit`; `None` without git
    changed: bool  # they are not exactly those of the commit
    unpack: Callable[[], Path]  # puts them into a plain folder and returns it; see `folder`

    @cached_property
    def folder(self) -> Path:
        """Return where they lie, unpacked when first asked for."""
        return self.unpack()

    @property
    def notes(self) -> tuple[str, ...]:
        """Return what the user should know of them."""
        note = "the templates have uncommitted changes, which are included"
        return (note,) if self.commit is not None and self.changed else ()


def scratch_folder(prefix: str) -> tempfile.TemporaryDirectory[str]:
    """Make a folder that is gone at the end of the ``with``: in memory, or where ``TMPDIR`` says.

    A large upgrade makes thousands of small files; on a disk that is half of the time.
    """
    place = None if any(map(os.environ.get, ("TMPDIR", "TEMP", "TMP"))) else _MEMORY
    try:
        free = shutil.disk_usage(place).free if place else 0
    except OSError:
        free = 0
    usable = free >= _ENOUGH and os.access(_MEMORY, os.W_OK | os.X_OK)
    return tempfile.TemporaryDirectory(prefix=prefix, dir=place if usable else None)


@contextmanager
def unpacked(location: Path, ref: str | None) -> Iterator[Unpacked]:
    """Unpack the templates of one version.

    The location is a git checkout, a git bundle or (without ``ref``) a plain folder, and may begin
    with ``~``. ``HEAD`` of a checkout includes uncommitted changes, as with Copier.

    Raises:
        EddiError: git is missing (T001) or refuses (T004).
    """
    place = location.expanduser()
    if ref is None:
        yield Unpacked(None, True, lambda: place)
        return
    with scratch_folder("eddi-templates-") as scratch:
        if place.is_file():
            templates = Path(scratch, "bundle.git")
            words = ("clone", "--quiet", "--bare", "--", str(place.absolute()), str(templates))
            _git(None, *words, GIT_ALLOW_PROTOCOL="file")
        else:
            templates = place / ".git"
        commit = _git(templates, "describe", "--tags", "--always", ref).decode().strip()
        changed = ref == "HEAD" and bool(_git(templates, "status", "--porcelain", "--", *MADE_BY))

        def unpack() -> Path:
            folder = Path(scratch, "templates")
            if changed:
                _copy(place, folder)
                return folder
            words = ("-c", "tar.umask=0022", "archive", ref, "--", *PATHS)
            with tarfile.open(fileobj=io.BytesIO(_git(templates, *words))) as tar:
                if hasattr(tarfile, "data_filter"):
                    tar.extractall(folder, filter="data")
                else:  # Python 3.10 before 3.10.12; what git archives of our own is harmless
                    tar.extractall(folder)  # noqa: S202
            return folder

        yield Unpacked(commit, changed, unpack)


def _copy(checkout: Path, folder: Path) -> None:
    """Copy the working tree: of a checkout Copier itself would make a clone."""
    ignored = shutil.ignore_patterns("__pycache__", "*.pyc")
    for name in PATHS:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        if (checkout / name).is_dir():
            shutil.copytree(checkout / name, folder / name, symlinks=True, ignore=ignored)
        else:
            shutil.copy(checkout / name, folder / name)


def _git(templates: Path | None, *words: str, **environment: str) -> bytes:
    work_tree = templates.parent if templates is not None else None
    try:
        return git(*words, repository=templates, work_tree=work_tree, environment=environment)
    except FileNotFoundError:
        raise EddiError(problem("T001.git")) from None
    except GitError as refused:
        where = f" at {work_tree}" if work_tree else ""
        raise EddiError(problem("T004.git", where=where, reason=refused)) from None

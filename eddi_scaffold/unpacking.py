"""Take the templates out of git once per command.

Copier clones its source for every package that it renders, which costs more than all the rest. A
plain folder it takes as it is; what it would then not know (the recorded path and commit) is kept
here.
"""

from __future__ import annotations

import io
import os
import subprocess
import tarfile
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from eddi_scaffold.problems import EddiError, error

PATHS = ("copier.yml", "copier_templates", "runtime_lib/src")
"""All that rendering reads; the tasks, which need more, do not run from here."""
_PLACES_OF_GIT = (
    "GIT_DIR",
    "GIT_WORK_TREE",
    "GIT_INDEX_FILE",
    "GIT_OBJECT_DIRECTORY",
    "GIT_ALTERNATE_OBJECT_DIRECTORIES",
    "GIT_COMMON_DIR",
    "GIT_PREFIX",
)
"""Set while a git hook runs, and then about the user's repository, not the templates'."""


@dataclass(frozen=True)
class Unpacked:
    """Templates in a plain folder.

    Attributes:
        folder: where they lie, for the time of one command.
        commit: what Copier would record as ``_commit``; ``None`` without git.
        notes: what the user should know of them.
    """

    folder: Path
    commit: str | None = None
    notes: tuple[str, ...] = ()


@contextmanager
def unpacked(location: str, ref: str | None) -> Iterator[Unpacked]:
    """Unpack the templates of one version.

    Args:
        location: git checkout, git bundle or (without ``ref``) plain folder; may begin with ``~``.
        ref: git reference. ``HEAD`` of a checkout includes uncommitted changes, as with Copier.

    Raises:
        EddiError: git is missing (T003) or refuses (T004).
    """
    place = Path(location).expanduser()
    if ref is None:
        yield Unpacked(place)
        return
    with tempfile.TemporaryDirectory(prefix="eddi-templates-") as scratch:
        repository = place
        if place.is_file():
            repository = Path(scratch, "bundle.git")
            _git(Path(scratch), "clone", "--quiet", "--bare", "--", str(place), str(repository))
        commit = _git(repository, "describe", "--tags", "--always", ref).decode().strip()
        folder = Path(scratch, "templates")
        changed = ref == "HEAD" and _git(repository, "status", "--porcelain", "--", *PATHS)
        archive = _changed(repository, Path(scratch)) if changed else _archive(repository, ref)
        _extract(archive, folder)
        notes = ("the templates have uncommitted changes, which are included",) if changed else ()
        yield Unpacked(folder, commit, notes)


def _archive(repository: Path, tree: str, **environment: str) -> bytes:
    words = ("-c", "tar.umask=0022", "archive", tree, "--", *PATHS)
    return _git(repository, *words, **environment)


def _changed(repository: Path, scratch: Path) -> bytes:
    """Archive the working tree, by way of an index and objects of our own."""
    objects = _git(repository, "rev-parse", "--git-path", "objects").decode().strip()
    own = {
        "GIT_INDEX_FILE": str(scratch / "index"),
        "GIT_OBJECT_DIRECTORY": str(scratch / "objects"),
        "GIT_ALTERNATE_OBJECT_DIRECTORIES": str(repository / objects),
    }
    (scratch / "objects").mkdir()
    _git(repository, "add", "--all", "--", *PATHS, **own)
    tree = _git(repository, "write-tree", **own).decode().strip()
    return _archive(repository, tree, **own)


def _extract(archive: bytes, folder: Path) -> None:
    with tarfile.open(fileobj=io.BytesIO(archive)) as tar:
        if hasattr(tarfile, "data_filter"):
            tar.extractall(folder, filter="data")
        else:  # Python 3.10 before 3.10.12; what git archives of our own templates is harmless
            tar.extractall(folder)  # noqa: S202


def _git(folder: Path, *arguments: str, **environment: str) -> bytes:
    kept = {key: value for key, value in os.environ.items() if key not in _PLACES_OF_GIT}
    try:
        done = subprocess.run(
            ["git", "-C", str(folder), *arguments],
            env={**kept, **environment},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            check=True,
        )
    except FileNotFoundError:
        message = "git is not installed, the templates cannot be read"
        raise EddiError(error("T003", message, hint="apt-get install git")) from None
    except subprocess.CalledProcessError as refused:
        reason = refused.stderr.decode("utf-8", "replace").strip()
        message = f"git cannot read the templates at {folder}: {reason}"
        raise EddiError(error("T004", message)) from None
    return done.stdout

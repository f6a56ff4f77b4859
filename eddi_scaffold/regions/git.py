"""Git: the one place of the project that starts a program.

A package may be a stranger's, as may the repository around it. So git never looks for a repository:
it is given the one that is meant, and a folder that merely looks like a bare one is none. What the
repository's own configuration could make it start (transports, hooks, a file system monitor) is
off; ``cat-file`` runs neither filters nor a pager.
"""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

_NAME = ".git"
_LIMIT_S = 60.0
_SIDES = ("MERGE_HEAD", "CHERRY_PICK_HEAD", "REBASE_HEAD")
"""The other branch of a merge under way."""
_SETTINGS = (
    "safe.bareRepository=explicit",
    "core.hooksPath=/dev/null",
    "core.fsmonitor=",  # before git 2.36 a command, and only empty no command
)
_ENVIRONMENT = {
    "GIT_ALLOW_PROTOCOL": "",  # no transport; stronger than what a configuration allows
    "GIT_NO_LAZY_FETCH": "1",
    "GIT_NO_REPLACE_OBJECTS": "1",
    "GIT_OPTIONAL_LOCKS": "0",
    "GIT_TERMINAL_PROMPT": "0",
    "LC_ALL": "C",
}


class GitError(Exception):
    """Git ran and refused; the text is its message."""


@dataclass(frozen=True)
class Repository:
    """A repository that git itself made around a folder.

    Attributes:
        work_tree: the folder that holds ``.git``.
        git_dir: ``.git`` itself, or the folder that it names.
    """

    work_tree: Path
    git_dir: Path


def git(
    *words: str,
    repository: Path | None,
    work_tree: Path | None = None,
    environment: Mapping[str, str] | None = None,
    limit_s: float = _LIMIT_S,
) -> bytes:
    """Run one git command.

    Args:
        words: the command and its arguments.
        repository: the ``.git`` folder or bare repository it is about; ``None`` for a command that
            makes one.
        work_tree: the folder of its files, and of relative paths.
        environment: what is set besides, or in place of what keeps git from starting programs.
        limit_s: how long an answer may take: a configuration can name a pipe.

    Raises:
        FileNotFoundError: git is not installed.
        GitError: it refused, or took too long.
    """
    places = [f"--git-dir={repository.absolute()}"] if repository is not None else []
    places += [f"--work-tree={work_tree.absolute()}"] if work_tree is not None else []
    settings = [word for setting in _SETTINGS for word in ("-c", setting)]
    kept = {key: value for key, value in os.environ.items() if not key.startswith("GIT_")}
    try:
        return subprocess.run(
            ["git", "--no-pager", *settings, *places, *words],
            cwd=work_tree or os.sep,
            env={**kept, **_ENVIRONMENT, **(environment or {})},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            check=True,
            timeout=limit_s,
        ).stdout
    except subprocess.CalledProcessError as refused:
        raise GitError(refused.stderr.decode("utf-8", "replace").strip()) from None
    except subprocess.TimeoutExpired:
        raise GitError(f"no answer in {limit_s:g} s") from None


def git_dir_of(work_tree: Path) -> Path:
    """Return where the repository of a trusted folder is: its ``.git``, or what that names."""
    entry = work_tree / _NAME
    return _named_in(entry) or entry


def repository_of(folder: Path) -> Repository | None:
    """Return the repository around a folder of anybody's, ``None`` without one to be trusted.

    It is the next ``.git`` up the tree: a folder, or the file of a linked worktree or a submodule,
    where that repository agrees. As git does, it must belong to the person.
    """
    real = Path(os.path.realpath(folder))
    for place in (real, *real.parents):
        if os.path.lexists(place / _NAME):
            git_dir = _git_dir(place)
            own = git_dir is not None and all(map(_is_own, (place, place / _NAME, git_dir)))
            return Repository(place, git_dir) if git_dir is not None and own else None
    return None


def former_lines(folder: Path, path: str) -> list[bytes]:
    """Return every line that a file of ours ever had, in any commit of any branch.

    Args:
        folder: a real package, no scratch copy.
        path: the file, relative to it.
    """
    words = (
        "log",
        "--all",
        "-p",
        "-m",
        "--no-color",
        "--no-ext-diff",
        "--no-textconv",
        "--no-show-signature",
        "--format=",
    )
    history = _asked(folder, path, lambda place: (*words, "--", place))
    lines = (line for line in history.splitlines() if line[:1] == b"+")
    return [line[1:] for line in lines if line[:4] != b"+++ "]


def ancestor_bytes(folder: Path, path: str) -> bytes:
    """Return the common ancestor of a file in conflict, nothing where there is none."""
    return _shown(folder, path, ":1")


def side_bytes(folder: Path, path: str) -> list[bytes]:
    """Return the versions of a file on both sides of a merge: under way, or the last commit."""
    found = repository_of(folder)
    if found is None:
        return []
    heads = [name for name in _SIDES if (found.git_dir / name).is_file()]
    sides = ("HEAD", heads[0]) if heads else ("HEAD^1", "HEAD^2")
    return [data for side in sides if (data := _shown(folder, path, side))]


def _shown(folder: Path, path: str, commit: str) -> bytes:
    return _asked(folder, path, lambda place: ("cat-file", "blob", f"{commit}:{place}"))


def _asked(folder: Path, path: str, words: Callable[[str], Sequence[str]]) -> bytes:
    found = repository_of(folder)
    if found is None:
        return b""
    place = (Path(os.path.realpath(folder)).relative_to(found.work_tree) / path).as_posix()
    try:
        return git(*words(place), repository=found.git_dir)
    except (OSError, GitError):
        return b""


def _git_dir(place: Path) -> Path | None:
    """Return the repository that ``.git`` in a folder is or names, as far as git would make it."""
    entry = place / _NAME
    if entry.is_symlink():
        return None
    if entry.is_dir():
        return entry
    named = _named_in(entry)
    if named is None or not (_is_worktree(named, entry) or _is_submodule(named, place)):
        return None
    return named


def _named_in(entry: Path) -> Path | None:
    """Return the folder that a ``.git`` file names."""
    return next((_from(entry.parent, line[8:]) for line in _lines(entry, "gitdir: ")), None)


def _is_worktree(git_dir: Path, entry: Path) -> bool:
    named_back = (_from(git_dir, line) for line in _lines(git_dir / "gitdir"))
    return git_dir.parent.name == "worktrees" and entry in named_back


def _is_submodule(git_dir: Path, place: Path) -> bool:
    around = repository_of(place.parent)
    return around is not None and git_dir.is_relative_to(around.git_dir / "modules")


def _lines(file: Path, start: str = "") -> Iterator[str]:
    """Return the one line of a small file of git's, nothing where it is something else."""
    try:
        text = file.read_text("utf-8") if file.is_file() and file.stat().st_size < 4096 else ""
    except (OSError, UnicodeDecodeError):
        return
    line = text.rstrip("\n")
    if line.startswith(start) and line.isprintable():
        yield line


def _from(folder: Path, name: str) -> Path:
    return Path(os.path.realpath(folder / name))


def _is_own(path: Path) -> bool:
    user = os.geteuid()
    behind_sudo = os.environ.get("SUDO_UID", "") if user == 0 else ""
    try:
        return str(path.stat().st_uid) in {str(user), behind_sudo}
    except OSError:
        return False

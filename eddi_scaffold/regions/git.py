"""Git: the one place of the project that starts a program.

A package may be a stranger's, as may the repository around it. What a configuration could make git
start (transports, hooks, a file system monitor, a pager, filters) is off; git itself checks whose
the repository is, and a folder that merely looks like a bare one is none.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

_SETTINGS = (
    *("-c", "safe.bareRepository=explicit"),
    *("-c", "core.hooksPath=/dev/null"),
    *("-c", "core.fsmonitor="),  # before git 2.36 a command, and only empty no command
)
_ENVIRONMENT = {
    "GIT_ALLOW_PROTOCOL": "",  # no transport; stronger than what a configuration allows
    "GIT_NO_LAZY_FETCH": "1",
    "GIT_NO_REPLACE_OBJECTS": "1",
    "GIT_OPTIONAL_LOCKS": "0",
    "GIT_TERMINAL_PROMPT": "0",
    "LC_ALL": "C",
}
_HISTORY = "log --all -p -m --no-color --no-ext-diff --no-textconv --no-show-signature --format="


class GitError(Exception):
    """Git ran and refused; the text is its message."""


def git(
    *words: str,
    folder: Path | None = None,
    repository: Path | None = None,
    work_tree: Path | None = None,
    environment: Mapping[str, str] | None = None,
    limit_s: float = 60.0,
) -> bytes:
    """Run one git command.

    Args:
        words: the command and its arguments.
        folder: where it runs, and looks for its repository.
        repository: that of a trusted folder: whose it is, is not asked.
        work_tree: the folder of its files, and of relative paths.
        environment: what is set besides, or in place of what keeps git from starting programs.
        limit_s: how long an answer may take: a configuration can name a pipe.

    Raises:
        FileNotFoundError: git is not installed.
        GitError: it refused, or took too long.
    """
    import subprocess  # noqa: PLC0415 - a sync of Copier's seldom asks

    places = [f"--git-dir={repository.absolute()}"] if repository is not None else []
    places += [f"--work-tree={work_tree.absolute()}"] if work_tree is not None else []
    variables = {key: value for key, value in os.environ.items() if not key.startswith("GIT_")}
    try:
        return subprocess.run(
            ["git", "--no-pager", *_SETTINGS, *places, *words],
            cwd=folder or work_tree or os.sep,
            env={**variables, **_ENVIRONMENT, **(environment or {})},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            check=True,
            timeout=limit_s,
        ).stdout
    except subprocess.CalledProcessError as refused:
        raise GitError(refused.stderr.decode("utf-8", "replace").strip()) from None
    except subprocess.TimeoutExpired:
        raise GitError(f"no answer in {limit_s:g} s") from None


def former_lines(package: Path, path: str) -> list[bytes]:
    """Return every line that a file of a package ever had, in any commit of any branch."""
    history = _asked(package, *_HISTORY.split(), "--", path).splitlines()
    return [line[1:] for line in history if line[:1] == b"+" and line[:4] != b"+++ "]


def version(package: Path, path: str, commit: str) -> bytes:
    """Return a file of a package as it is in a commit or the index; nothing where it is not."""
    return _asked(package, "cat-file", "blob", f"{commit}:./{path}")


def both_sides(package: Path, path: str) -> list[bytes]:
    """Return the versions of a file on both sides of a merge: under way, or the last commit."""
    for other in ("MERGE_HEAD", "CHERRY_PICK_HEAD", "REBASE_HEAD"):
        if theirs := version(package, path, other):
            return [version(package, path, "HEAD"), theirs]
    return [version(package, path, side) for side in ("HEAD^1", "HEAD^2")]


def _asked(package: Path, *words: str) -> bytes:
    try:
        return git(*words, folder=package)
    except (OSError, GitError):
        return b""

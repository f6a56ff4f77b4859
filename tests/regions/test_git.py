"""Git reads what was committed, and starts nothing of a repository's."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from eddi_scaffold.regions import git as tool
from eddi_scaffold.regions.git import GitError, former_lines
from tests.checkouts import git

TEXT = "was: ä\r\n"
LINES = ["was: ä".encode()]


@pytest.fixture
def work(tmp_path: Path) -> Path:
    """A repository with one file, deep in it."""
    folder = tmp_path / "work"
    (folder / "src" / "pkg").mkdir(parents=True)
    (folder / "src" / "pkg" / "a.py").write_bytes(TEXT.encode())
    (folder / "src" / "pkg" / "latin.py").write_bytes(b"\xe4")
    (folder / ".gitattributes").write_text("*.py text eol=lf filter=upper diff=upper\n")
    git(folder, "-c", "core.autocrlf=false", "init", "--quiet", "--initial-branch=main")
    (folder / ".gitattributes").rename(folder / "later")
    git(folder, "add", "--all")
    git(folder, "commit", "--quiet", "--message", "All")
    (folder / "later").rename(folder / ".gitattributes")
    return folder


def test_a_committed_file_is_read_byte_for_byte(work: Path) -> None:
    mark = work.parent / "MARK"
    keys = ("filter.upper.smudge", "filter.upper.process", "diff.upper.textconv")
    for key in (*keys, "diff.upper.command", "gpg.program"):
        git(work, "config", key, f"touch {mark}; tr a-z A-Z")
    git(work, "config", "log.showSignature", "true")
    (work / "src" / "pkg" / "a.py").write_text("now\n")
    assert former_lines(work / "src" / "pkg", "a.py") == LINES
    assert former_lines(work, "src/pkg/a.py") == LINES
    assert former_lines(work / "src/pkg", "latin.py") == [b"\xe4"]
    assert not mark.exists()


def test_a_folder_is_found_by_a_link_as_a_worktree_and_as_a_submodule(
    work: Path, tmp_path: Path
) -> None:
    (tmp_path / "link").symlink_to(work / "src" / "pkg")
    git(work, "worktree", "add", "--quiet", str(tmp_path / "other"))
    above = tmp_path / "above"
    above.mkdir()
    git(above, "init", "--quiet", "--initial-branch=main")
    git(above, "-c", "protocol.file.allow=always", "submodule", "--quiet", "add", str(work), "sub")
    for folder in ("link", "other/src/pkg", "above/sub/src/pkg"):
        assert former_lines(tmp_path / folder, "a.py") == LINES


def test_where_there_is_nothing_there_is_no_text(
    work: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert former_lines(work / "src" / "pkg", "none.py") == []
    assert former_lines(tmp_path, "a.py") == []
    monkeypatch.setenv("PATH", str(work))  # without git
    assert former_lines(work / "src" / "pkg", "a.py") == []


def test_variables_of_a_hook_do_not_count(work: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A hook sets GIT_DIR, which is about the user's repository."""
    for name in ("GIT_DIR", "GIT_OBJECT_DIRECTORY", "GIT_EXEC_PATH", "GIT_CONFIG_COUNT"):
        monkeypatch.setenv(name, "elsewhere")
    assert former_lines(work / "src" / "pkg", "a.py") == LINES


def test_neither_a_monitor_nor_a_hook_of_the_repository_is_started(work: Path) -> None:
    mark = work.parent / "MARK"
    git(work, "config", "core.fsmonitor", f"touch {mark}; false")
    hook = work / ".git" / "hooks" / "post-index-change"
    hook.parent.mkdir(exist_ok=True)
    hook.write_text(f"#!/bin/sh\ntouch {mark}\n")
    hook.chmod(0o755)
    for words in (["status", "--porcelain"], ["add", "--all"]):
        tool.git(*words, repository=work / ".git", work_tree=work)
        assert not mark.exists(), words
    git(work, "add", "--all")
    assert mark.exists(), "the hook is one"


def test_a_pipe_in_a_configuration_is_not_waited_for(work: Path) -> None:
    os.mkfifo(work / ".git" / "pipe")
    git(work, "config", "include.path", "pipe")
    with pytest.raises(GitError, match="no answer"):
        tool.git("cat-file", "blob", "HEAD:a", repository=work / ".git", limit_s=0.5)
    with pytest.raises(GitError, match="not a git repository"):
        tool.git("cat-file", "blob", "HEAD:a", repository=work.parent)

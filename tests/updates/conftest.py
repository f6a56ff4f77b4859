"""Real Copier and real git, in a home of their own."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.quick_copier import render_faster
from tests.updates.templates import Templates, make_templates


@pytest.fixture(scope="session")
def fast_folder() -> Iterator[Path]:
    """A folder in memory where that is possible, whose path anybody may follow."""
    with tempfile.TemporaryDirectory(prefix="eddi-updates-") as folder:
        yield Path(folder)


@pytest.fixture(scope="session", autouse=True)
def own_home(fast_folder: Path) -> Iterator[None]:
    """Keep the tester's git and Copier settings out, and the tests out of them."""
    home = fast_folder / "home"
    home.mkdir()
    (home / ".gitconfig").write_text(
        "[user]\nname = Tester\nemail = tester@localhost\n[init]\ndefaultBranch = main\n"
        "[core]\nfsync = none\n[gc]\nauto = 0\n"
        "[safe]\ndirectory = *\n[advice]\ndetachedHead = false\n"
    )
    with pytest.MonkeyPatch.context() as patch:
        for name in [name for name in os.environ if name.startswith(("GIT_", "COPIER_", "XDG_"))]:
            patch.delenv(name)
        patch.setenv("HOME", str(home))
        patch.setenv("GIT_CONFIG_NOSYSTEM", "1")
        patch.setenv("TMPDIR", str(fast_folder))
        patch.setattr(tempfile, "tempdir", None)
        yield


@pytest.fixture(scope="session", autouse=True)
def faster() -> None:
    render_faster()


@pytest.fixture(scope="session")
def templates(fast_folder: Path, own_home: None) -> Templates:
    return make_templates(fast_folder / "templates")


@pytest.fixture
def folder(fast_folder: Path) -> Iterator[Path]:
    with tempfile.TemporaryDirectory(dir=fast_folder) as name:
        yield Path(name)

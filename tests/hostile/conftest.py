"""One generated workspace for all tests of hostile ones."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.hostile import special
from tests.hostile.world import World, build


@pytest.fixture
def limited() -> Iterator[None]:
    """Time and memory have limits."""
    with special.limited():
        yield


@pytest.fixture(scope="session")
def friendly(tmp_path_factory: pytest.TempPathFactory) -> World:
    """The world that is copied; leave it as it is."""
    return build(tmp_path_factory.mktemp("friendly") / "world")


@pytest.fixture
def world(friendly: World, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> World:
    """A copy, whose home folder is the person's, as are temporary folders."""
    world = friendly.copy(tmp_path / "world")
    monkeypatch.setenv("HOME", str(world.home))
    monkeypatch.setattr(tempfile, "tempdir", str(world.scratch))
    for name in ("XDG_CACHE_HOME", "XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_STATE_HOME"):
        monkeypatch.delenv(name, raising=False)
    return world

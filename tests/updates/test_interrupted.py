"""`copier update` is killed when the answers name the new version and the files are old."""

from __future__ import annotations

import contextlib
import os
import signal
import time
from pathlib import Path

import pytest

from eddi_scaffold.regions.sync import sync_package
from tests.updates.templates import Templates
from tests.updates.world import CHANGED, START, World, edited_world, forked, snapshot

pytestmark = pytest.mark.slow


@pytest.fixture
def world(templates: Templates, folder: Path) -> World:
    world = edited_world(templates, folder)
    world.edit_outside("helper")
    world.commit()
    return world


def kill_when_answered(world: World) -> None:
    """Kill an update at the moment when the answers are the new ones."""
    answers = world.package / ".copier-answers.yml"
    before = answers.read_bytes()
    world.commit()
    child = forked(world.update)
    while True:
        now = answers.read_bytes()
        if now != before and now.endswith(b"\n"):
            break
        assert os.waitpid(child, os.WNOHANG) == (0, 0), "it was not killed in time"
        time.sleep(0.0005)
    os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)


def put_back_what_was_old(world: World, before: dict[str, bytes]) -> None:
    """Make it the worst moment: no file but the answers is new."""
    for name, data in before.items():
        if not name.endswith((".copier-answers.yml", "updating.yml")):
            (world.package / name).write_bytes(data)


@pytest.mark.parametrize("worst", [False, True])
def test_the_next_update_says_it_and_the_one_after_it_takes_it_up(
    world: World, capfd: pytest.CaptureFixture[str], worst: bool
) -> None:
    before = snapshot(world.package)
    world.change(*CHANGED)
    world.version += 1
    kill_when_answered(world)
    if worst:
        put_back_what_was_old(world, before)
    world.seen = [START, CHANGED]
    world.check(finished=False)
    capfd.readouterr()
    assert world.update().status == 1
    assert "the last update was interrupted" in capfd.readouterr().err
    assert (world.package / ".copier-answers.yml").read_bytes() == before[".copier-answers.yml"]
    assert world.update().status == 0
    world.settle()
    world.check()
    assert "Second look" in world.text()
    assert not (world.package / ".eddi/updating.yml").exists()
    assert sync_package(world.package).touched == ()


@pytest.mark.parametrize("operation", ["copy", "recopy", "generate", "upgrade"])
def test_any_other_command_takes_it_up_at_once(world: World, operation: str) -> None:
    before = snapshot(world.package)
    world.change(*CHANGED)
    world.version += 1
    kill_when_answered(world)
    put_back_what_was_old(world, before)
    world.seen = [START, CHANGED]
    assert getattr(world, operation)().status in {0, 3}
    world.settle()
    world.check()
    assert "Second look" in world.text()
    assert not (world.package / ".eddi/updating.yml").exists()
    assert world.update().status == 0


def test_an_update_that_changed_nothing_is_no_obstacle(world: World) -> None:
    """Copier stopped for a reason of its own, or the files were put back by git."""
    (world.package / ".eddi/updating.yml").write_bytes(
        (world.package / ".copier-answers.yml").read_bytes()
    )
    world.change(*CHANGED)
    world.version += 1
    assert world.update().status == 0
    with contextlib.suppress(FileNotFoundError):
        pytest.fail((world.package / ".eddi/updating.yml").read_text())
    world.settle()
    world.check()

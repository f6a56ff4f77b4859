"""Links, lock files, sockets and modes of a person, with plain Copier as with our own commands."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import pytest

from tests.hostile.special import a_socket
from tests.updates.templates import Templates
from tests.updates.world import CHANGED, World, edited_world, operations_of

pytestmark = pytest.mark.slow


@pytest.fixture
def world(templates: Templates, folder: Path) -> World:
    world = edited_world(templates, folder)
    world.edit_outside("helper")
    return world


def links(package: Path) -> dict[str, str]:
    return {
        path.relative_to(package).as_posix(): str(path.readlink())
        for path in sorted(package.rglob("*"))
        if path.is_symlink()
    }


@pytest.mark.parametrize("operation", operations_of(1))
def test_what_lies_about_stops_nothing(world: World, operation: str) -> None:
    package, outside = world.package, world.folder / "outside"
    outside.mkdir()
    (outside / "recording.csv").write_text("mine\n")
    (package / ".#EDDIInput.py").symlink_to("somebody@somewhere.4711:1")
    (package / "gone").symlink_to("nowhere")
    (package / "data").symlink_to(outside)
    (package / "test/loop").symlink_to("loop")
    a_socket(package / "talk")
    os.mkfifo(package / "pipe")
    before = links(package)
    world.change(*CHANGED)
    world.version += 1
    result = getattr(world, operation)()
    assert result.status in {0, 3}, result
    assert links(package) == before
    assert stat.S_ISSOCK((package / "talk").stat().st_mode)
    assert stat.S_ISFIFO((package / "pipe").stat().st_mode)
    assert [path.name for path in outside.iterdir()] == ["recording.csv"]
    (package / "pipe").unlink()  # the check below opens files
    (package / "talk").unlink()
    world.settle()
    world.check()


@pytest.mark.parametrize(
    ("mode", "operation"),
    [(m, one) for k, m in enumerate((0o600, 0o664, 0o755)) for one in operations_of(k)],
)
def test_modes_stay(world: World, operation: str, mode: int) -> None:
    world.change_mode(mode)
    names = ("EDDIMonitor.py", "README.md")
    for name in names:
        (world.package / name).chmod(mode)
    world.change(*CHANGED)
    world.version += 1
    assert getattr(world, operation)().status in {0, 3}
    world.settle()
    world.check()
    assert {(world.package / name).stat().st_mode & 0o777 for name in names} == {mode}


@pytest.mark.parametrize("operation", operations_of(0))
def test_a_link_in_the_place_of_the_input_module_stays_one(world: World, operation: str) -> None:
    world.toggle_link()
    world.change_mode(0o640)
    world.change(*CHANGED)
    world.version += 1
    assert getattr(world, operation)().status in {0, 3}
    world.settle()
    world.check()
    assert "Second look" in world.text()


@pytest.mark.parametrize("operation", operations_of(1))
def test_a_link_out_of_the_package_is_left_to_the_person(world: World, operation: str) -> None:
    place = world.folder / "outside.py"
    (world.package / world.main).rename(place)
    (world.package / world.main).symlink_to(place)
    before = place.read_bytes()
    world.change(*CHANGED)
    world.version += 1
    result = getattr(world, operation)()
    assert result.status == (3 if operation in {"generate", "upgrade"} else 0), result
    assert place.read_bytes() == before
    assert (world.package / world.main).is_symlink()

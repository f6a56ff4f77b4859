"""A run that is killed at any change of the file system, a full disk, two at once, an editor."""

from __future__ import annotations

import ctypes
import os
import random
import resource
import shutil
import signal
import sys
import time
from collections.abc import Callable, Iterable
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from eddi_scaffold.regions.package import SavedError, locked
from tests.updates.inputs import Input
from tests.updates.lives import START, Bare, Life, Real, histories, outside, snapshot, write
from tests.updates.templates import Templates
from tests.updates.world import World

pytestmark = pytest.mark.slow
_CHANGES = {"os.rename": 2, "os.remove": 1, "os.rmdir": 1, "os.mkdir": 2, "os.chmod": 2}
"""Audit events that change a file system -> where the folder of a relative path is."""
_KILLED, _SAVED, _FULL = 9, 10, 11
AFTER = (Input("E2", renamed_from="E1"), Input("E1", renamed_from="E2"), Input("E4"))


def in_child(run: Callable[[], int], hook: Callable[[str, tuple[Any, ...]], None]) -> int:
    """Run something in a forked process with an audit hook, and return its status."""
    child = os.fork()
    if child == 0:
        status = 1
        try:
            sys.addaudithook(hook)
            status = run()
        except SavedError:
            status = _SAVED
        except OSError:
            status = _FULL
        finally:
            os._exit(status)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def at(number: int, below: Path, act: Callable[[], None]) -> Callable[[str, tuple[Any, ...]], None]:
    """Return a hook that acts before the change of a number below a folder."""
    numbers = count()

    def hook(event: str, args: tuple[Any, ...]) -> None:
        if event == "open":
            changes = isinstance(args[2], int) and args[2] & (os.O_WRONLY | os.O_RDWR | os.O_CREAT)
        else:
            changes = event in _CHANGES
        if not changes or not isinstance(args[0], str | Path):
            return
        path = str(args[0])
        handle = args[_CHANGES[event]] if event in _CHANGES else -1
        if handle >= 0:
            path = f"{Path(f'/proc/self/fd/{handle}').readlink()}/{path}"
        if path.startswith(str(below)) and next(numbers) == number:
            act()

    return hook


def die() -> None:
    os._exit(_KILLED)


def edited(place: Bare | Real) -> Life:
    """Return a package that somebody wrote in, before everything about it changes."""
    life = Life(place, random.Random(7))
    life.begin()
    for _ in range(12):
        write(life)
    life.sync("generate")
    write(life)
    for _ in range(2):
        outside(life)
    place.inputs, place.template = AFTER, "third"
    return life


def is_whole(now: Path, before: dict[str, Any], after: dict[str, Any]) -> None:
    """Check that each file is the old or the new one."""
    for name, found in snapshot(now).items():
        if not any(way in name for way in (".eddi/manifest", ".eddi/put", ".eddi/new")):
            assert found in (before.get(name), after.get(name)), name
    texts = [data for data, _ in snapshot(now).values()]
    for data, _ in before.values():
        for line in data.split(b"\n"):
            assert b"mine_" not in line or any(line in text for text in texts), line


def kill_anywhere(place: Bare | Real, command: str, numbers: Iterable[int]) -> int:
    """Kill a command before changes of some numbers; the same command again ends as if never."""
    top = place.package if isinstance(place, Bare) else place.world.workspace
    saved = top.with_name(f"{top.name}.saved")
    shutil.copytree(top, saved, symlinks=True)
    before = snapshot(top)
    assert place.bring(command).status == 3
    after = snapshot(top)
    number = -1
    for number in numbers:
        shutil.rmtree(top)
        shutil.copytree(saved, top, symlinks=True)
        hook = at(number, top if isinstance(place, Bare) else top / "src", die)
        status = in_child(lambda: place.bring(command).status, hook)
        if status != _KILLED:
            assert status == 3
            break
        is_whole(top, before, after)
        assert place.bring(command).status == 3
        assert snapshot(top) == after, f"killed before change {number}"
    return number


def test_a_sync_that_is_killed_at_any_point_is_finished_by_the_next(folder: Path) -> None:
    place = Bare(folder)
    edited(place)
    assert kill_anywhere(place, "generate", range(1000)) > 40


@pytest.mark.parametrize("command", ["generate", "upgrade"][: histories(1, 2)])
def test_so_is_a_command(folder: Path, templates: Templates, command: str) -> None:
    place = Real(World(folder, templates, START))
    edited(place)
    if command == "upgrade":
        place.inputs = START
    some = random.Random(command).sample(range(260), 1)
    kill_anywhere(place, command, count() if histories(0, 1) else some)


@pytest.mark.parametrize("command", ["copy", "update", "recopy"][: histories(1, 3)])
def test_so_is_copier(folder: Path, templates: Templates, command: str) -> None:
    place = Real(World(folder, templates, START))
    edited(place)
    place.world.commit()
    package, chance = place.package, random.Random(command)
    saved = shutil.copytree(place.world.workspace, folder / "saved", symlinks=True)
    before = snapshot(package)
    began = time.monotonic()
    assert place.bring(command).status == 3
    takes = time.monotonic() - began
    after = snapshot(package)
    for _ in range(histories(1, 40)):
        shutil.rmtree(place.world.workspace)
        shutil.copytree(saved, place.world.workspace, symlinks=True)
        child = os.fork()
        if child == 0:
            os.setsid()
            try:
                place.bring(command)
            finally:
                os._exit(0)
        time.sleep(chance.uniform(0.3, 1) * takes)
        os.killpg(child, signal.SIGKILL)
        os.waitpid(child, 0)
        is_whole(package, before, after)
        assert place.bring(command).status == 3
        assert snapshot(package) == after


def test_a_full_disk_changes_nothing(folder: Path) -> None:
    place = Bare(folder)
    edited(place)
    before = snapshot(place.package)
    plan = place.plan()

    def run() -> int:
        resource.setrlimit(resource.RLIMIT_FSIZE, (700, 700))
        plan.prepare()
        return 0

    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    assert in_child(run, lambda *_: None) == _FULL
    assert snapshot(place.package) == before
    assert place.bring("generate").status == 3


def test_a_disk_that_is_full_changes_nothing(folder: Path, templates: Templates) -> None:
    workspace = folder / "ws"
    workspace.mkdir()
    mount = ctypes.CDLL(None, use_errno=True).mount
    if mount(b"none", bytes(workspace), b"tmpfs", 0, b"size=16m"):
        pytest.skip("this user may not mount a small disk")
    try:
        place = Real(World(folder, templates, START))
        edited(place)
        place.world.commit()
        before = snapshot(workspace / "src")
        filler = workspace / "filler"
        disk = os.statvfs(workspace)
        filler.write_bytes(bytes(disk.f_bavail * disk.f_frsize - 40 * 1024))
        done = place.bring("generate")
        assert (done.status, "No space left" in done.said) == (2, True), done.said
        assert snapshot(workspace / "src") == before
        filler.unlink()
        assert place.bring("generate").status == 3
    finally:
        assert ctypes.CDLL(None).umount2(bytes(workspace), 2) == 0


def test_a_folder_that_cannot_be_written_changes_nothing(folder: Path) -> None:
    place = Bare(folder)
    edited(place)
    before = snapshot(place.package)
    plan = place.plan()
    for path in (folder.parent, folder, *folder.rglob("*")):
        path.chmod(path.stat().st_mode | (0o777 if path.is_dir() else 0o666))
    before = snapshot(place.package)
    (place.package / "launch").chmod(0o555)

    def run() -> int:
        os.setuid(65534)  # root may write everywhere
        plan.prepare()
        return 0

    assert in_child(run, lambda *_: None) == _FULL
    (place.package / "launch").chmod(0o777)
    assert snapshot(place.package) == before


def test_copier_beside_another_run(folder: Path, templates: Templates) -> None:
    place = Real(World(folder, templates, START))
    edited(place)
    with locked(place.package):
        done = place.bring("recopy")
        assert (done.status, "another run is at work" in done.said) == (2, True), done.said
    assert place.bring("generate").status == 3


def test_a_file_that_an_editor_saves_meanwhile(folder: Path) -> None:
    place = Bare(folder)
    life = edited(place)
    file = place.package / life.regions()["process_E1"][0]
    saved = shutil.copytree(place.package, folder / "saved", symlinks=True)
    mine = b"# saved meanwhile\n"

    def save() -> None:
        data = file.read_bytes()
        file.write_bytes(data if data.endswith(mine) else data + mine)

    for number in range(1000):
        shutil.rmtree(place.package)
        shutil.copytree(saved, place.package, symlinks=True)
        before = snapshot(place.package)
        hook = at(number, place.package / ".eddi/put/", save)
        if in_child(lambda: place.bring("generate").status, hook) != _SAVED:
            break
        assert file.read_bytes().endswith(mine)
        now = snapshot(place.package)
        name = file.relative_to(place.package).as_posix()
        assert now.pop(name) != before.pop(name)
        assert now == before
    assert number > 9

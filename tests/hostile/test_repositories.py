"""What writes starts no command of a package either; Copier's task asks git in the real one."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from eddi_scaffold.regions import __main__ as tool
from eddi_scaffold.regions.bases import read_bases, write_bases
from tests.checkouts import git
from tests.cli.command import run
from tests.hostile import repositories
from tests.hostile.world import World

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    "hostile", [*repositories.BUILDERS, *repositories.OTHERS], ids=lambda build: build.__name__
)
def test_the_sync_of_copier_starts_no_command_of_a_package(
    hostile: Callable[[World], None], world: World
) -> None:
    hostile(world)
    assert tool.main(["sync"], world.package) == 0
    assert not world.mark.exists()


@pytest.mark.parametrize(
    "command",
    [
        "upgrade -w packages",
        "generate --platform plain -o packages -m two_conserts.xml -c consert_a_config.yml",
    ],
)
def test_commands_that_write_start_none(command: str, world: World) -> None:
    repositories.bare_look_alike(world)
    result = run(*command.split(), cwd=world.work)
    assert result.status == 0, result.err
    assert not world.mark.exists()


def test_a_text_that_is_in_git_only_comes_back_from_the_real_repository(world: World) -> None:
    """A scratch copy has no repository; what was written by hand in a dropped file is saved."""
    marked = "# -----Manual edit {}-----  # region: x:y\n"
    begin, end = marked.format("begin"), marked.format("end")
    (world.package / "dropped.cmake").write_text(f"{begin}hand(1)\n{end}")
    write_bases(world.package, {**read_bases(world.package), "dropped.cmake": begin + end})
    git(world.work, "init", "--quiet", "--initial-branch=main")
    git(world.work, "add", "--all")
    git(world.work, "commit", "--quiet", "--message", "All")
    (world.package / "dropped.cmake").unlink()
    result = run("upgrade", "-w", "packages", cwd=world.work)
    assert result.status == 3, result.err
    (saved,) = (world.eddi / "orphans").iterdir()
    assert saved.read_text().endswith("hand(1)\n")

"""What writes starts no command of a package either; Copier's task asks git in the real one."""

from __future__ import annotations

import shutil
from collections.abc import Callable

import pytest

from eddi_scaffold.regions import __main__ as tool
from tests.cli.command import run
from tests.hostile import repositories
from tests.hostile.test_read_only import GENERATE
from tests.hostile.world import World

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    "hostile", [*repositories.BUILDERS, *repositories.OTHERS], ids=lambda build: build.__name__
)
def test_the_sync_of_copier_starts_no_command_of_a_package(
    hostile: Callable[[World], None], world: World
) -> None:
    hostile(world)
    assert tool.main(["status", str(world.package)]) == 3
    stage = world.eddi / "new/stage"
    stage.mkdir(parents=True)
    shutil.copy(world.package / "EDDIInput.py", stage)
    assert tool.main(["sync", str(world.package), "stage"]) == 0
    assert not world.mark.exists()


@pytest.mark.parametrize("command", ["upgrade -w packages", GENERATE])
def test_commands_that_write_start_none(command: str, world: World) -> None:
    repositories.bare_look_alike(world)
    result = run(*command.split(), cwd=world.work)
    assert result.status == 3, result.err
    assert "edited outside" in result.err
    assert not world.mark.exists()

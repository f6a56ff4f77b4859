"""Commands that only look change nothing, and those that write nothing that lies elsewhere."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.cli.command import run
from tests.hostile import inputs, records, repositories
from tests.hostile.watch import changes, look
from tests.hostile.world import World

pytestmark = pytest.mark.slow

TWO = "-m two_conserts.xml -c consert_a_config.yml"
GENERATE = f"generate --platform plain -o packages {TWO}"
OF_PACKAGES = {
    "status -w packages": 0,
    "regions --check packages": 0,
    f"upgrade -w packages {TWO} --dry-run": 0,
    f"{GENERATE} --dry-run": 0,
}
"""Commands that only look, with their exit status where nobody wants harm."""
OF_INPUTS = {
    "check two_conserts.xml consert_a_config.yml": 0,
    "check Rover.yml eddi_config.yml rover.rossystem --models nodes": 1,
    "show two_conserts.xml": 0,
    "show rover.rossystem": 0,
    "diagram two_conserts.xml --name ConSertA": 0,
    "compose yml/ConSertA.yml": 1,
    "adopt old -o adopted --dry-run": 3,
    "parse-rossystem -s rover.rossystem -m nodes --dry-run": 0,
    "check deployment.yml": 0,
    "diagram deployment.yml": 0,
    "connect Rover.yml --system rover.rossystem --models nodes": 0,
    "connect Rover.yml --system rover.rossystem --models nodes -o eddi_config.yml --dry-run": 0,
    "run two_conserts.xml -c consert_a_config.yml --inputs recording.csv": 0,
    "watch --text --bag recording.csv": 2,
    "explain K007": 0,
    "generate deployment.yml -o cell --dry-run": 0,
    f"generate -w ws {TWO} --single-process --runtime installed --dry-run": 0,
}
"""More of them, which read no package."""
FINE = {0, 1, 2, 3}
"""Exit statuses of commands that know what they say; 70 is our bug."""


@pytest.mark.parametrize(
    "hostile",
    [*inputs.BUILDERS, *records.BUILDERS, *repositories.BUILDERS],
    ids=lambda build: build.__name__,
)
def test_looking_changes_nothing(hostile: Callable[[World], None], world: World) -> None:
    hostile(world)
    seen, wrong = world.look(), {}
    for command in OF_INPUTS if hostile in inputs.BUILDERS else OF_PACKAGES:
        result = run(*command.split(), cwd=world.work)
        before, seen = seen, world.look()
        changed = changes(before, seen)
        if changed or result.status not in FINE:
            wrong[command] = (result.status, changed, result.err)
    assert wrong == {}
    if hostile in records.BUILDERS:
        precious = world.scratch / "precious.txt"
        elsewhere = look(world.precious.parent), precious.read_text()
        for command in (GENERATE, "upgrade -w packages"):
            assert run(*command.split(), cwd=world.work).status in {0, 2, 3}
        assert (look(world.precious.parent), precious.read_text()) == elsewhere


def test_the_commands_do_their_work_where_nobody_wants_harm(world: World) -> None:
    commands = {**OF_PACKAGES, **OF_INPUTS}
    statuses = {command: run(*command.split(), cwd=world.work).status for command in commands}
    assert statuses == commands

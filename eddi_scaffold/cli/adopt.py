"""``eddi-scaffold adopt``: a package made by the D7.2 tools becomes one of ours."""

from __future__ import annotations

from pathlib import Path

from eddi_scaffold.cli.console import console
from eddi_scaffold.cli.options import Output, PlatformOfPlace
from eddi_scaffold.common.problems import EddiError, problem


def adopt(
    package: Path,
    workspace: Path | None = None,
    output: Output = None,
    platform: PlatformOfPlace = None,
    model: Path | None = None,
    name: str | None = None,
    dry_run: bool = False,
) -> None:
    """Take over a package made by the D7.2 tools.

    Every hand-written body is in its place afterwards.

    The old package is only read. Model and configuration are recovered from it and written next to
    the new one.

    Example: eddi-scaffold adopt old/bn_monitor -o monitors

    Args:
        package: Folder of the old package.
        workspace: Workspace to put it into.
        output: Folder to put it into.
        name: Name of the new package, by default the old one's; also which model of a file with
            several.
    """
    from eddi_scaffold.cli.reporting import destination, finish
    from eddi_scaffold.packages.adopting.adopt import adopt as adopted
    from eddi_scaffold.packages.adopting.adopt import write_adopted
    from eddi_scaffold.packages.rendering import own_template
    from eddi_scaffold.packages.workspace import alone, packages_root
    from eddi_scaffold.platforms import DEFAULT, DEFAULT_IN_FOLDER, chosen

    if (workspace is None) == (output is None):
        raise EddiError(problem("G006.none"))
    target = chosen(platform or (DEFAULT_IN_FOLDER if workspace is None else DEFAULT))
    place = destination(target, workspace, output)
    proposal = adopted(package, model, name)
    for note in proposal.notes:
        console.say(note)
    with alone(() if dry_run else [packages_root(target, place)]):
        outcome, problems, report = write_adopted(
            proposal, target, place, own_template(), dry_run=dry_run
        )
    console.problems(problems)
    for line in report:
        console.say(line)
    finish(outcome, dry_run=dry_run)

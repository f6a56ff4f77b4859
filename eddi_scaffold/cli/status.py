"""``eddi-scaffold status``: drift of generated packages, and what was written by hand."""

from __future__ import annotations

from pathlib import Path

import typer

from eddi_scaffold.cli import exit_status
from eddi_scaffold.cli.console import console
from eddi_scaffold.cli.options import Packages, WherePackagesAre


def status(
    packages: Packages = None,
    workspace: WherePackagesAre = None,
    model: Path | None = None,
    config: list[Path] | None = None,
    as_json: bool = False,
) -> None:
    """Report which packages differ, and what is hand-written.

    Each is compared with what would be generated now.

    Example: eddi-scaffold status -w catkin_ws

    Args:
        model: Compare with this model file.
    """
    from eddi_scaffold.packages.rendering import own_template
    from eddi_scaffold.packages.upgrading import groups, refuse_for_several, states_of

    chosen = groups(workspace, packages or [])
    refuse_for_several(chosen, model, config or [])
    template = own_template()
    reports = [
        state for group in chosen for state in states_of(group, model, config or [], template)
    ]
    if as_json:
        console.json({"packages": [report.as_json() for report in reports]})
    else:
        for report in reports:
            console.data(report.as_text())
    if any(report.drifted for report in reports):
        raise typer.Exit(exit_status.NO)

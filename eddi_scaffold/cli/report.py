"""``eddi-scaffold report``: what is known of hazards and monitors, in one paper."""

from __future__ import annotations

import os
from datetime import datetime, timezone
from pathlib import Path
from typing import Annotated

import typer

from eddi_scaffold.cli.console import ExitStatus, console
from eddi_scaffold.cli.options import Packages, WherePackagesAre


def report(
    packages: Packages = None,
    workspace: WherePackagesAre = None,
    model: Path | None = None,
    inject: Path | None = None,
    to: Annotated[Path, typer.Option("--to")] = Path("report"),
) -> None:
    """Write what is known of hazards and monitors.

    Packages are verified, their vectors run. `report.html` is for people; `needs.json`
    (sphinx-needs), `case.reqif`, `case.gsn.yaml`, `case.sacm.xml` and `junit.xml` are for
    tools. The exit status is 1 when a hazard is not linked, a monitor is not proved, or a
    guarantee goes away too late.

    Example: eddi-scaffold report -w catkin_ws -m hazards.xml --inject faults.json

    Args:
        packages: Package folders; default: all of the workspace.
        model: EDDI XML with hazards and requirements.
        inject: What `inject --json` printed.
        to: Folder of the files.
    """
    from eddi_scaffold.packages.transaction import write
    from eddi_scaffold.packages.upgrading import groups
    from eddi_scaffold.report.contents import page
    from eddi_scaffold.report.formats import gsn, junit, needs_conf, needs_json, reqif, sacm
    from eddi_scaffold.report.gathering import gathered

    chosen = groups(workspace, packages or [])
    name = model.stem if model is not None else (workspace or Path()).resolve().name
    contents = gathered(name, chosen, model, inject)
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    created = datetime.fromtimestamp(int(epoch) if epoch.isdecimal() else 0, timezone.utc)
    created = created.replace(tzinfo=None)
    formats = {
        "report.html": page(contents),
        "needs.json": needs_json(name, contents.items, created),
        "conf.py": needs_conf(name),
        "case.reqif": reqif(name, contents.items, created),
        "case.gsn.yaml": gsn(contents.argument),
        "case.sacm.xml": sacm(name, contents.argument),
        "junit.xml": junit(contents.suites),
    }
    write(to, {file: text.encode() for file, text in formats.items()})
    console.say(f"{to / 'report.html'}: {'complete' if contents.holds else 'something is missing'}")
    if not contents.holds:
        raise typer.Exit(ExitStatus.NO)

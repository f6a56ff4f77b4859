"""``eddi-scaffold trace``: which element of the model became what in a package."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from eddi_scaffold.cli.options import Json, WherePackagesAre


def trace(
    packages: Annotated[
        list[Path] | None, typer.Argument(help="Package folders; default: all of the workspace.")
    ] = None,
    workspace: WherePackagesAre = None,
    as_json: Json = False,
    as_csv: Annotated[
        bool, typer.Option("--csv", help="Print one table for a spreadsheet.")
    ] = False,
) -> None:
    """Print what became of each element of the models.

    A table of packages: model elements, their places, code and topics.

    Example: eddi-scaffold trace -w catkin_ws
    """
    import csv
    import io

    from eddi_scaffold.cli.console import console
    from eddi_scaffold.common.problems import EddiError, problem
    from eddi_scaffold.deployments.lifetimes import bounds
    from eddi_scaffold.deployments.support import acceptances, facts_of_package
    from eddi_scaffold.packages.tracing import COLUMNS, trace_of
    from eddi_scaffold.packages.upgrading import groups

    if as_json and as_csv:
        raise EddiError(problem("G000.formats"))
    chosen = groups(workspace, packages or [])
    found = [
        trace_of(answers)
        for group in chosen
        for answers in group.present.values()
        if "facts_json" in answers
    ]
    wired = [
        wire
        for group in chosen
        for folder, answers in group.present.items()
        if (wire := facts_of_package(folder, answers)) is not None
    ]
    accepted, limits = acceptances(wired), bounds(wired)
    if as_json:
        console.json(
            {
                "packages": [one.as_json() for one in found],
                "accepted": [one.as_json() for one in accepted],
                "bounds": [limit.as_json() for limit in limits],
            }
        )
    elif as_csv:
        table = io.StringIO()
        writer = csv.writer(table, lineterminator="\n")
        writer.writerow(("package", "model", "sha256", *COLUMNS))
        for one in found:
            writer.writerows((one.package, one.model, one.sha256, *one.cells(r)) for r in one.rows)
        console.data(table.getvalue().rstrip("\n"))
    else:
        console.data("\n\n".join(one.as_text() for one in found))
        for title, rows in (("accepted", accepted), ("silence", limits)):
            if rows:
                console.data("\n".join(["", f"{title}:", *(f"  {row.as_text()}" for row in rows)]))

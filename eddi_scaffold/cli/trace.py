"""``eddi-scaffold trace``: which element of the model became what in a package."""

from __future__ import annotations

import csv
import io

from eddi_scaffold.cli.console import console
from eddi_scaffold.cli.options import Packages, WherePackagesAre
from eddi_scaffold.common.problems import EddiError, problem


def trace(
    packages: Packages = None,
    workspace: WherePackagesAre = None,
    as_json: bool = False,
    as_csv: bool = False,
) -> None:
    """Print what became of each element of the models.

    A table of packages: model elements, their places, code and topics.

    Example: eddi-scaffold trace -w catkin_ws

    Args:
        as_csv: Print one table for a spreadsheet.
    """
    from eddi_scaffold.deployments.lifetimes import bounds
    from eddi_scaffold.deployments.support import acceptances, facts_of_package
    from eddi_scaffold.packages.tracing import COLUMNS, trace_of
    from eddi_scaffold.packages.upgrading import groups

    if as_json and as_csv:
        raise EddiError(problem("G000.formats"))
    present = [
        package for group in groups(workspace, packages or []) for package in group.present.items()
    ]
    traces = [trace_of(answers) for _, answers in present if "facts_json" in answers]
    facts = [facts_of_package(folder, answers) for folder, answers in present]
    wired = [wire for wire in facts if wire is not None]
    accepted, limits = acceptances(wired), bounds(wired)
    if as_json:
        console.json(
            {
                "packages": [trace.as_json() for trace in traces],
                "accepted": [acceptance.as_json() for acceptance in accepted],
                "bounds": [limit.as_json() for limit in limits],
            }
        )
    elif as_csv:
        table = io.StringIO()
        writer = csv.writer(table, lineterminator="\n")
        writer.writerow(("package", "model", "sha256", *COLUMNS))
        for trace in traces:
            head = (trace.package, trace.model, trace.sha256)
            writer.writerows((*head, *trace.cells(row)) for row in trace.rows)
        console.data(table.getvalue().rstrip("\n"))
    else:
        console.data("\n\n".join(trace.as_text() for trace in traces))
        for title, rows in (("accepted", accepted), ("silence", limits)):
            if rows:
                console.data("\n".join(["", f"{title}:", *(f"  {row.as_text()}" for row in rows)]))

"""``eddi-scaffold check``: all problems of all files, with their places."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from eddi_scaffold.cli.options import DefaultGuarantees, Json


def check(
    files: Annotated[list[Path], typer.Argument(help="EDDI XML, ConSert YAML, eddi_config.yml.")],
    default_guarantee: DefaultGuarantees = None,
    as_json: Json = False,
) -> None:
    """Validate files: all problems at once, with places.

    Configurations given together with a model are checked against it.

    Example: eddi-scaffold check example.xml consert_a_config.yml
    """
    from eddi_scaffold.checking import check_files
    from eddi_scaffold.console import console, count_line
    from eddi_scaffold.problems import has_errors, in_order

    problems = in_order(check_files(files, default_guarantee or ()))
    if as_json:
        console.json({"problems": [problem.as_json() for problem in problems]})
    else:
        console.problems(problems, summary=False)
        shown = [problem for problem in problems if console.shows(problem)]
        names = ", ".join(str(file) for file in files)
        more = f" (-v shows {count_line(problems)})" if problems and not shown else ""
        console.say(f"{count_line(shown) or 'no problems'} in {names}{more}")
    if has_errors(problems):
        raise typer.Exit(1)

"""``eddi-scaffold explain``: what a code of a problem means."""

from __future__ import annotations

from typing import Annotated

import typer

from eddi_scaffold.cli.options import Json


def explain(
    code: Annotated[str, typer.Argument(help="Code of a problem, such as K007.")],
    *,
    json: Json = False,
) -> None:
    """Say what a problem means, and what to do.

    Example: eddi-scaffold explain K007
    """
    from textwrap import fill

    from eddi_scaffold.cli.console import console
    from eddi_scaffold.common import catalogue
    from eddi_scaffold.common.problems import EddiError, problem

    diagnostic = catalogue.find(code)
    if diagnostic is None:
        similar = catalogue.similar(code)
        hint = f"did you mean {' or '.join(similar)}?" if similar else "a code is like K007"
        raise EddiError(problem("G008.code", hint=hint, code=code))
    if json:
        console.json(diagnostic.as_json())
        return
    before = (
        "" if diagnostic.code == code.upper() else f"{code.upper()} is {diagnostic.code} now\n\n"
    )
    parts = [
        f"{before}{diagnostic.code}: {diagnostic.title} ({', '.join(diagnostic.levels)})",
        fill(diagnostic.why, 96, break_long_words=False, break_on_hyphens=False),
        fill(f"What to do: {diagnostic.fix}", 96, break_long_words=False, break_on_hyphens=False),
        "\n".join(["Printed as:", "", *diagnostic.shown()]),
    ]
    console.data("\n\n".join(parts))

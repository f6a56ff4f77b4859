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
    from dataclasses import asdict
    from textwrap import fill, indent

    from eddi_scaffold.cli.console import console
    from eddi_scaffold.common import catalogue
    from eddi_scaffold.common.problems import EddiError, error

    found = catalogue.find(code)
    if found is None:
        near = catalogue.near(code)
        hint = f"did you mean {' or '.join(near)}?" if near else "a code is like K007"
        raise EddiError(error("G023", f"there is no code {code!r}", hint=hint))
    if json:
        console.json(asdict(found))
        return
    parts = [
        f"{found.code}: {found.title} ({', '.join(found.levels)})",
        fill(found.why, 96, break_long_words=False, break_on_hyphens=False),
        fill(f"What to do: {found.what_to_do}", 96, break_long_words=False, break_on_hyphens=False),
        f"Example:\n\n{indent(found.example, '    ')}",
    ]
    console.data("\n\n".join(parts))

"""The Typer application: global options and the commands, grouped by when they are needed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from eddi_scaffold import __version__
from eddi_scaffold.cli import (
    check,
    connect,
    event,
    generate,
    inject,
    learning,
    models,
    packages,
    report,
    run,
    watch,
)
from eddi_scaffold.cli.console import console
from eddi_scaffold.cli.options import as_typer_reads


class _Groups(TyperGroup):
    """Lists commands below the headings of ``COMMANDS``."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write a section for each group, all of one width."""
        width = formatter.width - 4 - max(map(len, self.commands))
        for title, group in COMMANDS.items():
            rows = [(name, self.commands[name].get_short_help_str(width)) for name in group]
            with formatter.section(title):
                formatter.write_dl(rows)


app = typer.Typer(
    name="eddi-scaffold",
    cls=_Groups,
    help="Turn a design-time EDDI into runtime monitors, without losing a hand-written line.",
    epilog="Start with: eddi-scaffold example two-conserts demo",
    context_settings={"help_option_names": ["-h", "--help"]},
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    no_args_is_help=True,
)


def _version(value: bool) -> None:
    if value:
        console.data(f"eddi-scaffold {__version__}")
        raise typer.Exit


@app.callback()
@as_typer_reads
def options(
    *,
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Turn a design-time EDDI into runtime monitors, without losing a hand-written line."""


_GROUPS: dict[str, list[Callable[..., None]]] = {
    "Start here": [learning.example, check.check, check.show, run.run, generate.generate],
    "Every day": [
        connect.connect,
        connect.parse_rossystem,
        packages.regions,
        packages.status,
        packages.upgrade,
        watch.watch,
        learning.explain,
    ],
    "Models": [models.diagram, models.compose, models.export, event.event, packages.trace],
    "Evidence": [packages.verify, inject.inject, report.report],
    "Old packages, git and Copier": [packages.adopt, generate.answers],
}
COMMANDS = {
    title: {command.__name__.replace("_", "-"): command for command in group}
    for title, group in _GROUPS.items()
}
for _group in COMMANDS.values():
    for _name, _command in _group.items():
        app.command(_name)(as_typer_reads(_command))

"""The options of every command, before and behind its name."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from inspect import Parameter, signature
from typing import Annotated, Any

import typer

from eddi_scaffold.cli.console import console


def _quiet(wanted: bool) -> None:
    console.quiet = console.quiet or wanted


def _verbose(wanted: bool) -> None:
    console.verbose = console.verbose or wanted


def _color(wanted: bool | None) -> None:
    console.colour = console.colour if wanted is None else wanted


_OPTIONS: dict[str, tuple[Any, bool | None]] = {
    "quiet": (
        Annotated[bool, typer.Option("-q", "--quiet", callback=_quiet, help="Print errors only.")],
        False,
    ),
    "verbose": (
        Annotated[
            bool, typer.Option("-v", "--verbose", callback=_verbose, help="Print infos as well.")
        ],
        False,
    ),
    "color": (
        Annotated[
            bool | None,
            typer.Option("--color/--no-color", callback=_color, help="Default: on a terminal."),
        ],
        None,
    ),
    "traceback": (
        Annotated[bool, typer.Option("--traceback", help="Show where a bug happened.")],
        False,
    ),
}
"""Name -> what it is, and its default. ``main`` looks for ``--traceback`` itself."""


def with_global_options(command: Callable[..., None]) -> Callable[..., None]:
    """Return a command that takes the global options as well; their callbacks carry them out."""
    own = signature(command, eval_str=True)
    added = [
        Parameter(name, Parameter.KEYWORD_ONLY, default=default, annotation=annotation)
        for name, (annotation, default) in _OPTIONS.items()
    ]

    @wraps(command)
    def taking_all(**values: Any) -> None:
        command(**{name: value for name, value in values.items() if name not in _OPTIONS})

    whole = own.replace(parameters=[*own.parameters.values(), *added])
    # Typer reads one or the other, according to its version.
    vars(taking_all)["__signature__"] = whole
    taking_all.__annotations__ = {one.name: one.annotation for one in whole.parameters.values()}
    return taking_all

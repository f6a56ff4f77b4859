"""Options that several commands share, and commands as Typer reads them.

What an option of one command means stands in the docstring of the command, below ``Args:``.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from copy import copy
from functools import wraps
from inspect import Parameter, getdoc, signature
from pathlib import Path
from typing import Annotated, Any, Literal, get_args, get_origin

import typer

from eddi_scaffold.cli.console import console
from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.platforms import DEFAULT, DEFAULT_IN_FOLDER
from eddi_scaffold.platforms import names as platform_names

_OTHER_PICTURES = (".png", ".pdf", ".jpg", ".jpeg", ".gif", ".eps", ".ps")


def for_pictures(path: Path | None) -> Path | None:
    """Refuse a name of a picture of another format than SVG (EddiError, G000)."""
    if path is not None and path.suffix.lower() in _OTHER_PICTURES and not path.is_dir():
        svg = path.with_suffix(".svg")
        raise EddiError(problem("G000.picture", Place(str(path)), suffix=path.suffix, value=svg))
    return path


Output = Annotated[Path | None, typer.Option("-o", "--output")]
Files = Annotated[list[Path] | None, typer.Argument(metavar="[FILE]...", show_default=False)]
Domains = Annotated[list[int] | None, typer.Option("--domain", min=0, max=232)]
Packages = Annotated[list[Path] | None, typer.Argument()]
PLATFORMS = " or ".join(platform_names())
PlatformName = Annotated[str, typer.Option("--platform", help=f"{PLATFORMS}.")]
PlatformOfPlace = Annotated[
    str | None,
    typer.Option(
        "--platform",
        help=f"{PLATFORMS}. By default {DEFAULT} with -w, {DEFAULT_IN_FOLDER} with -o.",
    ),
]
Runtime = Annotated[
    Literal["vendored", "installed"] | None,
    typer.Option(
        "--runtime",
        help="Where the runtime library is: vendored (beside the monitors) or installed (the"
        " distribution eddi-runtime). By default as it is, at first vendored.",
    ),
]
SingleProcess = Annotated[
    bool | None,
    typer.Option(
        "--single-process/--separate-processes",
        help="Whether one process runs all monitors of the workspace. By default as it is, at first"
        " one process for each.",
        show_default=False,
    ),
]
WherePackagesAre = Annotated[
    Path | None,
    typer.Option(
        "-w",
        "--workspace",
        "-o",
        "--output",
        help="Workspace, or output folder: as `generate` was given it.",
    ),
]


def _quiet(value: bool) -> None:
    console.quiet = console.quiet or value


def _verbose(value: bool) -> None:
    console.verbose = console.verbose or value


def _global_options(
    *,
    quiet: Annotated[
        bool, typer.Option("-q", "--quiet", callback=_quiet, help="Print errors only.")
    ] = False,
    verbose: Annotated[
        bool, typer.Option("-v", "--verbose", callback=_verbose, help="Print infos as well.")
    ] = False,
    traceback: Annotated[
        bool, typer.Option("--traceback", help="Show where a bug happened.")
    ] = False,
) -> None:
    """Only declare them: callbacks carry them out, and ``main`` looks for ``--traceback``."""


def _shared_options() -> None:
    """Hold what options of these names mean in every command that does not say otherwise.

    Args:
        as_json: Print JSON for programs.
        config: eddi_config.yml; repeat it for several monitors.
        default_guarantee: `ID` or `CONSERT/ID` of a guarantee that holds always (fallback of its
            service).
        dry_run: Print the difference, change nothing.
        model: EDDI XML or a model file; a configuration may name its own.
        models: Directory of .ros, .ros1 and .ros2: nodes and message types.
        name: Which model of the file, when it contains several.
        packages: Package folders; default: all of the workspace.
        system: A .rossystem, whose topics count in place of SimulatorOutputs.
    """


_SHORT = {"config": ("-c",), "inputs": ("-i",), "model": ("-m",), "workspace": ("-w",)}
_ARGUMENT = re.compile(r"(?m)^    (\w+): (.+(?:\n {8}.+)*)")


def _help_of(command: Callable[..., None]) -> tuple[str, dict[str, str]]:
    """Return what a docstring says of a command, and of each option."""
    text, _, arguments = (getdoc(command) or "").partition("\n\nArgs:\n")
    return text, {m[1]: " ".join(m[2].split()) for m in _ARGUMENT.finditer(arguments)}


def as_typer_reads(command: Callable[..., None]) -> Callable[..., None]:
    """Return a command whose parameters have the help of its docstring, with the global options."""
    own = signature(command, eval_str=True)
    added = signature(_global_options, eval_str=True).parameters
    help_, texts = _help_of(command)
    texts = {**_help_of(_shared_options)[1], **texts}

    @wraps(command)
    def taking_all(**values: Any) -> None:
        command(**{name: value for name, value in values.items() if name not in added})

    described = [_described(each, texts.get(each.name)) for each in own.parameters.values()]
    parameters = [*described, *added.values()]
    # Typer reads one or the other, according to its version.
    vars(taking_all)["__signature__"] = own.replace(parameters=parameters)
    taking_all.__annotations__ = {each.name: each.annotation for each in parameters}
    taking_all.__doc__ = help_
    return taking_all


def _described(parameter: Parameter, text: str | None) -> Parameter:
    """Return a parameter with its help: one with a default is an option."""
    type_, info = parameter.annotation, None
    if get_origin(type_) is Annotated:
        type_, info = get_args(type_)
    if info is not None:
        info = copy(info)
        info.help = info.help or text
    elif parameter.default is Parameter.empty:
        info = typer.Argument(help=text)
    else:
        name = f"--{parameter.name.removeprefix('as_').replace('_', '-')}"
        info = typer.Option(name, *_SHORT.get(parameter.name, ()), help=text)
    return parameter.replace(annotation=Annotated[type_, info])

"""``eddi-scaffold answers``: the answers file for plain ``copier copy``."""

from __future__ import annotations

from pathlib import Path
from shlex import quote
from typing import Annotated

import typer

from eddi_scaffold.cli import exit_status
from eddi_scaffold.cli.console import console
from eddi_scaffold.cli.options import PlatformName, Runtime, SingleProcess, in_a_folder
from eddi_scaffold.platforms import DEFAULT


def answers(
    output: Annotated[Path, typer.Option("-o", "--output", callback=in_a_folder)],
    model: Path | None = None,
    config: Path | None = None,
    name: str | None = None,
    default_guarantee: list[str] | None = None,
    platform: PlatformName = DEFAULT,
    system: Path | None = None,
    models: Path | None = None,
    runtime: Runtime = None,
    single_process: SingleProcess = None,
    workspace: Path | None = None,
    every: Annotated[bool, typer.Option("--all")] = False,
) -> None:
    """Write the answers for plain `copier copy`.

    It renders the same package as `generate` with them.

    Example: eddi-scaffold answers -m example.xml -c consert_a_config.yml -o answers.yml

    Args:
        output: File to write; with --all a folder.
        config: eddi_config.yml of the monitor.
        workspace: Workspace of the package, and of the others with --all.
        every: Also the answers of the packages that all monitors share.
    """
    from eddi_scaffold.connect.robot import robot_models
    from eddi_scaffold.packages.assembly import assemble, monitors_of, only
    from eddi_scaffold.packages.handwritten import lost_sources
    from eddi_scaffold.packages.rendering import own_template
    from eddi_scaffold.packages.transaction import FileState, write
    from eddi_scaffold.platforms import choices, chosen
    from eddi_scaffold.yaml_text.writer import dump_plain

    target = chosen(platform)
    root = (workspace or Path()) / target.root
    configs, marks = [config] if config else [], default_guarantee or ()
    with robot_models(system, models) as (robot, unsure):
        monitors, problems = monitors_of(model, configs, name, marks, robot, root)
    only(monitors)
    options = choices(runtime, single_process)
    assembly = assemble(monitors, target, root, [*unsure, *problems], options)
    console.problems(assembly.problems)
    packages = [package for package in assembly.packages if package.answers]
    packages = packages if every else packages[:1]
    place = output if every else output.parent
    names = [f"{package.folder}.yml" if every else output.name for package in packages]
    files: dict[str, FileState] = {}
    for package, file in zip(packages, names, strict=True):
        folder = f"{file}.files"
        more = {"files_folder": str((place / folder).resolve())} if package.files else {}
        files[file] = FileState(dump_plain({**package.answers, **more}).encode())
        for path, data in package.files.items():
            files[f"{folder}/{path.rpartition('/')[2]}"] = FileState(data)
    write(place, files)
    template = own_template()
    template.keep()
    version = f" --vcs-ref {template.ref}" if template.ref else ""
    command = f"copier copy --trust --defaults{version}"
    for package, file in zip(packages, names, strict=True):
        path, folder = quote(str(place / file)), quote((root / package.folder).as_posix())
        console.say(f"{command} --data-file {path} {quote(template.location)} {folder}")
    lost: list[str] = []
    for package in packages:
        before = assembly.present.get(package.folder, {})
        lines = lost_sources(root / package.folder, before, package.answers)
        lost += [f"{package.folder}: {line}" for line in lines]
    for line in lost:
        console.say(f"note: {line}")
    if lost:
        raise typer.Exit(exit_status.LOOK)

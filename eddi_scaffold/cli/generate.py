"""``eddi-scaffold generate`` and ``answers``: whole packages, also with plain Copier."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Annotated

import typer

from eddi_scaffold.cli.console import ExitStatus, console
from eddi_scaffold.cli.options import Output, PlatformName, Runtime, SingleProcess
from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.problems import EddiError, Place, plural, problem
from eddi_scaffold.platforms import DEFAULT, Platform

if TYPE_CHECKING:
    from eddi_scaffold.packages.generation import WriteResult

_SHOWN = 12
_RECORDS = "/.eddi/"
_SIGNS = {"new": "+", "changed": "~", "removed": "-"}


def generate(
    deployment: Annotated[
        Path | None, typer.Argument(metavar="DEPLOYMENT", show_default=False)
    ] = None,
    model: Path | None = None,
    workspace: Path | None = None,
    config: list[Path] | None = None,
    output: Output = None,
    platform: PlatformName = DEFAULT,
    system: Path | None = None,
    models: Path | None = None,
    name: str | None = None,
    default_guarantee: list[str] | None = None,
    runtime: Runtime = None,
    single_process: SingleProcess = None,
    rename: list[str] | None = None,
    dry_run: bool = False,
) -> None:
    """Generate monitors, also anew; hand-written lines stay.

    Example: eddi-scaffold generate -w catkin_ws -c consert_a_config.yml -m example.xml

    Args:
        deployment: A deployment.yml, with -o FOLDER alone: a workspace for each of its robots.
        workspace: Workspace, such as catkin's (for a platform that is built in one).
        output: Folder (for the others).
        rename: `OLD=NEW`: the monitor had another name; its package moves, with all in it.
    """
    if deployment is not None:
        values = {
            "--model": model, "--workspace": workspace, "--config": config, "--system": system,
            "--models": models, "--name": name, "--default-guarantee": default_guarantee,
            "--runtime": runtime, "--single-process": single_process, "--rename": rename,
            "--platform": None if platform == DEFAULT else platform,
        }  # fmt: skip
        others = [option for option, value in values.items() if value is not None]
        _generate_fleet(deployment, output, others, dry_run=dry_run)
        return

    from eddi_scaffold.connect.robot import robot_models
    from eddi_scaffold.deployments.wiring import members_of, shared_by_robots
    from eddi_scaffold.packages.assembly import assemble, monitors_of
    from eddi_scaffold.packages.generation import write_packages
    from eddi_scaffold.packages.handwritten import unwritten
    from eddi_scaffold.packages.renaming import left_behind, read_renames
    from eddi_scaffold.packages.rendering import own_template
    from eddi_scaffold.packages.verifying import in_short
    from eddi_scaffold.packages.workspace import alone, packages_root
    from eddi_scaffold.platforms import choices, chosen

    target = chosen(platform)
    place = destination(target, workspace, output)
    root = packages_root(target, place)
    marks = default_guarantee or ()
    with alone(() if dry_run else [root]):
        with robot_models(system, models) as (robot, unsure):
            monitors, problems = monitors_of(
                model, config or [], name, marks, robot, root, rename or ()
            )
        renames = read_renames(rename or (), root, {monitor.package for monitor in monitors})
        moved = {*renames.former, *renames.former.values()}
        options = choices(runtime, single_process)
        assembly = assemble(monitors, target, root, [*unsure, *problems], options, moved)
        console.problems(assembly.problems)
        older = list(left_behind(assembly.present, assembly.packages, monitors, moved))
        outcome = write_packages(
            root,
            assembly.packages,
            own_template(),
            renames=renames,
            dry_run=dry_run,
            progress=console.progress,
        )
    left = [*outcome.left, *(text for text, is_new in older if is_new)]
    notes = [*outcome.notes, *(text for text, is_new in older if not is_new)]
    if outcome.changes and not dry_run:
        files = {package.folder: package.files for package in assembly.packages}
        notes += [in_short(monitor, files[monitor.package]) for monitor in monitors]
    shared = shared_by_robots(members_of(monitors))
    if shared is not None:
        console.say(f"note: {shared}")
    steps = [f"write {where}" for where in unwritten(root, monitors)]
    steps += target.next_steps(place, assembly.monitors)
    finish(replace(outcome, left=left, notes=notes), dry_run=dry_run, next_steps=steps)


def _generate_fleet(
    deployment: Path, folder: Path | None, others: Sequence[str], *, dry_run: bool
) -> None:
    from eddi_scaffold.config.deployment_file import is_fleet
    from eddi_scaffold.deployments.fleet_checks import sites_of
    from eddi_scaffold.monitors.loading import checked_models
    from eddi_scaffold.packages.fleets import places_of, write_sites
    from eddi_scaffold.packages.handwritten import unwritten, without_written_inputs
    from eddi_scaffold.packages.rendering import own_template
    from eddi_scaffold.packages.workspace import alone

    source = read_source(deployment)
    if not is_fleet(source):
        raise EddiError(problem("K001.deployment", Place(str(deployment))))
    if others:
        raise EddiError(problem("G000.deployment", others=", ".join(others)))
    if folder is None:
        raise EddiError(problem("G006.deployment"))
    sites, problems = sites_of(source, checked_models)
    places = places_of(sites, folder)
    with alone(() if dry_run else places):
        outcome, more = write_sites(
            sites,
            folder,
            own_template(),
            dry_run=dry_run,
            progress=console.progress,
        )

    def packages(name: str) -> list[Path]:
        return [place / name for place in places_of(sites, folder) if (place / name).is_dir()]

    console.problems(without_written_inputs([*problems, *more], packages))
    steps: list[str] = []
    for root, site in zip(places[1:], sites, strict=True):
        steps += [f"write {where}" for where in unwritten(root, site.monitors)]
        steps += [f"{site.name}: {command}" for command in site.next_steps(folder / site.name)]
    finish(outcome, dry_run=dry_run, next_steps=steps)


def answers(
    output: Annotated[Path, typer.Option("-o", "--output")],
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
    from eddi_scaffold.packages.rendering import own_template
    from eddi_scaffold.packages.transaction import write
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
    files: dict[str, bytes] = {}
    for package, file in zip(packages, names, strict=True):
        folder = f"{file}.files"
        more = {"files_folder": str((place / folder).resolve())} if package.files else {}
        files[file] = dump_plain({**package.answers, **more}).encode()
        for path, data in package.files.items():
            files[f"{folder}/{path.rpartition('/')[2]}"] = data
    write(place, files)
    template = own_template()
    template.keep()
    version = f" --vcs-ref {template.ref}" if template.ref else ""
    command = f"copier copy --trust --defaults{version}"
    for package, file in zip(packages, names, strict=True):
        path, folder = quote(str(place / file)), quote((root / package.folder).as_posix())
        console.say(f"{command} --data-file {path} {quote(template.location)} {folder}")


def destination(platform: Platform, workspace: Path | None, output: Path | None) -> Path:
    """Return the one of ``-w`` and ``-o`` that the platform takes.

    Raises:
        EddiError: it is missing or a package (G006), or the other one is given as well (G000).
    """
    from eddi_scaffold.packages.rendering import ANSWERS_FILE

    place, other, option = workspace, output, "-w WORKSPACE"
    if platform.workspace is None:
        place, other, option = output, workspace, "-o FOLDER"
    if place is None:
        raise EddiError(problem("G006.platform", platform=platform.name, option=option))
    if other is not None:
        raise EddiError(problem("G000.alone", platform=platform.name, option=option))
    if (place / ANSWERS_FILE).is_file():
        parent = place.absolute().parent
        raise EddiError(problem("G006.inside_package", Place(str(place)), parent=parent))
    return place


def finish(*outcomes: WriteResult, dry_run: bool, next_steps: Sequence[str] = ()) -> None:
    """Print what changed and end the command with 0, or with 3 when a person must look."""
    for outcome in outcomes:
        _report(outcome, dry_run=dry_run)
    if any(outcome.attention or outcome.left for outcome in outcomes):
        raise typer.Exit(ExitStatus.LOOK)
    if not dry_run and next_steps:
        console.say("next:")
        for step in next_steps:
            console.say(f"  {step}")


def _report(outcome: WriteResult, *, dry_run: bool) -> None:
    # records of hand edits are not counted, which people do not read
    changes = {path: data for path, data in outcome.changes.items() if _RECORDS not in path}
    size = plural(len(changes), "file")
    if dry_run:
        diff = outcome.diff()
        if diff:
            console.data(diff.rstrip("\n"))
        console.say(f"{size} would change below {outcome.root}")
    elif not outcome.changes:
        console.say(f"nothing to change below {outcome.root}")
    else:
        console.say(f"{outcome.root}: {size}")
        _list_changes(outcome, changes)
    for note in outcome.notes:
        console.say(f"note: {note}")
    for line in outcome.left:
        console.say(f"left alone: {line}")
    if outcome.attention:
        console.say("hand edits need a look: see the notes, and `eddi-scaffold regions --check`")


def _list_changes(outcome: WriteResult, changed: Mapping[str, bytes | None]) -> None:
    changes = {
        path: "removed" if content is None else "changed" if path in outcome.before else "new"
        for path, content in changed.items()
    }
    editable = sorted(outcome.editable, key=lambda path: (not path.endswith(".py"), path))
    if editable:
        console.say("  yours to edit:")
        for path in editable[:_SHOWN]:
            console.say(f"    {_SIGNS[changes[path]]} {path}")
        if len(editable) > _SHOWN:
            console.say(f"    ... and {len(editable) - _SHOWN} more")
    others = sorted(changes.keys() - outcome.editable)
    if others:
        counts = Counter(changes[path] for path in others)
        what = ", ".join(f"{counts[change]} {change}" for change in _SIGNS if counts[change])
        folders = list(dict.fromkeys(path.partition("/")[0] for path in others))
        console.say(f"  generated: {what}, in {', '.join(folders)}")

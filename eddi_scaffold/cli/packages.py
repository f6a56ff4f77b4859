"""Commands on packages that are there: ``status verify upgrade regions adopt trace``."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import asdict, replace
from pathlib import Path
from typing import Annotated, Any

import typer

from eddi_scaffold import __version__
from eddi_scaffold.cli.console import ExitStatus, console
from eddi_scaffold.cli.generate import destination, finish
from eddi_scaffold.cli.options import Output, Packages, PlatformOfPlace, WherePackagesAre
from eddi_scaffold.common.problems import EddiError, problem


def status(
    packages: Packages = None,
    workspace: WherePackagesAre = None,
    model: Path | None = None,
    config: list[Path] | None = None,
    as_json: bool = False,
) -> None:
    """Report which packages differ, and what is hand-written.

    Each is compared with what would be generated now.

    Example: eddi-scaffold status -w catkin_ws

    Args:
        model: Compare with this model file.
    """
    from eddi_scaffold.packages.rendering import own_template
    from eddi_scaffold.packages.upgrading import groups, refuse_for_several, states_of

    chosen = groups(workspace, packages or [])
    refuse_for_several(chosen, model, config or [])
    template = own_template()
    reports = [
        state for group in chosen for state in states_of(group, model, config or [], template)
    ]
    if as_json:
        console.json({"packages": [report.as_json() for report in reports]})
    else:
        for report in reports:
            console.data(report.as_text())
    if any(report.drifted for report in reports):
        raise typer.Exit(ExitStatus.NO)


def verify(
    packages: Annotated[list[Path], typer.Argument()],
    model: Path | None = None,
    config: list[Path] | None = None,
    as_json: bool = False,
) -> None:
    """Prove that the text of packages is their model.

    The model is read from its own file. What is proved, tested, trusted, and what is not, is
    printed; the exit status is 1 when anything differs or is not proved.

    Example: eddi-scaffold verify catkin_ws/src/eddi_monitor/conserta -m two_conserts.xml

    Args:
        packages: Folders of packages of monitors.
        model: Model file; by default it is looked for from the package upwards.
        config: Its configuration; by default as the package remembers it.
    """
    from eddi_scaffold.packages.upgrading import groups
    from eddi_scaffold.packages.verifying import verified

    results = [
        verified(group, folder, model, config or [])
        for group in groups(None, packages)
        for folder, answers in group.present.items()
        if "facts" in answers
    ]
    if as_json:
        console.json({"packages": [result.as_json() for result in results]})
    else:
        console.data("\n".join(result.as_text() for result in results))
    if not all(result.holds for result in results):
        raise typer.Exit(ExitStatus.NO)


def upgrade(
    packages: Packages = None,
    workspace: WherePackagesAre = None,
    model: Path | None = None,
    config: list[Path] | None = None,
    system: Path | None = None,
    models: Path | None = None,
    dry_run: bool = False,
) -> None:
    """Bring packages to this release; hand edits stay.

    Monitors are compiled of the models in their packages. To change a model or a configuration,
    run `generate` again; with -m or -c this command does the same for packages that are there, and
    makes no new ones.

    Example: eddi-scaffold upgrade -w catkin_ws -m example_v2.xml --dry-run

    Args:
        model: Newer model file.
    """
    from eddi_scaffold.connect.robot import robot_models
    from eddi_scaffold.packages import upgrading
    from eddi_scaffold.packages.generation import WriteResult, write_packages
    from eddi_scaffold.packages.rendering import own_template
    from eddi_scaffold.packages.workspace import alone

    if not config and (system is not None or models is not None):
        raise EddiError(problem("G000.no_configuration"))
    outcomes: list[WriteResult] = []
    template = own_template()
    places = upgrading.roots(workspace, packages or [])
    with alone(() if dry_run else places), robot_models(system, models) as (robot, unsure):
        groups = upgrading.groups(workspace, packages or [])
        upgrading.refuse_for_several(groups, model, config or [])
        plans = [(g, *upgrading.targets(g, model, config or [], robot)) for g in groups]
        console.problems(unsure)
        for group, targets, problems in plans:
            console.problems(problems)
            outcome = write_packages(
                group.root,
                targets,
                template,
                dry_run=dry_run,
                progress=console.progress,
            )
            monitors = (made for made in targets if "facts" in made.answers)
            versions = {made.folder: made.answers["generator_version"] for made in monitors}
            compiled = "compiled.py stays as eddi-scaffold {} made it; name the model with -m"
            left = [f"{f}: {compiled.format(v)}" for f, v in versions.items() if v != __version__]
            outcomes.append(replace(outcome, left=[*left, *outcome.left]))
    finish(*outcomes, dry_run=dry_run)


def regions(
    path: Annotated[Path, typer.Argument()] = Path(),
    workspace: WherePackagesAre = None,
    check: bool = False,
    accept: list[str] | None = None,
    as_json: bool = False,
) -> None:
    """List the regions of hand-written code and their state.

    Example: eddi-scaffold regions --check catkin_ws

    Args:
        path: A package, or a folder that holds packages.
        check: Exit with 3 when a person must look; for CI.
        accept: Region id or unfit file that was looked at and is right; repeatable.
    """
    from eddi_scaffold.packages.handwritten import accept_regions, packages_below
    from eddi_scaffold.regions.check import list_regions

    path = path if workspace is None else workspace
    for region_id in accept_regions(path, accept) if accept else ():
        console.say(f"accepted {region_id}")
    entries = [
        status._replace(file=str(package / status.file))
        for package in packages_below(path)
        for status in list_regions(package)
    ]
    if as_json:
        keys = ("id", "file", "line", "state", "notes")
        console.json({"regions": [{key: getattr(entry, key) for key in keys} for entry in entries]})
    else:
        for entry in entries:
            place = f"{entry.file}:{entry.line}" if entry.line else entry.file
            console.data(f"{entry.state:9} {entry.id}  {place}")
            for note in entry.notes:
                console.data(f"          {note}")
    if check and any(entry.review for entry in entries):
        raise typer.Exit(ExitStatus.LOOK)


def adopt(
    package: Path,
    workspace: Path | None = None,
    output: Output = None,
    platform: PlatformOfPlace = None,
    model: Path | None = None,
    name: str | None = None,
    dry_run: bool = False,
) -> None:
    """Take over a package made by the D7.2 tools.

    Every hand-written body is in its place afterwards.

    The old package is only read. Model and configuration are recovered from it and written next to
    the new one.

    Example: eddi-scaffold adopt old/bn_monitor -o monitors

    Args:
        package: Folder of the old package.
        workspace: Workspace to put it into.
        output: Folder to put it into.
        name: Name of the new package, by default the old one's; also which model of a file with
            several.
    """
    from eddi_scaffold.packages.adopting.adopt import adopt as adopted
    from eddi_scaffold.packages.adopting.adopt import write_adopted
    from eddi_scaffold.packages.rendering import own_template
    from eddi_scaffold.packages.workspace import alone, packages_root
    from eddi_scaffold.platforms import DEFAULT, DEFAULT_IN_FOLDER, chosen

    if (workspace is None) == (output is None):
        raise EddiError(problem("G006.none"))
    target = chosen(platform or (DEFAULT_IN_FOLDER if workspace is None else DEFAULT))
    place = destination(target, workspace, output)
    proposal = adopted(package, model, name)
    for note in proposal.notes:
        console.say(note)
    with alone(() if dry_run else [packages_root(target, place)]):
        outcome, problems, report = write_adopted(
            proposal, target, place, own_template(), dry_run=dry_run
        )
    console.problems(problems)
    for line in report:
        console.say(line)
    finish(outcome, dry_run=dry_run)


def trace(
    packages: Packages = None,
    workspace: WherePackagesAre = None,
    model: Path | None = None,
    as_json: bool = False,
) -> None:
    """Print what became of each element of the models.

    A table of packages: model elements, their places, code and topics.

    Example: eddi-scaffold trace -w catkin_ws

    Args:
        model: EDDI XML; its hazards and requirements are followed to what they rest on.
    """
    from eddi_scaffold.deployments.lifetimes import bounds
    from eddi_scaffold.deployments.support import acceptances, facts_of_package
    from eddi_scaffold.packages.tracing import hazard_trace, trace_of
    from eddi_scaffold.packages.upgrading import groups

    chosen = groups(workspace, packages or [])
    present = [package for group in chosen for package in group.present.items()]
    traces = [trace_of(answers) for _, answers in present if "facts" in answers]
    facts = [facts_of_package(folder, answers) for folder, answers in present]
    wired = [wire for wire in facts if wire is not None]
    accepted, limits = acceptances(wired), bounds(wired)
    folders = [group.root / name for group in chosen for name in group.present]
    followed = hazard_trace(model, wired, folders) if model is not None else None
    rows = [*followed.rows.values()] if followed is not None else []
    support = {of.claim: of for row in rows for of in row.support}.values()
    if as_json:
        more = {"hazards": [row.as_json() for row in rows], "support": [*map(asdict, support)]}
        console.json(
            {
                "packages": [trace.as_json() for trace in traces],
                "accepted": [acceptance.as_json() for acceptance in accepted],
                "bounds": [limit.as_json() for limit in limits],
                **(more if model is not None else {}),
            }
        )
    else:
        console.data("\n\n".join(trace.as_text() for trace in traces))
        parts: dict[str, Collection[Any]] = {"accepted": accepted, "silence": limits}
        for title, lines in {**parts, "hazards": rows, "claims": support}.items():
            if lines:
                texts = (f"  {line.as_text()}" for line in lines)
                console.data("\n".join(["", f"{title}:", *texts]))

"""From files on disk to the packages that a command renders: models, configurations, neighbours."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from eddi_scaffold import __version__
from eddi_scaffold.common.identifiers import package_name
from eddi_scaffold.common.problems import (
    EddiError,
    Place,
    Problem,
    did_you_mean,
    has_errors,
    problem,
)
from eddi_scaffold.config.field_types import MessageFields
from eddi_scaffold.config.file import ConfigFile, from_data
from eddi_scaffold.deployments.joining import join, packages_of, unanswered
from eddi_scaffold.deployments.lifetimes import check_ages
from eddi_scaffold.deployments.support import Deployment, WiredMonitor, facts_of_package
from eddi_scaffold.deployments.wiring import absent_publishers, check_wiring, members_of
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.config_reading import RobotAdditions, read_configs, with_types
from eddi_scaffold.monitors.loading import checked_models, select_models
from eddi_scaffold.packages.handwritten import without_written_inputs
from eddi_scaffold.packages.rendering import read_answers
from eddi_scaffold.packages.workspace import check_answers, existing
from eddi_scaffold.platforms import (
    RUNTIME,
    SINGLE_PROCESS,
    Choices,
    PackageAnswers,
    Platform,
    owner_of,
)
from eddi_scaffold.regions.package import known_file


@dataclass(frozen=True)
class PackagePlan:
    """What is to be rendered."""

    packages: Sequence[PackageAnswers]  # all packages of the command
    monitors: Sequence[str]  # folders of the monitor packages among them
    problems: Sequence[Problem]  # warnings and infos about models and configurations
    present: Mapping[str, Mapping[str, Any]]  # package -> answers of those that are there already


def monitors_of(
    model_file: Path | Sequence[Path] | None,
    config_files: Sequence[Path],
    name: str | None = None,
    default_guarantees: Sequence[str] = (),
    robot: RobotAdditions | None = None,
    root: Path | None = None,
    renames: Sequence[str] = (),
) -> tuple[list[BoundMonitor], list[Problem]]:
    """Read a model file, or several, and configurations, and join them.

    With configurations: one monitor for each, of a model in the file or of the file that the
    configuration itself names. Without: one for each model, or the one of ``name``.

    Packages that are below ``root`` run with the monitors: what none of them publishes is a warning
    (D006), and the message types that a package was generated with stay known. With ``OLD=NEW`` in
    ``renames``, the package of the new name is there as the old one.

    Raises:
        EddiError: a file cannot be used, or none is given (G015).
    """
    if not model_file and not config_files:
        raise EddiError(problem("G015.none"))
    read = partial(checked_models, default_guarantees=default_guarantees)
    files = [model_file] if isinstance(model_file, Path) else model_file or ()
    readings = [read(path) for path in files]
    models = [model for reading in readings for model in reading.models]
    pairs = [rename.partition("=") for rename in renames]
    former = {package_name(new): package_name(old) for old, _, new in pairs}
    configs, config_problems = read_configs(config_files, robot)
    ids = [config.config.Model.id for config in configs]
    if name is not None and len(ids) > 1 and name not in ids:
        hint = did_you_mean(name, ids) or f"there are: {', '.join(ids)}"
        raise EddiError(problem("F005", Place(), hint=hint, kind=f"no monitor {name!r}"))
    if model_file and name is not None and len(ids) < 2:
        models = [*select_models(models, name)]
    if root is not None:
        configs = [
            with_types(config, _remembered_types(config, root, former)) for config in configs
        ]
    monitors, join_problems = join(models, configs, read, default_guarantees)
    problems = [problem for reading in readings for problem in reading.problems]
    configured = [monitor.model for monitor in monitors if monitor.config is not None]
    problems = unanswered([*problems, *config_problems, *join_problems], configured)
    if has_errors(problems):
        raise EddiError(*problems)
    if root is not None:
        made = {*(package_name(config.config.Model.id) for config in configs), *former.values()}
        others = _others(existing(root, made), made)
        problems += absent_publishers(Deployment(members_of(monitors), others))
    if name is not None and len(ids) > 1:  # the others of its file were checked with it
        monitors = [monitor for monitor in monitors if monitor.id == name]
    return monitors, problems


def _remembered_types(config: ConfigFile, root: Path, former: Mapping[str, str]) -> MessageFields:
    """Return the message types of a package: the models of the robot need not be given again."""
    package = package_name(config.config.Model.id)
    folder = root / former.get(package, package)
    answers = read_answers(folder) or {}
    with suppress(EddiError):  # reported, if it matters, where the package is written
        check_answers(folder, answers)
        if text := answers.get("config"):
            return from_data(text, folder.name).config.MessageTypes
    return {}


def only(monitors: Sequence[BoundMonitor]) -> BoundMonitor:
    """Return the only monitor; EddiError G005 where there are several."""
    if len(monitors) != 1:
        names = ", ".join(monitor.model.name for monitor in monitors)
        raise EddiError(problem("G005.several_or_configuration", names=names))
    return monitors[0]


def assemble(
    monitors: Sequence[BoundMonitor],
    platform: Platform,
    root: Path,
    problems: Sequence[Problem],
    chosen: Choices | None = None,
    gone: Container[str] = (),
) -> PackagePlan:
    """Turn monitors into packages, next to those that exist below ``root``.

    ``chosen`` is what is to be otherwise than it was chosen before, for all monitors that share
    packages; the packages in ``gone`` will have another name.

    Raises:
        EddiError: a package name cannot be used, a configuration lacks what the platform needs, or
            the platform does not have what is chosen.
    """
    chosen = chosen or {}
    renewed = {monitor.package for monitor in monitors}
    before = existing(root, renewed)
    present = {name: answers for name, answers in before.items() if name not in gone}
    reported = list(dict.fromkeys([*problems, *wiring_with(monitors, present)]))
    checked = [cross_checked(monitor, reported) for monitor in monitors]
    packages, package_problems = packages_of(checked, platform, root)
    reported += package_problems
    if packages and any(monitor.config is None for monitor in monitors):
        reported += [
            problem("G001.had_configuration", Place(str(root / name)))
            for name, answers in before.items()
            if (name in renewed or name in gone) and answers.get("config")
        ]
    if packages and chosen.get(SINGLE_PROCESS) and SINGLE_PROCESS not in packages[0].answers:
        reported.append(problem("G000.single_process", platform=platform.name))
    if has_errors(reported):
        raise EddiError(*reported)
    folders = [package.folder for package in packages]
    sharing = platform.templates[0] if platform.templates[1:] else None
    companions = {name: of for name, of in present.items() if of["template"] == sharing}
    renamed = [answers for name, answers in before.items() if name in gone]
    packages = [
        with_choices(new, [chosen, present.get(new.folder, {}), *companions.values(), *renamed])
        for new in packages
    ]
    asked = {key: value for key, value in chosen.items() if any(key in p.answers for p in packages)}
    packages += [
        stored(root / folder, {**answers, **asked})
        for folder, answers in companions.items()
        if folder not in folders and {**answers, **asked} != answers
    ]
    made = {package.folder: package.answers for package in packages}
    shared = support(platform, root, before, made, gone)
    reported = without_written_inputs(reported, lambda package: [root / package])
    return PackagePlan([*packages, *shared], folders, reported, before)


def with_choices(package: PackageAnswers, chosen: Sequence[Mapping[str, Any]]) -> PackageAnswers:
    """Return a package of a monitor with what a person chose, as far as its template asks for it.

    Of several answers the first one counts.
    """
    answers = package.answers
    choices = {
        key: next((answer[key] for answer in chosen if key in answer), answers[key])
        for key in (RUNTIME, SINGLE_PROCESS)
        if key in answers
    }
    return replace(package, answers={**answers, **choices})


def wiring_with(
    monitors: Sequence[BoundMonitor], present: Mapping[str, Mapping[str, Any]]
) -> list[Problem]:
    """Check the wiring of new monitors with packages that are there and stay."""
    others = _others(present, {monitor.package for monitor in monitors})
    members = members_of(monitors)
    return [*check_wiring(members, others), *check_ages(Deployment(members, others))]


def _others(present: Mapping[str, Mapping[str, Any]], new: Container[str]) -> list[WiredMonitor]:
    facts = (facts_of_package(name, of) for name, of in present.items() if name not in new)
    return [monitor for monitor in facts if monitor is not None]


def cross_checked(monitor: BoundMonitor, problems: list[Problem]) -> BoundMonitor:
    """Compare the compiled model with an independent tool, where its kind has one."""
    result = monitor.model.cross_check(lambda: monitor.compiled.monitor(monitor.model.name))
    if result is None:
        return monitor
    problems += result.problems
    return replace(monitor, cross_check=result.text)


def support(
    platform: Platform,
    root: Path,
    present: Mapping[str, Mapping[str, Any]],
    monitors: Mapping[str, Mapping[str, Any]],
    gone: Container[str] = (),
) -> list[PackageAnswers]:
    """Return the shared packages for new or newer monitors and for those that are there already.

    A shared package that is there, but that nothing needs any more, leaves. Both map packages to
    their answers; those in ``gone`` will have another name.

    Raises:
        EddiError: a monitor of another platform has these packages (G027).
    """
    own = platform.templates[0]
    there = {name: of for name, of in present.items() if of["template"] == own and name not in gone}
    shared = platform.support({**there, **monitors})
    for folder in (package.folder for package in shared if package.folder in present):
        owner = owner_of(present[folder]["template"])
        if owner is not platform:
            place = Place(str(root / folder))
            raise EddiError(problem("G027", place, owner=owner.name, platform=platform.name))
    needed = {package.folder for package in shared}
    leaving = [
        PackageAnswers(folder, {})
        for folder, answers in present.items()
        if answers["template"] in platform.templates[1:] and folder not in needed
    ]
    return [*shared, *leaving]


def stored(package: Path, answers: Mapping[str, Any]) -> PackageAnswers:
    """Return a package as it is, its other files too, for the present version of the templates.

    A compiled monitor stays that of the version which compiled it.
    Keys that begin with ``_`` are Copier's own: where the templates came from.
    """
    kept = {key: value for key, value in answers.items() if not key.startswith("_")}
    files = {
        name: data
        for name, digest in answers.get("files", {}).items()
        if (data := known_file(package, name, digest)) is not None
    }
    made = {} if "facts" in answers else {"generator_version": __version__}
    return PackageAnswers(package.name, {**kept, **made}, files)

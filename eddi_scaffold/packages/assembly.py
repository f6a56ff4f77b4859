"""From files on disk to the packages that a command renders: models, configurations, neighbours."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from eddi_scaffold import __version__
from eddi_scaffold.common.identifiers import package_name
from eddi_scaffold.common.problems import EddiError, Place, Problem, has_errors, problem
from eddi_scaffold.config.file import ConfigFile, from_json
from eddi_scaffold.config.message_types import MessageFields
from eddi_scaffold.config.reading import RobotAdditions, read_configs, with_types
from eddi_scaffold.deployments.joining import join, packages_of, unanswered
from eddi_scaffold.deployments.lifetimes import check_ages
from eddi_scaffold.deployments.support import WiredMonitor, facts_of_package
from eddi_scaffold.deployments.topics import absent_publishers, deployment
from eddi_scaffold.deployments.wiring import check_wiring, members_of
from eddi_scaffold.kinds import Model, kinds
from eddi_scaffold.monitors.binding import BoundMonitor, monitor_of
from eddi_scaffold.monitors.loading import checked_models, select_models
from eddi_scaffold.packages.handwritten import without_written_inputs
from eddi_scaffold.packages.renaming import aside
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
from eddi_scaffold.regions.package import manifest_of


@dataclass(frozen=True)
class PackagePlan:
    """What is to be rendered.

    Attributes:
        packages: all packages of the command.
        monitors: folders of the monitor packages among them.
        problems: warnings and infos about models and configurations.
        present: package -> answers of those that are there already.
    """

    packages: Sequence[PackageAnswers]
    monitors: Sequence[str]
    problems: Sequence[Problem]
    present: Mapping[str, Mapping[str, Any]]


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

    Args:
        model_file: the model file, or several.
        config_files: the configurations.
        name: of one model.
        default_guarantees: the marks of ``--default-guarantee``.
        robot: what models of a robot add to the configurations.
        root: folder of all packages, where those that are there run with the monitors: what none
            of them publishes is a warning (D006). The message types that a package was generated
            with stay known.
        renames: ``OLD=NEW``: the package of the new name is there as the old one.

    Raises:
        EddiError: a file cannot be used, or none is given (G015).
    """
    if not model_file and not config_files:
        raise EddiError(problem("G015.none"))
    models: Sequence[Model] = ()
    problems: list[Problem] = []
    for path in [model_file] if isinstance(model_file, Path) else model_file or ():
        reading = checked_models(path, default_guarantees)
        models = [*models, *reading.models]
        problems += reading.problems
    if model_file and name is not None:
        models = select_models(models, name)
    given, unsure = read_configs(config_files, robot)
    problems += unsure
    pairs = [word.partition("=") for word in renames]
    former = {package_name(new): package_name(old) for old, _, new in pairs}
    configs = [with_types(one, _remembered_types(one, root, former)) for one in given]
    read = partial(checked_models, default_guarantees=default_guarantees)
    monitors, found = join(models, configs, read, default_guarantees)
    configured = [monitor.model for monitor in monitors if monitor.config is not None]
    problems = unanswered([*problems, *found], configured)
    if has_errors(problems):
        raise EddiError(*problems)
    if root is not None:
        made = {*(package_name(config.config.Model.id) for config in configs), *former.values()}
        made |= {*map(aside, former.values())}
        others = _beside(existing(root, made), made)
        problems += absent_publishers(deployment(members_of(monitors), others))
    return monitors, problems


def _remembered_types(
    config: ConfigFile, root: Path | None, former: Mapping[str, str]
) -> MessageFields:
    """Return the message types that a package was generated with.

    They stay known where the models of the robot that they came from are not given again.
    """
    if root is None:
        return {}
    package = package_name(config.config.Model.id)
    folder = root / former.get(package, package)
    answers = read_answers(folder) or {}
    try:
        check_answers(folder, answers)
    except EddiError:  # told, if it matters, where the package is written
        return {}
    text = answers.get("config_json")
    return from_json(text, folder.name).config.MessageTypes if text else {}


def only(monitors: Sequence[BoundMonitor]) -> BoundMonitor:
    """Return the only monitor.

    Raises:
        EddiError: there are several (G005).
    """
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

    Args:
        monitors: the new ones.
        platform: where they run.
        root: folder of all packages.
        problems: what was found so far.
        chosen: what is to be otherwise than it was chosen before, for all monitors that share
            packages.
        gone: packages below ``root`` that will have another name.

    Raises:
        EddiError: a package name cannot be used, a configuration lacks what the platform needs, or
            the platform does not have what is chosen.
    """
    chosen = chosen or {}
    renewed = {monitor.package for monitor in monitors}
    before = existing(root, renewed)
    present = {name: of for name, of in before.items() if name not in gone}
    found = list(dict.fromkeys([*problems, *wiring_with(monitors, present)]))
    packages, more = packages_of(
        [_cross_checked(monitor, found) for monitor in monitors], platform, root
    )
    found += more
    if packages and any(monitor.config is None for monitor in monitors):
        found += [
            problem("G001.had_configuration", Place(str(root / name)))
            for name, answers in before.items()
            if (name in renewed or name in gone) and answers.get("config_json")
        ]
    if packages and chosen.get(SINGLE_PROCESS) and SINGLE_PROCESS not in packages[0].answers:
        found.append(problem("G000.single_process", platform=platform.name))
    if has_errors(found):
        raise EddiError(*found)
    new = [package.folder for package in packages]
    sharing = platform.templates.monitor if platform.templates.support else None
    beside = {name: of for name, of in present.items() if of["template"] == sharing}
    renamed = [answers for name, answers in before.items() if name in gone]
    packages = [
        with_choices(one, [chosen, present.get(one.folder, {}), *beside.values(), *renamed])
        for one in packages
    ]
    asked = {
        name: it for name, it in chosen.items() if any(name in one.answers for one in packages)
    }
    packages += [
        stored(root / folder, {**answers, **asked})
        for folder, answers in beside.items()
        if folder not in new and {**answers, **asked} != answers
    ]
    wanted = {package.folder: package.answers for package in packages}
    shared = support(platform, root, before, wanted, gone)
    told = without_written_inputs(found, lambda package: [root / package])
    return PackagePlan([*packages, *shared], new, told, before)


def with_choices(package: PackageAnswers, chosen: Sequence[Mapping[str, Any]]) -> PackageAnswers:
    """Return a package of a monitor with what a person chose, as far as its template asks for it.

    Args:
        package: as it is where nothing was chosen.
        chosen: answers; the first ones that have one count.
    """
    found = {
        name: next((one[name] for one in chosen if name in one), package.answers[name])
        for name in (RUNTIME, SINGLE_PROCESS)
        if name in package.answers
    }
    return replace(package, answers={**package.answers, **found})


def wiring_with(
    monitors: Sequence[BoundMonitor], present: Mapping[str, Mapping[str, Any]]
) -> list[Problem]:
    """Check the wiring of monitors with packages that they do not replace.

    Args:
        monitors: the new ones.
        present: package -> answers of those that are there.
    """
    others = _beside(present, {monitor.package for monitor in monitors})
    members = members_of(monitors)
    return [*check_wiring(members, others), *check_ages(deployment(members, others))]


def _cross_checked(monitor: BoundMonitor, problems: list[Problem]) -> BoundMonitor:
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
    """Return the shared packages for these monitors and those that are there already.

    A shared package that is there, but that nothing needs any more, leaves.

    Args:
        platform: of all of them.
        root: folder of all packages.
        present: package -> answers of those that are there.
        monitors: the same of those that are new, or newer.
        gone: packages that are there, but will have another name.

    Raises:
        EddiError: a monitor of another platform has these packages (G027).
    """
    own = platform.templates.monitor
    there = {
        name: answers
        for name, answers in present.items()
        if answers["template"] == own and name not in gone
    }
    packages = platform.support({**there, **monitors})
    _refuse_other_platform(platform, root, present, [package.folder for package in packages])
    shared = {package.folder: package.answers for package in packages}
    leaving = {
        folder: dict[str, Any]()
        for folder, answers in present.items()
        if answers["template"] in platform.templates.support and folder not in shared
    }
    return [PackageAnswers(folder, answers) for folder, answers in {**shared, **leaving}.items()]


def _refuse_other_platform(
    platform: Platform, root: Path, present: Mapping[str, Mapping[str, Any]], shared: Sequence[str]
) -> None:
    """Refuse to make the shared packages of another platform ours: its monitors need them."""
    for folder in shared:
        owner = owner_of(present[folder]["template"]) if folder in present else platform
        if owner is not platform:
            raise EddiError(
                problem("G027", Place(str(root / folder)), owner=owner.name, platform=platform.name)
            )


def stored(package: Path, answers: Mapping[str, Any]) -> PackageAnswers:
    """Return a package as it is, its tables too, for the present version of the templates.

    A compiled monitor stays that of the version which compiled it.
    Keys that begin with ``_`` are Copier's own: where the templates came from.
    """
    kept = {key: value for key, value in answers.items() if not key.startswith("_")}
    tables = [name for name in manifest_of(package).files if name.endswith(".bin")]
    files = {name: (package / name).read_bytes() for name in tables if (package / name).is_file()}
    made = {} if "compiled" in answers else {"generator_version": __version__}
    return PackageAnswers(package.name, {**kept, **made}, files)


def rejoined(
    present: Mapping[str, Mapping[str, Any]],
    models: Mapping[str, Model],
    configs: Mapping[str, ConfigFile],
) -> dict[str, tuple[BoundMonitor, list[Problem]]]:
    """Join newer models with the configurations that packages remember, or with newer ones.

    Args:
        present: package -> answers of those that are there.
        models: package -> newer model.
        configs: package -> newer configuration.

    Raises:
        EddiError: a model no longer fits.
    """
    return {
        folder: _rejoined(present[folder], models[folder], configs.get(folder), folder)
        for folder in present
        if folder in models
    }


def _rejoined(
    answers: Mapping[str, Any], model: Model, config: ConfigFile | None, folder: str
) -> tuple[BoundMonitor, list[Problem]]:
    kind = kinds()[answers["kind"]]
    if answers.get("config_json"):
        old = from_json(answers["config_json"], f"the configuration that {folder} remembers")
        # types that came from models of the robot stay known without these
        config = old if config is None else with_types(config, old.config.MessageTypes)
    marks = answers.get("default_guarantees") or ()
    monitor, problems = monitor_of(model, kind, config, marks)
    if monitor is None:
        raise EddiError(*problems)
    if config is None:
        monitor = replace(monitor, package=folder)  # whatever the file is called today
    return monitor, problems


def _beside(
    present: Mapping[str, Mapping[str, Any]], new: Container[str]
) -> Sequence[WiredMonitor]:
    """Return the monitors of the packages that are not made anew."""
    found = (facts_of_package(name, of) for name, of in present.items() if name not in new)
    return [one for one in found if one is not None]

"""From files on disk to the packages that a command renders: models, configurations, neighbours."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from eddi_scaffold import __version__
from eddi_scaffold.binding import Monitor, monitor_of
from eddi_scaffold.checking import kinds_of, model_for, no_package_name
from eddi_scaffold.config import (
    Config,
    ConfigFile,
    Robot,
    from_json,
    named_model_path,
    read_config,
)
from eddi_scaffold.generation import PRIVATE_ANSWERS, existing
from eddi_scaffold.kinds import Model, kinds
from eddi_scaffold.message_types import known_messages
from eddi_scaffold.models import checked_models, select
from eddi_scaffold.neighbours import check_ids, check_neighbours
from eddi_scaffold.platforms import PackageAnswers, Platform
from eddi_scaffold.problems import EddiError, Problem, error, has_errors
from eddi_scaffold.source import read_source

_IDENTITY = ("maintainer_name", "maintainer_email", "license")


@dataclass(frozen=True)
class Assembly:
    """What is to be rendered.

    Attributes:
        packages: all packages of the command.
        monitors: folders of the monitor packages among them.
        problems: warnings and infos about models and configurations.
    """

    packages: Sequence[PackageAnswers]
    monitors: Sequence[str]
    problems: Sequence[Problem]


def monitors_of(
    model_file: Path | None,
    config_files: Sequence[Path],
    name: str | None = None,
    default_guarantees: Sequence[str] = (),
    robot: Robot | None = None,
) -> tuple[list[Monitor], list[Problem]]:
    """Read a model file and configurations, and join them.

    With configurations: one monitor for each, of a model in the file or of the file that the
    configuration itself names. Without: one for each model, or the one of ``name``.

    Raises:
        EddiError: a file cannot be used.
    """
    models: Sequence[Model] = ()
    problems: list[Problem] = []
    if model_file is not None:
        reading = checked_models(model_file, default_guarantees)
        models = select(reading.models, name) if name is not None else reading.models
        problems += reading.problems
    monitors: list[Monitor] = []
    configs = _configs(config_files, problems, robot)
    problems += check_neighbours(configs)
    for config in configs:
        model = model_for(config, _candidates(config, models, problems))[0]
        _join(model, config, default_guarantees, monitors, problems)
    for model in () if config_files else models:
        _join(model, None, default_guarantees, monitors, problems)
    problems += check_ids(monitors)
    if has_errors(problems):
        raise EddiError(*problems)
    return monitors, problems


def assemble(
    monitors: Sequence[Monitor], platform: Platform, root: Path, problems: Sequence[Problem]
) -> Assembly:
    """Turn monitors into packages beside those that are below ``root`` already.

    Raises:
        EddiError: a package name cannot be used, or a configuration lacks what the platform needs.
    """
    found = list(problems)
    found += _name_problems(monitors, platform, root)
    packages = []
    for monitor in monitors:
        if monitor.config is None and platform.needs_config:
            message = f"the platform {platform.name} needs a configuration"
            hint = "add `-c eddi_config.yml`, or use `--platform plain`"
            raise EddiError(error("G001", message, hint=hint))
        package, more = platform.monitor(_cross_checked(monitor, found))
        packages.append(package)
        found += more
    if has_errors(found):
        raise EddiError(*found)
    config = next((m.config.config for m in monitors if m.config is not None), None)
    names = [package.folder for package in packages]
    return Assembly([*packages, *support(platform, root, names, config)], names, found)


def _cross_checked(monitor: Monitor, problems: list[Problem]) -> Monitor:
    """Compare the compiled model with an independent tool, where its kind has one."""
    if monitor.kind.cross_check is None:
        return monitor
    result = monitor.kind.cross_check(monitor.model, monitor.model_json)
    problems += result.problems
    return replace(monitor, cross_check=result.text)


def _candidates(
    config: ConfigFile, models: Sequence[Model], problems: list[Problem]
) -> Sequence[Model]:
    """Return the models among which a configuration chooses; reads the file that it names."""
    kind_names = {kind.name for kind in kinds_of(config)}
    if any(model.kind in kind_names for model in models):
        return models
    path = named_model_path(config)
    if path is None:
        if not models:
            hint = "add `-m MODEL`, or name it: `parameters: [{model: FILE}]`"
            place = config.place("Model")
            raise EddiError(error("G015", "the configuration does not say of what", place, hint))
        return models
    reading = checked_models(path)
    problems += reading.problems
    return reading.models


def support(
    platform: Platform, root: Path, monitors: Iterable[str], config: Config | None
) -> list[PackageAnswers]:
    """Return the shared packages for these monitors and those that are there already.

    Who maintains a shared package was said when it was first generated, and stays.
    """
    present = existing(root)
    template = f"{platform.name}_monitor"
    names = {name for name, answers in present.items() if answers["template"] == template}
    packages = platform.support(sorted(names | set(monitors)), config)
    return [
        PackageAnswers(
            package.folder, {**package.answers, **_kept_identity(present.get(package.folder, {}))}
        )
        for package in packages
    ]


def stored(folder: str, answers: Mapping[str, Any]) -> PackageAnswers:
    """Return the answers of a package as they are, for the present version of the templates."""
    kept = {key: value for key, value in answers.items() if key not in PRIVATE_ANSWERS}
    return PackageAnswers(folder, {**kept, "generator_version": __version__})


def rejoined(
    answers: Mapping[str, Any], model: Model, config: ConfigFile | None, folder: str
) -> tuple[Monitor, list[Problem]]:
    """Join a newer model with the configuration that a package remembers, or with a newer one.

    Raises:
        EddiError: the model no longer fits.
    """
    kind = kinds()[answers["kind"]]
    if config is None and answers.get("config_json"):
        config = from_json(answers["config_json"], f"the configuration that {folder} remembers")
    marks = answers.get("default_guarantees") or ()
    known = known_messages(kinds().values())
    monitor, problems = monitor_of(model, kind, config, known, marks)
    if monitor is None:
        raise EddiError(*problems)
    return monitor, problems


def _configs(
    files: Sequence[Path], problems: list[Problem], robot: Robot | None
) -> list[ConfigFile]:
    configs = []
    for path in files:
        config, found = read_config(read_source(path), robot)
        problems += found
        configs += [config] if config is not None else []
    if has_errors(problems):
        raise EddiError(*problems)
    return configs


def _join(
    model: Model,
    config: ConfigFile | None,
    marks: Sequence[str],
    monitors: list[Monitor],
    problems: list[Problem],
) -> None:
    known = known_messages(kinds().values())
    monitor, found = monitor_of(model, kinds()[model.kind], config, known, marks)
    problems += found
    monitors += [monitor] if monitor is not None else []


def _name_problems(
    monitors: Sequence[Monitor], platform: Platform, root: Path
) -> Iterable[Problem]:
    taken = platform.taken_names(root)
    first: dict[str, Monitor] = {}
    for monitor in monitors:
        shown = monitor.config.config.Model.id if monitor.config else monitor.model.name
        place = monitor.config.place("Model", "id") if monitor.config else monitor.model.place
        yield from no_package_name(monitor)
        if monitor.package in taken:
            message = f"a package {monitor.package!r} cannot be used: {taken[monitor.package]}"
            yield error(
                "G003", message, place, f"choose another Model id, for instance {shown}_monitor"
            )
        other = first.setdefault(monitor.package, monitor)
        if other is not monitor:
            both = f"{other.model.name!r} and {monitor.model.name!r}"
            message = f"{both} give the same package {monitor.package!r}"
            yield error("G004", message, place, "choose another Model id in one configuration")


def _kept_identity(answers: Mapping[str, Any]) -> dict[str, Any]:
    return {key: answers[key] for key in _IDENTITY if key in answers}

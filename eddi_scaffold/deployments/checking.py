"""``check`` as a function: every problem of some files, and of their combination."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.common.problems import EddiError, Problem, has_errors, problem, shortened_list
from eddi_scaffold.config.deployment_file import is_fleet
from eddi_scaffold.config.file import ConfigFile, named_model_path
from eddi_scaffold.deployments.fleet_checks import check_fleet
from eddi_scaffold.deployments.joining import join, packages_of
from eddi_scaffold.deployments.topics import Deployment, absent_publishers
from eddi_scaffold.deployments.wiring import members_of
from eddi_scaffold.eddi_xml.reading import recognises as is_xml
from eddi_scaffold.kinds import Model, ReadResult
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.config_reading import RobotAdditions, read_config
from eddi_scaffold.monitors.input_binding import UnwrittenInput
from eddi_scaffold.monitors.loading import (
    checked_models,
    is_config,
    no_model,
    read_models,
    without_model,
)
from eddi_scaffold.monitors.topic_types import check_types
from eddi_scaffold.platforms import DEFAULT, Platform, chosen

_OF_WHAT_LACKS = ("D006", "G001", "X037")
"""What is said of something that no file has: it may be in one that could not be read."""


@dataclass(frozen=True)
class ByHand(UnwrittenInput):
    """An input that only hand-written code can make of its messages (K050)."""

    of: str = ""  # the input and its monitor, for people


def check_files(
    files: Sequence[Path],
    default_guarantees: Sequence[str] = (),
    robot: RobotAdditions | None = None,
    platform: str | None = None,
) -> list[Problem]:
    """Check every file by itself, and all that ``generate`` would make of them together.

    Args:
        files: models and configurations.
        default_guarantees: the marks of ``--default-guarantee``.
        robot: what models of a robot add to the configurations.
        platform: where monitors are to run. By default, models with configurations are checked for
            the default platform, with ``lifecycle`` for ROS 2, others by themselves.

    Raises:
        EddiError: there is no such platform.
    """
    target = chosen(platform) if platform is not None else None
    read = partial(_named, marks=default_guarantees)
    problems: list[Problem] = []
    of_fleets: set[Path] = set()  # these are checked with their deployment file
    sources: list[Source | EddiError] = []
    for path in files:
        try:
            source = read_source(path)
        except EddiError as failure:
            sources.append(failure)
            continue
        if not is_fleet(source):
            sources.append(source)
            continue
        reported, of_fleet = check_fleet(source, read)
        problems += reported
        of_fleets |= of_fleet
    models, configs, reported, are_complete = _read_files(
        [
            source
            for source in sources
            if isinstance(source, EddiError) or Path(source.name).resolve() not in of_fleets
        ],
        default_guarantees,
        robot,
        target,
    )
    problems += reported
    alone = [] if models else [config for config in configs if not _names_its_model(config)]
    if not has_errors(problems):  # else what is wrong may be the file with their models
        problems += [
            reported for config in alone for reported in _check_without_model(config, target)
        ]
    configs = [config for config in configs if config not in alone]
    if target is None and configs:
        managed = any(config.config.Model.lifecycle for config in configs)
        target = chosen("ros2" if managed else DEFAULT)
    reported = _together(models, configs, target, default_guarantees)
    problems += [each for each in reported if are_complete or each.code not in _OF_WHAT_LACKS]
    # that a VAR has no TIMEOUT is a question to whoever uses the model without a configuration
    return [each for each in problems if each.code != "W003"]


def _read_files(
    files: Iterable[Source | EddiError],
    marks: Sequence[str],
    robot: RobotAdditions | None,
    target: Platform | None,
) -> tuple[list[Model], list[ConfigFile], list[Problem], bool]:
    """Read every file, with all that is wrong with it by itself; tell whether all could be read."""
    models: list[Model] = []
    configs: list[ConfigFile] = []
    problems: list[Problem] = []
    are_complete = True
    for source in files:
        if isinstance(source, EddiError):
            problems += source.problems
            are_complete = False
        elif is_config(source):
            config, reported = read_config(source, robot, partly=True)
            configs += [config] if config is not None else []
            are_complete &= not has_errors(reported)
            problems += reported
        else:
            reading = read_models(source, marks)
            own = [*reading.problems, *reading.unread, *_static(reading.models)]
            if is_xml(source) and not reading.models and not has_errors(own):
                own.append(_requested(no_model(source), target))
            models += reading.models
            problems += own
            are_complete &= bool(reading.models)
    return models, configs, problems, are_complete


def _requested(missing: Problem, target: Platform | None) -> Problem:
    """Return an error where a monitor is asked for; files by themselves may be what they are."""
    return missing if target is not None else replace(missing, level="warning")


def _check_without_model(config: ConfigFile, target: Platform | None) -> Iterator[Problem]:
    """Report what shows in a configuration without its model."""
    yield _requested(without_model(config), target)
    used = {name for entry in config.config.EDDIInputs for name in entry.requires}
    yield from check_types(config, used)


def _static(models: Iterable[Model]) -> list[Problem]:
    return [problem for model in models for problem in model.check()]


def _named(path: Path, marks: Sequence[str]) -> ReadResult:
    """Read the file that a configuration names, and report all problems in it."""
    reading = checked_models(path, marks)
    return ReadResult(reading.models, (*reading.problems, *_static(reading.models)))


def _names_its_model(config: ConfigFile) -> bool:
    try:
        return named_model_path(config) is not None
    except EddiError:
        return True  # joining reports why


def _together(
    models: Sequence[Model],
    configs: Sequence[ConfigFile],
    platform: Platform | None,
    marks: Sequence[str],
) -> list[Problem]:
    """Return what is wrong with models and configurations as monitors of a platform."""
    if platform is None:
        return []
    monitors, problems = join(models, configs, partial(_named, marks=marks), marks)
    problems += packages_of(monitors, platform, None)[1]
    joined = {monitor.config.name for monitor in monitors if monitor.config}
    if joined >= {config.name for config in configs}:
        problems += absent_publishers(Deployment(members_of(monitors)))
    return [*problems, *_by_hand(monitors), *_unbound(models, monitors)]


def _unbound(models: Sequence[Model], monitors: Sequence[BoundMonitor]) -> Iterable[Problem]:
    """Name the models of an EDDI that should observe something, but run nowhere (X037)."""
    running = [monitor.model for monitor in monitors if monitor.config]
    places = {(model.source.name, model.place.path) for model in running}
    for model in models if places else ():
        if model.observes and (model.source.name, model.place.path) not in places:
            events = shortened_list({name: None for name, _ in model.observes})
            yield problem("X037", model.place, event=events, model=model.name)


def _by_hand(monitors: Iterable[BoundMonitor]) -> Iterable[Problem]:
    """Name the inputs that only hand-written code can make of their messages (K050)."""
    for monitor in monitors:
        if monitor.config is None:
            continue
        config, package = monitor.config, monitor.package
        if needed := monitor.needed_methods:
            regions = tuple(method.name for method in needed)
            reported = problem("K050.methods", config.place("Model"), names=shortened_list(regions))
            yield UnwrittenInput(**vars(reported), package=package, regions=regions)
        index = {entry.id: number for number, entry in enumerate(config.config.EDDIInputs)}
        for binding in monitor.inputs:
            if binding.requires and not binding.is_given:
                of = f"{binding.model.id} (input of {monitor.id})"
                place = config.place("EDDIInputs", index[binding.model.id])
                reported, regions = problem("K050.input", place, input=of), binding.regions
                yield ByHand(**vars(reported), package=package, regions=regions, of=of)

"""Models joined with configurations and fitted to a platform: the one way of every command.

``check`` reports what is found here, every other command refuses by it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path

from eddi_scaffold.common.identifiers import is_package_name
from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.deployments.lifetimes import check_ages
from eddi_scaffold.deployments.support import Accepted, Deployment, acceptances
from eddi_scaffold.deployments.wiring import check_wiring, members_of
from eddi_scaffold.kinds import Model, ReadResult
from eddi_scaffold.monitors.binding import BoundMonitor, monitor_of
from eddi_scaffold.monitors.loading import candidates, checked_models, model_for
from eddi_scaffold.monitors.publications import check_ids, check_limits
from eddi_scaffold.platforms import PackageAnswers, Platform


def join(
    models: Sequence[Model],
    configs: Sequence[ConfigFile],
    read: Callable[[Path], ReadResult],
    marks: Sequence[str] = (),
) -> tuple[list[BoundMonitor], list[Problem]]:
    """Join each configuration with its model; without configurations, every model by itself.

    The file that a configuration names is read where none of the models is for it.

    Returns:
        The monitors without errors, and all problems.
    """
    problems = [reported for config in configs for reported in check_limits(config)]
    pairs: list[tuple[Model, ConfigFile | None]] = []
    for config in configs:
        try:
            reading = candidates(config, models, read)
            problems += reading.problems
            model = model_for(config, reading.models)
        except EddiError as failure:
            problems += failure.problems
            continue
        pairs.append((model, config))
    if not configs:
        pairs = [(model, None) for model in models]
    monitors, reported = join_pairs(pairs, marks)
    members = members_of(monitors)
    problems += [*reported, *_check_packages(monitors), *check_wiring(members)]
    return monitors, [*problems, *check_ages(Deployment(members))]


def join_pairs(
    pairs: Sequence[tuple[Model, ConfigFile | None]],
    marks: Sequence[str] = (),
) -> tuple[list[BoundMonitor], list[Problem]]:
    """Join models with their configurations, but do not look at the wiring between them.

    Returns:
        The monitors without errors, and all problems.
    """
    problems: list[Problem] = []
    monitors: list[BoundMonitor] = []
    for model, config in pairs:
        monitor, reported = monitor_of(model, config, marks)
        problems += reported
        monitors += [monitor] if monitor is not None else []
    return monitors, [*problems, *check_ids(monitors)]


def unanswered(problems: Iterable[Problem], configured: Iterable[Model]) -> list[Problem]:
    """Return problems without what a configuration answers.

    That a VAR has no TIMEOUT (W003): its input has a `max_age`, or it is told that it has none.
    """
    places = {(model.place.file, model.place.path) for model in configured}

    def is_answered(problem: Problem) -> bool:
        model_path = (problem.place.path or "").partition("/@values")[0] or None
        return problem.code == "W003" and (problem.place.file, model_path) in places

    return [problem for problem in problems if not is_answered(problem)]


def packages_of(
    monitors: Sequence[BoundMonitor], platform: Platform, root: Path | None
) -> tuple[list[PackageAnswers], list[Problem]]:
    """Return the packages of monitors on a platform, and all that is in the way of them.

    ``root`` is the folder of all packages of the platform, ``None`` while there is no destination.
    """
    problems = list(_check_names(monitors, platform, root))
    packages: list[PackageAnswers] = []
    for monitor in monitors:
        if monitor.config is None and platform.needs_config:
            return [], [*problems, problem("G001.configuration", platform=platform.name)]
        package, reported = platform.monitor(monitor)
        packages.append(package)
        problems += reported
        config, is_managed = monitor.config, "lifecycle" in package.answers
        if config is not None and config.config.Model.lifecycle and not is_managed:
            place = config.place("Model", "lifecycle")
            problems.append(problem("K084", place, platform=platform.name))
    return packages, problems


def _place_of_id(monitor: BoundMonitor) -> Place:
    return monitor.config.place("Model", "id") if monitor.config else monitor.model.place


def _check_packages(monitors: Sequence[BoundMonitor]) -> Iterable[Problem]:
    """Report monitors of one package: its files, topics and verdicts would be those of one."""
    first: dict[str, BoundMonitor] = {}
    for monitor in monitors:
        other = first.setdefault(monitor.package, monitor)
        if other is not monitor:
            place, both = _place_of_id(monitor), f"{other.model.name!r} and {monitor.model.name!r}"
            yield problem("G004.same_package", place, both=both, package=monitor.package)


def _check_names(
    monitors: Sequence[BoundMonitor], platform: Platform, root: Path | None
) -> Iterable[Problem]:
    taken = platform.taken_names(root)
    for monitor in monitors:
        model, config, package = monitor.model, monitor.config, monitor.package
        id_ = config.config.Model.id if config else model.file_stem or model.name
        place = _place_of_id(monitor)
        if not is_package_name(package):
            yield problem("G002.no_package_name", place, id=id_)
        if (why := taken.get(package)) is not None:
            yield problem("G003.unusable_package", place, package=package, taken=why, id=id_)


def accepted_of(
    models: Sequence[Model], configs: Sequence[ConfigFile], marks: Sequence[str] = ()
) -> tuple[list[Accepted], list[Model], list[Problem]]:
    """Return what configurations accept, with the claims that rest on it, or the errors.

    Between them are the models as they are configured; those that no configuration is about stay.
    """
    if not configs:
        return [], list(models), []
    monitors, problems = join(models, configs, partial(checked_models, default_guarantees=marks))
    errors = [problem for problem in problems if problem.level == "error"]
    if errors:
        return [], list(models), errors
    accepted = acceptances(members_of(monitors))
    configured = {_identity(monitor.model): monitor.model for monitor in monitors}
    return accepted, [configured.get(_identity(model), model) for model in models], []


def _identity(model: Model) -> tuple[str, str, str]:
    return model.kind, model.source.name, model.place.path or model.name  # may be named anew

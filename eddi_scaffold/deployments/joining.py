"""Models joined with configurations and fitted to a platform: the one way of every command.

``check`` reports what is found here, every other command refuses by it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.message_types import known_messages
from eddi_scaffold.config.model_path import named_model, named_model_path
from eddi_scaffold.deployments.wiring.check import check_wiring, members_of
from eddi_scaffold.identifiers import is_package_name, package_name
from eddi_scaffold.kinds import Kind, Model, Reading, kinds
from eddi_scaffold.monitors.binding import Monitor, monitor_of
from eddi_scaffold.monitors.connections import check_ids, check_neighbours
from eddi_scaffold.platforms import PackageAnswers, Platform
from eddi_scaffold.problems import EddiError, Problem, error


def join(
    models: Sequence[Model],
    configs: Sequence[ConfigFile],
    read: Callable[[Path], Reading],
    marks: Sequence[str] = (),
) -> tuple[list[Monitor], list[Problem]]:
    """Join each configuration with its model; without configurations, every model by itself.

    Args:
        models: those that are given.
        configs: those that are given.
        read: reads the file that a configuration names, where none of the models is for it;
            raises EddiError.
        marks: the default guarantees that are marked.

    Returns:
        The monitors without errors, and all problems.
    """
    problems = list(check_neighbours(configs))
    monitors: list[Monitor] = []
    for config in configs:
        try:
            reading = _candidates(config, models, read)
            problems += reading.problems
            model = model_for(config, reading.models)
        except EddiError as failure:
            problems += failure.problems
            continue
        _add(model, config, marks, monitors, problems)
    for model in () if configs else models:
        _add(model, None, marks, monitors, problems)
    problems += check_ids(monitors)
    problems += check_wiring(members_of(monitors))
    return monitors, problems


def packages_of(
    monitors: Sequence[Monitor], platform: Platform, root: Path | None
) -> tuple[list[PackageAnswers], list[Problem]]:
    """Return the packages of monitors on a platform, and all that is in the way of them.

    ``root`` is the folder of all packages of the platform, ``None`` while there is no destination.
    """
    problems = list(_check_names(monitors, platform, root))
    packages: list[PackageAnswers] = []
    for monitor in monitors:
        if monitor.config is None and platform.needs_config:
            message = f"the platform {platform.name} needs a configuration"
            hint = "add `-c eddi_config.yml`, or use `--platform plain`"
            return [], [*problems, error("G001", message, hint=hint)]
        package, found = platform.monitor(monitor)
        packages.append(package)
        problems += found
    return packages, problems


def model_for(config: ConfigFile, models: Sequence[Model]) -> Model:
    """Find the model that a configuration is about.

    Raises:
        EddiError: there is no kind of its type (K027), or no model of its type and id (K026).
    """
    section = config.config.Model
    of_type = {kind.name for kind in _kinds_of(config)}
    if not of_type:
        known = ", ".join(kind.config_types[0] for kind in kinds().values())
        message = f"there is no monitor kind {section.type!r}"
        raise EddiError(
            error("K027", message, config.place("Model", "type"), f"known types: {known}")
        )
    fitting = [model for model in models if model.kind in of_type]
    wanted = package_name(section.id)
    found = [model for model in fitting if package_name(model.name) == wanted]
    if not found and (name := named_model(config)) is not None:
        named = Path(config.path(name)).resolve()
        found = [model for model in fitting if Path(model.source.name).resolve() == named]
    if not found and len(fitting) == 1 and len(models) == 1:
        found = (
            fitting  # one model, one configuration: the id of the configuration names the package
        )
    if not found:
        names = ", ".join(model.name for model in fitting) or "none"
        message = f"there is no {section.type} called {section.id!r}"
        raise EddiError(error("K026", message, config.place("Model", "id"), f"there are: {names}"))
    return found[0]


def _kinds_of(config: ConfigFile) -> Sequence[Kind]:
    """Return the kinds that the ``Model: type:`` of a configuration can mean."""
    wanted = config.config.Model.type.casefold()
    return [
        kind
        for kind in kinds().values()
        if wanted in {name.casefold() for name in kind.config_types}
    ]


def _candidates(
    config: ConfigFile, models: Sequence[Model], read: Callable[[Path], Reading]
) -> Reading:
    """Return the models among which a configuration chooses: those given, else what it names."""
    fitting = {kind.name for kind in _kinds_of(config)}
    if any(model.kind in fitting for model in models):
        return Reading(tuple(models), ())
    path = named_model_path(config)
    if path is not None:
        return read(path)
    if not models:
        raise EddiError(without_model(config))
    return Reading(tuple(models), ())


def without_model(config: ConfigFile) -> Problem:
    """Return G015: no model is given, and the configuration names none."""
    hint = "add the model, or name it: `parameters: [{model: FILE}]`"
    message = "the configuration does not say of what"
    return error("G015", message, config.place("Model"), hint)


def _add(
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


def _check_names(
    monitors: Sequence[Monitor], platform: Platform, root: Path | None
) -> Iterable[Problem]:
    taken = platform.taken_names(root)
    first: dict[str, Monitor] = {}
    for monitor in monitors:
        shown = monitor.config.config.Model.id if monitor.config else monitor.model.name
        place = monitor.config.place("Model", "id") if monitor.config else monitor.model.place
        if not is_package_name(monitor.package):
            hint = "choose another Model id: a letter and one more letter or digit are needed"
            yield error("G002", f"the id {shown!r} gives no package name", place, hint)
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

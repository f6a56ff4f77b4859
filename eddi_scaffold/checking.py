"""``check`` as a function: every problem of some files, and of their combination."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from eddi_scaffold.binding import Monitor, monitor_of
from eddi_scaffold.config import ConfigFile, Robot, named_model, named_model_path, read_config
from eddi_scaffold.identifiers import is_package_name, package_name
from eddi_scaffold.kinds import Kind, Model, kinds
from eddi_scaffold.message_types import known_messages
from eddi_scaffold.models import is_config, read_models
from eddi_scaffold.neighbours import check_ids, check_neighbours
from eddi_scaffold.problems import EddiError, Problem, error
from eddi_scaffold.source import Source, read_source


def check_files(
    files: Sequence[Path], default_guarantees: Sequence[str] = (), robot: Robot | None = None
) -> list[Problem]:
    """Check every file by itself, then each configuration against the models among the files."""
    problems: list[Problem] = []
    models: list[Model] = []
    configs: list[ConfigFile] = []
    for path in files:
        try:
            source = read_source(path)
        except EddiError as failure:
            problems += failure.problems
            continue
        found, read, config = _check_one(source, default_guarantees, robot)
        problems += found
        models += read
        configs += [config] if config is not None else []
    problems += check_neighbours(configs)
    monitors: list[Monitor] = []
    for config in configs:
        named, found = _named(config, models, default_guarantees)
        problems += found
        if named:
            problems += _check_pair(config, named, monitors)
    return [*problems, *check_ids(monitors)]


def kinds_of(config: ConfigFile) -> Sequence[Kind]:
    """Return the kinds that the ``Model: type:`` of a configuration can mean."""
    wanted = config.config.Model.type.casefold()
    return [
        kind
        for kind in kinds().values()
        if wanted in {name.casefold() for name in kind.config_types}
    ]


def model_for(config: ConfigFile, models: Sequence[Model]) -> tuple[Model, Kind]:
    """Find the model that a configuration is about.

    Raises:
        EddiError: there is none of its type and id (K026).
    """
    section = config.config.Model
    of_type = {kind.name: kind for kind in kinds_of(config)}
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
        named = config.beside(name).resolve()
        found = [model for model in fitting if Path(model.source.name).resolve() == named]
    if not found and len(fitting) == 1 and len(models) == 1:
        found = (
            fitting  # one model, one configuration: the id of the configuration names the package
        )
    if not found:
        names = ", ".join(model.name for model in fitting) or "none"
        message = f"there is no {section.type} called {section.id!r}"
        raise EddiError(error("K026", message, config.place("Model", "id"), f"there are: {names}"))
    return found[0], of_type[found[0].kind]


def _named(
    config: ConfigFile, models: Sequence[Model], default_guarantees: Sequence[str]
) -> tuple[Sequence[Model], list[Problem]]:
    """Return the models that a configuration chooses among: those given, else what it names."""
    fitting = {kind.name for kind in kinds_of(config)}
    if any(model.kind in fitting for model in models):
        return models, []
    try:
        path = named_model_path(config)
        if path is None:
            return models, []
        found, read, _ = _check_one(read_source(path), default_guarantees)
    except EddiError as failure:
        return (), list(failure.problems)
    return read, found


def _check_one(
    source: Source, default_guarantees: Sequence[str], robot: Robot | None = None
) -> tuple[list[Problem], Sequence[Model], ConfigFile | None]:
    if is_config(source):
        config, problems = read_config(source, robot)
        return problems, (), config
    reading = read_models(source, default_guarantees)
    problems = list(reading.problems)
    for model in reading.models:
        problems += kinds()[model.kind].check(model)
    return problems, reading.models, None


def _check_pair(
    config: ConfigFile, models: Sequence[Model], monitors: list[Monitor]
) -> list[Problem]:
    """Return what is wrong with a configuration and its model; a sound monitor is added."""
    try:
        model, kind = model_for(config, models)
    except EddiError as failure:
        return list(failure.problems)
    monitor, problems = monitor_of(model, kind, config, known_messages(kinds().values()))
    if monitor is None:
        return problems
    monitors.append(monitor)
    return [*problems, *no_package_name(monitor)]


def no_package_name(monitor: Monitor) -> Iterator[Problem]:
    """Say that the id of a monitor gives no name of a package (G002)."""
    if not is_package_name(monitor.package):
        shown = monitor.config.config.Model.id if monitor.config else monitor.model.name
        place = monitor.config.place("Model", "id") if monitor.config else monitor.model.place
        hint = "choose another Model id: a letter and one more letter or digit are needed"
        yield error("G002", f"the id {shown!r} gives no package name", place, hint)

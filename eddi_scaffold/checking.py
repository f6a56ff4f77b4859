"""``check`` as a function: every problem of some files, and of their combination."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from eddi_scaffold.binding import monitor_of
from eddi_scaffold.config import ConfigFile, read_config
from eddi_scaffold.identifiers import package_name
from eddi_scaffold.kinds import Kind, Model, kinds
from eddi_scaffold.models import read_models
from eddi_scaffold.neighbours import check_neighbours
from eddi_scaffold.platforms.ros1.messages import known_messages
from eddi_scaffold.problems import EddiError, Problem, error, with_excerpts
from eddi_scaffold.readers.eddi import sniff as is_xml
from eddi_scaffold.source import Source, read_source
from eddi_scaffold.yaml_nodes import Map, read_map


def check_files(files: Sequence[Path], default_guarantees: Sequence[str] = ()) -> list[Problem]:
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
        found, read, config = _check_one(source, default_guarantees)
        problems += _excerpted(found, source)
        models += read
        configs += [config] if config is not None else []
    joint = list(check_neighbours(configs))
    for config in configs if models else ():
        joint += _check_pair(config, models)
    for config in configs:
        source = read_source(config.name)
        problems += _excerpted([p for p in joint if p.place.file == config.name], source)
    return [*problems, *(p for p in joint if p.place.file not in {c.name for c in configs})]


def is_config(source: Source) -> bool:
    """Tell whether a file is an eddi_config.yml: a map with a section ``Model``."""
    if is_xml(source):
        return False
    node, _ = read_map(source, "E001")
    sections = {"Model", "SimulatorOutputs", "SimulatorOutput", "EDDIInputs"}
    return isinstance(node, Map) and bool(sections & set(node.keys()))


def model_for(config: ConfigFile, models: Sequence[Model]) -> tuple[Model, Kind]:
    """Find the model that a configuration is about.

    Raises:
        EddiError: there is none of its type and id (E026).
    """
    section = config.config.Model
    of_type = {
        kind.name: kind
        for kind in kinds().values()
        if section.type.casefold() in {name.casefold() for name in kind.config_types}
    }
    if not of_type:
        known = ", ".join(kind.config_types[0] for kind in kinds().values())
        message = f"there is no monitor kind {section.type!r}"
        raise EddiError(
            error("E027", message, config.place("Model", "type"), f"known types: {known}")
        )
    fitting = [model for model in models if model.kind in of_type]
    wanted = package_name(section.id)
    found = [model for model in fitting if package_name(model.name) == wanted]
    if not found and len(fitting) == 1 and len(models) == 1:
        found = (
            fitting  # one model, one configuration: the id of the configuration names the package
        )
    if not found:
        names = ", ".join(model.name for model in fitting) or "none"
        message = f"there is no {section.type} called {section.id!r}"
        raise EddiError(error("E026", message, config.place("Model", "id"), f"there are: {names}"))
    return found[0], of_type[found[0].kind]


def _check_one(
    source: Source, default_guarantees: Sequence[str]
) -> tuple[list[Problem], Sequence[Model], ConfigFile | None]:
    if is_config(source):
        config, problems = read_config(source)
        return problems, (), config
    reading = read_models(source, default_guarantees)
    problems = list(reading.problems)
    for model in reading.models:
        problems += kinds()[model.kind].check(model)
    return problems, reading.models, None


def _check_pair(config: ConfigFile, models: Sequence[Model]) -> list[Problem]:
    try:
        model, kind = model_for(config, models)
    except EddiError as failure:
        return list(failure.problems)
    return monitor_of(model, kind, config, known_messages(kinds().values()))[1]


def _excerpted(problems: Sequence[Problem], source: Source) -> list[Problem]:
    text = source.data.decode("utf-8", "replace")
    own = [p for p in problems if p.place.file == source.name]
    others = [p for p in problems if p.place.file != source.name]
    return [*with_excerpts(own, text), *others]

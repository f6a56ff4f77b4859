"""The survey of ``show --json``: every model of a file, also of kinds without a monitor."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.model_path import named_model_path
from eddi_scaffold.config.reading import read_config
from eddi_scaffold.kinds import JsonValue, Model, kinds
from eddi_scaffold.monitors.loading import is_config, is_mros, read_models
from eddi_scaffold.mros import SYSTEM_SUFFIX, MrosSyntaxError, read_ros_models, read_rossystem
from eddi_scaffold.mros.as_json import failure_json, model_json, system_json
from eddi_scaffold.mros.as_tree import model_tree, system_tree
from eddi_scaffold.mros.directory import problem_of
from eddi_scaffold.mros.interface_definitions import noticed
from eddi_scaffold.problems import EddiError, Problem
from eddi_scaffold.readers.eddi import read_document
from eddi_scaffold.readers.eddi import sniff as is_xml
from eddi_scaffold.readers.survey import survey
from eddi_scaffold.readers.unread import unread
from eddi_scaffold.source import Source, read_source


def survey_of(source: Source) -> tuple[dict[str, object], list[Problem]]:
    """Return models, elements and references of a file, and what makes it unreadable."""
    if is_xml(source) and not any(kind.sniff(source) for kind in kinds().values()):
        document, problems = read_document(source)
        if document is None:
            return {"models": []}, problems
        left_out = [one.as_json() for one in unread(document)]
        return {**survey(document).as_json(), "unread": left_out}, problems
    reading = read_models(source)
    models = [
        {
            "kind": model.kind,
            "name": model.name,
            "path": model.place.path,
            "line": model.place.line,
            "counts": dict(kinds()[model.kind].functions.counts(model)),
        }
        for model in reading.models
    ]
    return {"models": models}, []


@dataclass(frozen=True)
class Shown:
    """A ``.rossystem`` or ``.ros*`` file, as both forms of ``show`` print it.

    Attributes:
        document: the JSON object.
        tree: lines; none where the file cannot be read.
    """

    document: dict[str, JsonValue]
    tree: tuple[str, ...]
    problems: tuple[Problem, ...]


def mros_of(source: Source) -> Shown | None:
    """Return what is in a file of the MROS family; ``None`` for another file."""
    if not is_mros(source):
        return None
    try:
        if source.name.endswith(SYSTEM_SUFFIX):
            system = read_rossystem(source.data, source.name)
            document, tree, notices = system_json(system), system_tree(system), system.notices
        else:
            model = read_ros_models(source.data, source.name)
            document, tree, notices = model_json(model), model_tree(model), model.notices
    except MrosSyntaxError as failed:
        problem = replace(problem_of(failed), level="error")
        return Shown(failure_json(failed) | {"problems": [problem.as_json()]}, (), (problem,))
    return Shown(document, tuple(tree), tuple(noticed(notices, source.name)))


@dataclass(frozen=True)
class Configured:
    """The model file to show, and the configurations that are shown with it.

    Attributes:
        source: of the models.
        configs: those that could be read.
        problems: of the configurations.
    """

    source: Source
    configs: tuple[ConfigFile, ...]
    problems: tuple[Problem, ...]


def configured(source: Source, more: Sequence[Source]) -> Configured:
    """Read the configurations; one that is shown by itself names its model.

    Args:
        source: what is to be shown; a configuration that names no model is returned as it is.
        more: configurations that are given with it.

    Raises:
        EddiError: a configuration has errors, or names a file that is not there.
    """
    alone = is_config(source)
    configs: list[ConfigFile] = []
    problems: list[Problem] = []
    for one in (source, *more) if alone else more:
        config, found = read_config(one)
        if config is None:
            raise EddiError(*found)
        configs.append(config)
        problems += found
    path = named_model_path(configs[0]) if alone else None
    source = source if path is None else read_source(path)
    return Configured(source, tuple(configs), tuple(problems))


def only(survey: Mapping[str, Any], chosen: Sequence[Model]) -> dict[str, Any]:
    """Return a survey with no more than the chosen models; the facts of the file stay."""
    return {**survey, "models": [one for one in survey["models"] if is_one_of(one, chosen)]}


def is_one_of(found: Mapping[str, Any], models: Sequence[Model]) -> bool:
    """Is this model of a survey among ``models``?

    In XML its place shows this: a fault tree becomes a model for each of its top events.
    """
    path: str | None = found["path"]
    if path is None:
        return (found["kind"], found["name"]) in {(model.kind, model.name) for model in models}
    inside = path.rstrip("/") + "/"
    places = [model.place.path or "" for model in models]
    return any(place == path or place.startswith(inside) for place in places)

"""Which files of a folder are models, and all models of a file, with a monitor or not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.common.problems import EddiError, Place, Problem, has_errors, problem
from eddi_scaffold.config.deployment_file import is_fleet
from eddi_scaffold.config.file import ConfigFile, named_model_path
from eddi_scaffold.eddi_xml.document import read_document
from eddi_scaffold.eddi_xml.document import recognises as is_xml
from eddi_scaffold.eddi_xml.survey import foreign, survey, unread
from eddi_scaffold.kinds import JsonValue, Model, kinds
from eddi_scaffold.monitors.config_reading import read_file, several
from eddi_scaffold.monitors.loading import YAML_SUFFIXES, is_config, named_like_mros, read_models
from eddi_scaffold.mros import (
    SYSTEM_SUFFIX,
    MrosSyntaxError,
    read_ros_models,
    read_rossystem,
)
from eddi_scaffold.mros.show import failure_json, model_json, model_tree, system_json, system_tree
from eddi_scaffold.yaml_text.nodes import read_map


def survey_of(source: Source) -> tuple[dict[str, object], list[Problem]]:
    """Return models, elements and references of a file, and what makes it unreadable."""
    if is_xml(source) and not any(kind.recognises(source) for kind in kinds().values()):
        document, problems = read_document(source)
        if document is None:
            return {"models": []}, problems
        left_out = []
        for class_name, elements in unread(document).items():
            place = document.place(elements[0])
            entry = {"class": class_name, "count": len(elements)}
            left_out.append({**entry, "path": place.path, "line": place.line})
        return {**survey(document), "unread": left_out}, problems
    reading = read_models(source)
    models = [
        {
            "kind": model.kind,
            "name": model.name,
            "path": model.place.path,
            "line": model.place.line,
            "counts": dict(model.counts()),
        }
        for model in reading.models
    ]
    return {"models": models}, []


@dataclass(frozen=True)
class Shown:
    """A ``.rossystem`` or ``.ros*`` file, as both forms of ``show`` print it."""

    document: dict[str, JsonValue]  # the JSON object
    tree: tuple[str, ...]  # lines; none where the file cannot be read
    problems: tuple[Problem, ...]


def mros_of(source: Source) -> Shown | None:
    """Return what is in a file of the MROS family; ``None`` for another file."""
    if not named_like_mros(source.name):
        return None
    try:
        if source.name.endswith(SYSTEM_SUFFIX):
            system = read_rossystem(source.data, source.name)
            document, tree, problems = system_json(system), system_tree(system), system.problems
        else:
            model = read_ros_models(source.data, source.name)
            document, tree, problems = model_json(model), model_tree(model), model.problems
    except MrosSyntaxError as failed:
        problem = replace(failed.problems[0], level="error")
        return Shown(failure_json(failed) | {"problems": [problem.as_json()]}, (), (problem,))
    return Shown(document, tuple(tree), tuple(problems))


def configured(
    source: Source, more: Sequence[Source], name: str | None = None
) -> tuple[Source, list[ConfigFile], list[Problem]]:
    """Return the model file to show, the configurations that are shown with it, and warnings.

    A configuration that is shown by itself names its model; of several in a file the name chooses.

    Raises:
        EddiError: a configuration has errors, or names a file that is not there.
    """
    alone = is_config(source)
    configs: list[ConfigFile] = []
    problems: list[Problem] = []
    for file in (source, *more) if alone else more:
        read, problems_of_file = read_file(file)
        if has_errors(problems_of_file):
            raise EddiError(*problems_of_file)
        configs += read
        problems += problems_of_file
    if alone and not more and len(configs) > 1:
        unclear = several(configs, configs[1].place("Model"))
        configs = [config for config in configs if config.config.Model.id == name]
        if not configs:
            raise EddiError(unclear)
    path = named_model_path(configs[0]) if alone else None
    return source if path is None else read_source(path), configs, problems


def only(survey: Mapping[str, Any], chosen: Sequence[Model]) -> dict[str, Any]:
    """Return a survey with no more than the chosen models; the facts of the file stay."""
    return {**survey, "models": [model for model in survey["models"] if is_one_of(model, chosen)]}


def is_one_of(shown: Mapping[str, Any], models: Sequence[Model]) -> bool:
    """Is this model of a survey among ``models``?

    In XML its place shows this: a fault tree becomes a model for each of its top events.
    """
    path: str | None = shown["path"]
    if path is None:
        return (shown["kind"], shown["name"]) in {(model.kind, model.name) for model in models}
    inside = path.rstrip("/") + "/"
    places = [model.place.path or "" for model in models]
    return any(place == path or place.startswith(inside) for place in places)


def files_of(folder: Path) -> tuple[list[Path], list[Path]]:
    """Return the files of a folder that can be checked (F003 for none), and its other ones."""
    ours: list[Path] = []
    others: list[Path] = []
    for path in sorted(folder.iterdir()):
        if path.is_file() and not path.name.startswith("."):
            (ours if _is_ours(path) else others).append(path)
    if not ours:
        raise EddiError(problem("F003.folder", Place(str(folder))))
    return ours, others


def _is_ours(path: Path) -> bool:
    """Return whether a file can be checked: it is of ours, or too damaged to tell."""
    try:
        source = read_source(path)
    except EddiError:
        return False
    if named_like_mros(source.name) or any(kind.recognises(source) for kind in kinds().values()):
        return True
    if is_xml(source):
        document, problems = read_document(source)
        if document is None:
            return all(each.case != "F003.other" for each in problems)
        return foreign(document) is None
    if source.name.lower().endswith(YAML_SUFFIXES):
        return is_config(source) or is_fleet(source) or read_map(source, "K001")[0] is None
    return False

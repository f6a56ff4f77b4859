"""Which model: of those in a file by its name, and of those that are given for a configuration."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.model_path import named_model, named_model_path
from eddi_scaffold.identifiers import package_name
from eddi_scaffold.kinds import Kind, Model, Reading, kinds
from eddi_scaffold.problems import EddiError, Place, Problem, did_you_mean, error, listed


def select(
    models: Sequence[Model], name: str | None, kind: Kind[Model] | None = None
) -> Sequence[Model]:
    """Select the models called ``name`` (compared without case) and of ``kind``.

    Raises:
        EddiError: none is left (F005).
    """
    left = [model for model in models if kind is None or model.kind == kind.name]
    if name is not None:
        exact = [model for model in left if model.name == name]
        left = exact or [model for model in left if model.name.casefold() == name.casefold()]
    if not left:
        names = [model.name for model in models]
        wanted = f"no model {name!r}" if name is not None else "no such model"
        hint = (did_you_mean(name, names) if name else None) or (
            f"there are: {', '.join(names) or 'none that a monitor can be made of'}"
        )
        place = Place(models[0].source.name) if models else Place()
        raise EddiError(error("F005", f"there is {wanted} in this file", place, hint))
    return left


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
        found = found if len(found) == 1 else []  # an EDDI may hold several
    if not found and len(fitting) == 1 and len(models) == 1:
        found = (
            fitting  # one model, one configuration: the id of the configuration names the package
        )
    if not found:
        message = f"there is no {section.type} called {section.id!r}"
        hint = f"there are: {', '.join(model.name for model in fitting) or 'none'}"
        place = config.place("Model", "id")
        if models and not fitting:
            hint, place = _of_other_type(models), config.place("Model", "type")
        raise EddiError(error("K026", message, place, hint))
    return found[0]


def _of_other_type(models: Sequence[Model]) -> str:
    """Return the hint for a configuration with another type than that of each model."""
    known = kinds()
    found = [f"the {known[one.kind].config_types[0]} {one.name!r}" for one in models]
    return f"{models[0].source.file_name} holds {listed(found)}: is `type` right?"


def _kinds_of(config: ConfigFile) -> Sequence[Kind[Model]]:
    """Return the kinds that the ``Model: type:`` of a configuration can mean."""
    wanted = config.config.Model.type.casefold()
    return [
        kind
        for kind in kinds().values()
        if wanted in {name.casefold() for name in kind.config_types}
    ]


def candidates(
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
    message = "the configuration does not name its model"
    return error("G015", message, config.place("Model"), hint)

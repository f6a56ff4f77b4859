"""Which model a configuration is of, and what it says of another one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from eddi_scaffold.config.block import ConfigText
from eddi_scaffold.connect.reading import model_id, text_of
from eddi_scaffold.identifiers import package_name
from eddi_scaffold.kinds import TODO, Model, kinds
from eddi_scaffold.monitors.choosing import select
from eddi_scaffold.monitors.loading import is_config
from eddi_scaffold.positioned_yaml.nodes import Map, items_of
from eddi_scaffold.problems import EddiError, Problem, error, listed, nearest, warning
from eddi_scaffold.source import Source


def chosen_model(models: Sequence[Model], name: str | None, root: Map) -> Model:
    """Return the model: by its name, else the one that the configuration is of, else the only one.

    Raises:
        EddiError: there is none of that name (F005), or several (G005).
    """
    id_ = model_id(root)
    if name is not None:
        models = select(models, name)
    elif id_ is not None:
        models = [one for one in models if package_name(one.name) == package_name(id_)] or models
    if len(models) > 1:
        names = ", ".join(one.name for one in models)
        message = f"the file contains several models: {names}"
        raise EddiError(error("G005", message, hint="choose one with --name"))
    return models[0]


def refuse_other(document: ConfigText, root: Map, chosen: Model, models: Sequence[Model]) -> None:
    """Refuse a file to which the draft of a model must not be added.

    Raises:
        EddiError: it is no configuration (K001), or that of another kind (K010) or model (K026).
    """
    if root.entries and not is_config(Source(document.name, document.text.encode())):
        message = "this is not an eddi_config.yml, so nothing is added to it"
        raise EddiError(error("K001", message, root.place, "choose another file for -o"))
    section = root.get("Model") or root
    kind, type_, id_ = kinds()[chosen.kind], text_of(section, "type"), model_id(root)
    if type_ not in (None, TODO) and str(type_).casefold() not in map(
        str.casefold, kind.config_types
    ):
        message = f"the model is a {kind.title}, the configuration declares {type_!r}"
        raise EddiError(error("K010", message, section.place))
    owner = package_name(id_) if id_ is not None else None
    if owner != package_name(chosen.name) and owner in {package_name(one.name) for one in models}:
        message = f"the configuration is that of {id_!r}, not of {chosen.name!r}"
        raise EddiError(error("K026", message, section.place, "choose another file for -o"))


def unknown_inputs(root: Map, ids: Sequence[str]) -> Iterable[Problem]:
    """Warn of entries that the model has no input for (K061)."""
    entries = root.get("EDDIInputs")
    there = [(one, text_of(one, "id")) for one in items_of(entries)]
    new = sorted({*ids} - {id_ for _, id_ in there})
    for one, id_ in there:
        if id_ is None or id_ in ids:
            continue
        near = nearest(id_, new)
        hint = (
            f"where it is {near!r} now, write `id: {near}` and `renamed_from: {id_}`"
            if near is not None
            else f"its inputs: {listed(ids)}"
        )
        message = f"the model has no input {id_!r}; its entry stays"
        yield warning("K061", message, one.place, hint)

"""Pictures of models that a person names, to draw what monitors of them say."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from eddi_scaffold.config.fleet.reading import is_fleet
from eddi_scaffold.deployments.fleet.sites import sites_of
from eddi_scaffold.diagrams import Diagram
from eddi_scaffold.kinds import Model, kinds
from eddi_scaffold.monitors.loading import checked_models, is_config
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.source import read_source

Pictures = Mapping[tuple[str, str], Diagram]
"""Title of the kind, name of the model -> its picture."""


def pictures_of(paths: Iterable[Path]) -> Pictures:
    """Return the pictures of the models in some files.

    Args:
        paths: models, configurations that name theirs, or deployment files.

    Raises:
        EddiError: a file cannot be read, or has errors.
    """
    found = {}
    for model in (model for path in paths for model in _models(path)):
        kind = kinds()[model.kind]
        if kind.functions.diagram is not None:
            found[kind.title, model.name] = kind.functions.diagram(model)
    return found


def _models(path: Path) -> Sequence[Model]:
    source = read_source(path)
    if is_fleet(source):
        sites, _ = sites_of(source, checked_models)
        return [one.model for site in sites for one in site.monitors]
    if is_config(source):
        monitors, _ = monitors_of(None, [path])
        return [one.model for one in monitors]
    return checked_models(path, ()).models

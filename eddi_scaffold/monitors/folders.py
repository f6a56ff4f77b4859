"""Which files of a folder are meant for us: models, configurations and models of a robot."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from eddi_scaffold.config.fleet.reading import is_fleet
from eddi_scaffold.config.reading import read_config
from eddi_scaffold.kinds import kinds
from eddi_scaffold.monitors.loading import YAML_SUFFIXES, is_config, is_mros
from eddi_scaffold.positioned_yaml.nodes import read_map
from eddi_scaffold.problems import EddiError, Place, error
from eddi_scaffold.readers.eddi import read_document
from eddi_scaffold.readers.eddi import sniff as is_xml
from eddi_scaffold.readers.unread import foreign
from eddi_scaffold.source import Source, read_source


def files_of(folder: Path) -> tuple[list[Path], list[Path]]:
    """Return the files of a folder that can be checked, and its other ones; not those below it.

    Raises:
        EddiError: there is none that can be checked (F003).
    """
    ours: list[Path] = []
    others: list[Path] = []
    for path in sorted(folder.iterdir()):
        if path.is_file() and not path.name.startswith("."):
            (ours if _is_ours(path) else others).append(path)
    if not ours:
        message = "no file in this folder is a model, a configuration or a model of a robot"
        raise EddiError(error("F003", message, Place(str(folder))))
    return ours, others


def inputs_beside(configs: Sequence[Path]) -> dict[str, str]:
    """Return the inputs of other configurations in the folders of some: id -> how to run both."""
    found: dict[str, str] = {}
    for folder in dict.fromkeys(one.parent for one in configs):
        for path in sorted(folder.iterdir()):
            if path in configs or path.suffix.lower() not in YAML_SUFFIXES or not path.is_file():
                continue
            try:
                config, _ = read_config(read_source(path))
            except EddiError:
                continue
            if config is None:
                continue
            advice = f"it is an input of {config.config.Model.id}: run both, with -c {path}"
            found |= {one.id: advice for one in config.config.EDDIInputs if one.id not in found}
    return found


def _is_ours(path: Path) -> bool:
    try:
        source = read_source(path)
    except EddiError:
        return False
    return (
        is_mros(source) or any(kind.sniff(source) for kind in kinds().values()) or _may_be(source)
    )


def _may_be(source: Source) -> bool:
    """Return whether a file is an EDDI, a configuration or a deployment, or too damaged to tell."""
    if is_xml(source):
        document, _ = read_document(source)
        return document is None or foreign(document) is None
    if source.name.lower().endswith(YAML_SUFFIXES):
        return is_config(source) or is_fleet(source) or read_map(source, "K001")[0] is None
    return False

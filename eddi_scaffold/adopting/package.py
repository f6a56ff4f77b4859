"""The files of an old package: what each is, and what is left aside."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from eddi_scaffold.adopting.modules import ParsedModule, read_module
from eddi_scaffold.identifiers import is_package_name, package_name
from eddi_scaffold.problems import EddiError, Place, error
from eddi_scaffold.source import read_source

_MODELS = (".xdsl", ".xmlbif", ".yml", ".yaml", ".xml")
_RECORDS = ".eddi"
_EDITED = ("EDDIInput.py", "bayesian_network_config.py")
_MANIFEST = "package.xml"
_NAME = re.compile(rb"<name>\s*([A-Za-z0-9_-]+)\s*</name>")


@dataclass(frozen=True)
class OldPackage:
    """An old package.

    Attributes:
        name: of the ROS package, ``None`` of one that is none.
        eddi_input: ``EDDIInput.py``.
        config: ``bayesian_network_config.py``.
        node: the ROS node's script.
        monitor: ``EDDIMonitor.py``.
        models: files that may hold the model, the best one first.
        files: every file, relative to the folder.
    """

    folder: Path
    name: str | None
    eddi_input: ParsedModule | None
    config: ParsedModule | None
    node: ParsedModule | None
    monitor: ParsedModule | None
    models: tuple[Path, ...]
    files: tuple[Path, ...]


def read_old_package(folder: Path) -> OldPackage:
    """Find out what a folder holds.

    Raises:
        EddiError: it is not a folder (F001), holds nothing of an old package, is one of ours or is
            a folder above packages (A002), holds one of its modules twice (A003), or a module is
            not Python (A001) or has damaged markers (H010).
    """
    if not folder.is_dir():
        raise EddiError(
            error("F001", "cannot read the package: no such folder", Place(str(folder)))
        )
    if (folder / _RECORDS).is_dir():
        message = "this is a package of eddi-scaffold already"
        hint = "`eddi-scaffold upgrade` brings it up to date"
        raise EddiError(error("A002", message, Place(str(folder)), hint))
    files = tuple(_files(folder))
    _check_is_one_package(folder, files)
    eddi_input = _only(folder, files, "EDDIInput.py")
    config = _only(folder, files, "bayesian_network_config.py")
    if eddi_input is None and config is None:
        message = "there is neither an EDDIInput.py nor a bayesian_network_config.py below it"
        hint = "name the folder that the old generator wrote"
        raise EddiError(error("A002", message, Place(str(folder)), hint))
    near = config.path.parent if config is not None else folder
    models = [
        folder / file for file in files if file.suffix.lower() in _MODELS and file.name != _MANIFEST
    ]
    models.sort(key=lambda path: (_MODELS.index(path.suffix.lower()), path.parent != near, path))
    node = _only(folder, files, "RosNode.py")
    monitor = _only(folder, files, "EDDIMonitor.py")
    name = _package_name(folder)
    return OldPackage(folder, name, eddi_input, config, node, monitor, tuple(models), files)


def _check_is_one_package(folder: Path, files: Sequence[Path]) -> None:
    """Refuse a folder above packages: what else is in it is nothing that adopting makes unneeded.

    Raises:
        EddiError: one below it is a package, of ours or of the old tools (A002).
    """
    ours = next((one for one in files if _RECORDS in one.parts), None)
    if ours is not None:
        inner = folder / Path(*ours.parts[: ours.parts.index(_RECORDS)])
        message = f"{inner} in it is a package of eddi-scaffold already"
        hint = "name the folder of one package that the old generator wrote"
        raise EddiError(error("A002", message, Place(str(folder)), hint))
    edited = {file.parent for file in files if file.name in _EDITED}
    above = {file.parent for file in files if file.name == _MANIFEST}
    if Path() in above:
        return
    inner_packages = sorted(one for one in above for file in edited if file.is_relative_to(one))
    if inner_packages:
        message = "this is no package, but there is one below it"
        hint = f"name its folder: `eddi-scaffold adopt {folder / inner_packages[0]}`"
        raise EddiError(error("A002", message, Place(str(folder)), hint))


def _package_name(folder: Path) -> str | None:
    """Return the name that launch files and other packages know the package by."""
    manifest = folder / _MANIFEST
    found = _NAME.search(read_source(manifest).data) if manifest.is_file() else None
    name = package_name(found[1].decode("ascii")) if found else ""
    return name if is_package_name(name) else None


def _files(folder: Path) -> Sequence[Path]:
    skipped = {".git", "__pycache__"}
    found = []
    for root, folders, names in os.walk(folder):
        folders[:] = sorted(name for name in folders if name not in skipped)
        found += [Path(root, name).relative_to(folder) for name in sorted(names)]
    return found


def _only(folder: Path, files: Sequence[Path], name: str) -> ParsedModule | None:
    found = [file for file in files if file.name == name]
    if len(found) > 1:
        listed = ", ".join(map(str, found))
        message = f"there are several {name}: {listed}"
        hint = "adopt one network at a time: name the folder of one"
        raise EddiError(error("A003", message, Place(str(folder)), hint))
    return read_module(folder / found[0]) if found else None

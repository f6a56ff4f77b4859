"""The new package of an adoption, its configuration and its model, written as one step."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.identifiers import package_name
from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.packages.adopting.adopt import Adoption, leftover
from eddi_scaffold.packages.assembly import assemble, monitors_of
from eddi_scaffold.packages.generation import WriteResult, write_packages
from eddi_scaffold.packages.rendering import Template
from eddi_scaffold.packages.transaction import FileState, write
from eddi_scaffold.packages.workspace import packages_root
from eddi_scaffold.platforms import PackageAnswers, Platform


@dataclass(frozen=True)
class Result:
    """What an adoption wrote, or would write."""

    outcome: WriteResult
    problems: Sequence[Problem]
    notes: Sequence[str]


def write_adopted(
    adoption: Adoption, platform: Platform, place: Path, template: Template, *, dry_run: bool
) -> Result:
    """Generate the new package with the old bodies in its regions.

    Raises:
        EddiError: the new package, or another file in the place of its model or configuration, is
            there already (G003), the place is in the old package (G006), or it cannot be
            generated.
    """
    if place.resolve().is_relative_to(adoption.old.folder.resolve()):
        raise EddiError(problem("G006.old_package", Place(str(place))))
    root = packages_root(platform, place)
    package = package_name(adoption.id)
    if os.path.lexists(root / package):
        raise EddiError(problem("G003.package_exists", Place(str(root / package))))
    config_name = f"{package}_config.yml"
    data = read_source(adoption.model_file).data
    files = {config_name: adoption.config().encode(), adoption.model_name: data}
    new = {name: FileState(data) for name, data in files.items() if _is_new(place / name, data)}
    with tempfile.TemporaryDirectory(prefix="eddi-scaffold-") as scratch:
        for name, data in files.items():
            Path(scratch, name).write_bytes(data)
        configs = [Path(scratch, config_name)]
        try:
            monitors, problems = monitors_of(None, configs)
            assembly = assemble(monitors, platform, root, problems)
        except EddiError as failed:
            raise EddiError(*(_shown(problem, place) for problem in failed.problems)) from None
    regions = set(_regions(one for one in assembly.packages if one.folder == package))
    packages = [
        _with_bodies(one, adoption) if one.folder == package else one for one in assembly.packages
    ]
    outcome = write_packages(root, packages, template, dry_run=dry_run)
    notes: list[str] = []
    if not dry_run:
        write(place, new)
        notes = _report(adoption, regions, [place / name for name in files])
    lost = any(body.region.id not in regions for body in adoption.bodies)
    look = outcome.attention or bool(adoption.rejects) or bool(adoption.wiring.lost) or lost
    shown = [_shown(problem, place) for problem in assembly.problems]
    return Result(replace(outcome, attention=look), shown, notes)


def _is_new(file: Path, data: bytes) -> bool:
    """Return whether a file is to be written: what is there is a person's, and stays."""
    if not os.path.lexists(file):
        return True
    if read_source(file).data != data:
        raise EddiError(problem("G003.file_exists", Place(str(file))))
    return False


def _with_bodies(one: PackageAnswers, adoption: Adoption) -> PackageAnswers:
    rejects = {f"{name}.adopted": text.encode() for name, text in adoption.rejects.items()}
    fitting = {*adoption.fitting, *(id_ for id_ in _ids(adoption) if id_.endswith(".module"))}
    bodies = [replace(body, fits=body.region.id in fitting) for body in adoption.bodies]
    return replace(one, saved=bodies, adopted=rejects)


def _ids(adoption: Adoption) -> Iterator[str]:
    return (body.region.id for body in adoption.bodies)


def _regions(packages: Iterable[PackageAnswers]) -> Iterator[str]:
    """Yield the regions of the modules of packages."""
    for package in packages:
        answers: Mapping[str, Any] = package.answers
        yield "EDDIInput.module"
        yield from (f"process_{input_['attribute']}" for input_ in answers["inputs"])
        for module in answers["modules"]:
            yield f"{module['name']}.module"
            yield from (method["name"] for method in module["methods"])


def _report(adoption: Adoption, regions: Container[str], written: Sequence[Path]) -> list[str]:
    lines = [f"written: {path}" for path in written]
    for id_ in _ids(adoption):
        place = "in its region" if id_ in regions else "kept in .eddi/kept: it has no region here"
        lines.append(f"{id_}: the body is {place}")
    needed = "are not needed any more, and"
    if adoption.wiring.lost:
        needed = "are needed until you have written what was not recovered; they"
    lines.append(f"the old files {needed} were left as they are:")
    lines += [f"  {file}" for file in leftover(adoption.old, [adoption.model_file])]
    return lines


def _shown(problem: Problem, folder: Path) -> Problem:
    """Name a file by its final path, not by that of the trial."""
    where = problem.place
    if not where.file:
        return problem
    return replace(problem, place=replace(where, file=str(folder / Path(where.file).name)))

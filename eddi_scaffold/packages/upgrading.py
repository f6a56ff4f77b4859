"""Which packages ``upgrade`` and ``status`` concern, and what they should be."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from eddi_scaffold import __version__
from eddi_scaffold.common.escaping import markdown_code
from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.identifiers import package_name
from eddi_scaffold.common.problems import EddiError, Place, Problem, has_errors, problem
from eddi_scaffold.config.file import ConfigFile, named_model_path
from eddi_scaffold.config.reading import RobotAdditions, read_configs
from eddi_scaffold.deployments.joining import unanswered
from eddi_scaffold.deployments.support import facts_of_package
from eddi_scaffold.kinds import Model, kinds
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.loading import checked_models, read_models
from eddi_scaffold.packages.assembly import (
    rejoined,
    stored,
    support,
    wiring_with,
    with_choices,
)
from eddi_scaffold.packages.handwritten import without_written_inputs
from eddi_scaffold.packages.rendering import ANSWERS_FILE, read_answers
from eddi_scaffold.packages.workspace import check_answers, existing, linked, model_id, root_below
from eddi_scaffold.platforms import PackageAnswers, Platform, owner_of, platforms


@dataclass(frozen=True)
class PackageGroup:
    """Generated packages in one folder.

    Attributes:
        root: the folder.
        present: package folder -> answers.
        links: links to packages, which are left alone.
        robot: name of that workspace, where it is one of several robots; else empty.
    """

    root: Path
    present: dict[str, dict[str, Any]]
    links: tuple[Path, ...] = ()
    robot: str = ""

    def shown(self, folder: str) -> str:
        """Return the name of a package for people."""
        return f"{self.robot}/{folder}" if self.robot else folder


def groups(workspace: Path | None, packages: Sequence[Path]) -> list[PackageGroup]:
    """Find generated packages: of a workspace, of those of all robots, or the ones that are named.

    A package in place of a workspace is that package, so that these commands work in its folder.

    Raises:
        EddiError: there are none (U001), or the answers of one are damaged (T005).
    """
    named = _named(workspace, packages)
    if named:
        return [
            _group(root, [path for path in named if path.parent == root])
            for root in roots(workspace, packages)
        ]
    place = workspace or Path()
    found = [
        PackageGroup(root, existing(root), linked(root), "" if one is place else one.name)
        for one in _workspaces(place)
        for root in _roots(one)
    ]
    found = [group for group in found if group.present or group.links]
    if not found:
        above = _workspace_above(place)
        hint = "name a workspace with -w, or the folder of a package"
        if above is not None:
            hint = f"name the workspace above: -w {above}"
        raise EddiError(problem("U001.nothing_near", Place(str(place)), hint=hint))
    return found


def roots(workspace: Path | None, packages: Sequence[Path]) -> list[Path]:
    """Return the folders in which ``groups`` looks; they need not be there.

    Raises:
        EddiError: one leads out of the workspace (F009).
    """
    named = _named(workspace, packages)
    if named:
        return list(dict.fromkeys(path.parent for path in named))
    return [root for place in _workspaces(workspace or Path()) for root in _roots(place)]


def _roots(workspace: Path) -> list[Path]:
    return list(
        dict.fromkeys(root_below(workspace, platform.root) for platform in platforms().values())
    )


def _workspaces(place: Path) -> list[Path]:
    """Return the workspaces that ``generate`` of a deployment file has made, else the place itself.

    Where no package names the robot after which its workspace is called, it is another folder, and
    what lies in it is nobody's business.
    """
    if any(any(root.glob(f"*/{ANSWERS_FILE}")) for root in _roots(place)):
        return [place]
    inside = sorted(place.iterdir()) if place.is_dir() else []
    robots = [one for one in inside if one.is_dir() and not one.is_symlink()]
    return robots if any(map(_is_robot, robots)) else [place]


def _is_robot(workspace: Path) -> bool:
    try:
        packages = [one for root in _roots(workspace) for one in existing(root).items()]
    except EddiError:  # told where it is one of several robots
        return False
    monitors = (facts_of_package(name, answers) for name, answers in packages)
    fleets = (monitor.config.config.Fleet for monitor in monitors if monitor is not None)
    return any(fleet is not None and fleet.robot == workspace.name for fleet in fleets)


def _named(workspace: Path | None, packages: Sequence[Path]) -> list[Path]:
    place = workspace or Path()
    if not packages and (place / ANSWERS_FILE).is_file():
        packages = [place]
    return [path if path.name not in {"", ".."} else path.resolve() for path in packages]


def _workspace_above(place: Path) -> Path | None:
    """Return the nearest folder above that has packages where workspaces have them."""
    roots = {platform.root for platform in platforms().values() if platform.workspace is not None}
    for above in place.resolve().parents:
        if any(any((above / root).glob(f"*/{ANSWERS_FILE}")) for root in roots):
            return Path(os.path.relpath(above))
    return None


def _group(root: Path, packages: Sequence[Path]) -> PackageGroup:
    present = {path.name: _answers(path) for path in packages if not path.is_symlink()}
    return PackageGroup(root, present, tuple(path for path in packages if path.is_symlink()))


def refuse_for_several(
    found: Sequence[PackageGroup], model: Path | None, configs: Sequence[Path]
) -> None:
    """Refuse a newer model or configuration for several robots: others rely on its digest.

    Raises:
        EddiError: that is so (U009).
    """
    if found[0].robot and (model is not None or configs):
        names = ", ".join(dict.fromkeys(one.robot for one in found))
        place = Place(str(model if model is not None else configs[0]))
        raise EddiError(problem("U009", place, names=names))


def targets(
    group: PackageGroup,
    model_file: Path | None,
    config_files: Sequence[Path],
    robot: RobotAdditions | None = None,
) -> tuple[list[PackageAnswers], list[Problem]]:
    """Return what the packages of a group should be, with the problems of newer inputs.

    Args:
        group: the packages.
        model_file: newer model.
        config_files: newer configurations.
        robot: what models of a robot add to these.

    Raises:
        EddiError: an input cannot be used, a new configuration comes without a model and names none
            (G015) or belongs to no package (U005).
    """
    given, _ = read_configs(config_files, robot)
    configs = {package_name(one.config.Model.id): one for one in given}
    for name in sorted(configs.keys() - group.present.keys()):
        raise EddiError(problem("U005.no_package", configs[name].place("Model", "id"), name=name))
    models: dict[str, Model] = {}
    problems: list[Problem] = []
    for path in [model_file] if model_file is not None else _named_models(given):
        newer, found = _newer_models(group, path, configs)
        models |= newer
        problems += found
    renewed = rejoined(group.present, models, configs)
    packages: list[PackageAnswers] = []
    monitors: dict[str, Platform] = {}
    joined: list[BoundMonitor] = []
    for folder, answers in group.present.items():
        if "facts_json" not in answers:
            continue
        platform = monitors[folder] = owner_of(str(answers["template"]))
        if folder not in renewed:
            packages.append(stored(group.root / folder, answers))
            continue
        monitor, found = renewed[folder]
        joined.append(monitor)
        package, more = platform.monitor(monitor)
        packages.append(with_choices(package, [answers]))
        problems += [*found, *more]
    problems += wiring_with(joined, group.present)
    shared = {folder for folder in group.present if folder not in monitors}
    templates = (str(group.present[folder]["template"]) for folder in sorted(shared))
    for platform in dict.fromkeys(map(owner_of, templates)):
        own = {p.folder: p.answers for p in packages if monitors.get(p.folder) is platform}
        present = existing(group.root, own)
        made = support(platform, group.root, present, own)
        packages += [package for package in made if package.folder in shared]
    problems = unanswered(problems, [one.model for one in joined if one.config is not None])
    if has_errors(problems):
        raise EddiError(*problems)
    return packages, without_written_inputs(problems, lambda package: [group.root / package])


def compiled_before(packages: Iterable[PackageAnswers]) -> list[str]:
    """Return what is to be said of monitors that another release compiled, without their models."""
    versions = {
        package.folder: package.answers["generator_version"]
        for package in packages
        if "compiled" in package.answers
    }
    return [
        f"{folder}: compiled.py stays as eddi-scaffold {version} made it; name the model with -m"
        for folder, version in versions.items()
        if version != __version__
    ]


def _named_models(configs: Iterable[ConfigFile]) -> list[Path]:
    """Return the model files that configurations name, each once.

    Raises:
        EddiError: one names none (G015).
    """
    found: dict[Path, None] = {}
    for config in configs:
        path = named_model_path(config)
        if path is None:
            raise EddiError(problem("G015.no_model", Place(config.name)))
        found[path] = None
    return list(found)


def _newer_models(
    group: PackageGroup, model_file: Path, configs: Iterable[str]
) -> tuple[dict[str, Model], list[Problem]]:
    """Return the newer model of each package that has one in the file, read with its marks."""
    source = read_source(model_file)
    made_of = {f: (a["kind"], model_id(a)) for f, a in group.present.items() if "facts_json" in a}
    first = read_models(source)
    names = {(model.kind, model.name) for model in first.models}
    folders = [folder for folder, made in made_of.items() if made in names]
    unnamed = _made_of_unnamed(group, first.models, source.file_name, configs)
    made_of.update(unnamed)
    folders += [folder for folder in unnamed if folder not in folders]
    if not folders:
        if has_errors(first.problems):
            raise EddiError(*first.problems)
        known = ", ".join(sorted({name for _, name in made_of.values()})) or "none"
        here = ", ".join(sorted(name for _, name in names)) or "none"
        raise EddiError(problem("U005.of_other_models", Place(source.name), here=here, known=known))
    marks = {m: None for f in folders for m in group.present[f].get("default_guarantees") or ()}
    reading = checked_models(model_file, tuple(marks))
    found = {(model.kind, model.name): model for model in reading.models}
    problems = list(reading.problems)
    for folder, made in made_of.items():
        if folder not in folders and group.present[folder]["model_file"] == markdown_code(
            source.file_name
        ):
            problems.append(problem("U007", Place(source.name), model=made[1], folder=folder))
    return {folder: found[made_of[folder]] for folder in folders}, problems


def _made_of_unnamed(
    group: PackageGroup, models: Sequence[Model], file: str, configs: Iterable[str]
) -> dict[str, tuple[str, str]]:
    """Return the packages that were made of a file whose model has no name: by the file's name.

    Raises:
        EddiError: several were, and no configuration selects one (U005).
    """
    named = {model.kind: model.name for model in models if kinds()[model.kind].named_by_config}
    found = {
        folder: (answers["kind"], named[answers["kind"]])
        for folder, answers in group.present.items()
        if answers.get("kind") in named and answers.get("model_file") == markdown_code(file)
    }
    chosen = {folder: made for folder, made in found.items() if folder in set(configs)} or found
    if len(chosen) > 1:
        raise EddiError(
            problem(
                "U005.several", Place(models[0].source.name), file=file, packages=", ".join(chosen)
            )
        )
    return chosen


def _answers(package: Path) -> dict[str, Any]:
    answers = read_answers(package)
    if answers is None:
        raise EddiError(problem("U001.not_a_package", Place(str(package))))
    check_answers(package, answers)
    return answers

"""Which packages ``upgrade`` and ``status`` concern, what they should be, and how far they are."""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from eddi_scaffold import __version__
from eddi_scaffold.common.escaping import markdown_code
from eddi_scaffold.common.files import next_to, read_source
from eddi_scaffold.common.identifiers import package_name
from eddi_scaffold.common.problems import EddiError, Place, Problem, has_errors, problem
from eddi_scaffold.config.file import ConfigFile, from_data, named_model_path
from eddi_scaffold.deployments.joining import unanswered
from eddi_scaffold.deployments.support import facts_of_package
from eddi_scaffold.kinds import Model, kinds
from eddi_scaffold.monitors.binding import BoundMonitor, monitor_of
from eddi_scaffold.monitors.compiling import MonitorFacts
from eddi_scaffold.monitors.compiling import from_json as facts_of
from eddi_scaffold.monitors.config_reading import RobotAdditions, read_configs, with_types
from eddi_scaffold.monitors.loading import checked_models, complete_reading, read_models
from eddi_scaffold.packages.assembly import (
    cross_checked,
    stored,
    support,
    wiring_with,
    with_choices,
)
from eddi_scaffold.packages.generation import write_packages
from eddi_scaffold.packages.handwritten import without_written_inputs
from eddi_scaffold.packages.rendering import ANSWERS_FILE, Template, read_answers
from eddi_scaffold.packages.workspace import (
    check_answers,
    existing,
    model_id,
    root_below,
)
from eddi_scaffold.platforms import PackageAnswers, Platform, owner_of, platforms
from eddi_scaffold.regions.check import list_regions

Rejoined = tuple[BoundMonitor, list[Problem]]  # a monitor, and what is wrong with it


@dataclass(frozen=True)
class PackageGroup:
    """Generated packages in one folder."""

    root: Path  # the folder
    present: dict[str, dict[str, Any]]  # package folder -> answers
    robot: str = ""  # name of that workspace, where it is one of several robots; else empty


def groups(workspace: Path | None, packages: Sequence[Path]) -> list[PackageGroup]:
    """Find generated packages: of a workspace, of those of all robots, or the ones that are named.

    A package in place of a workspace is that package, so that these commands work in its folder.

    Raises:
        EddiError: there are none (U001), or the answers of one are damaged (T005).
    """
    if named := _named(workspace, packages):
        by_root = {root: [p for p in named if p.parent == root] for root in roots(None, named)}
        return [_group(root, paths) for root, paths in by_root.items()]
    place = workspace or Path()
    candidates = [
        PackageGroup(root, existing(root), "" if robot is place else robot.name)
        for robot in _workspaces(place)
        for root in _roots(robot)
    ]
    groups_there = [group for group in candidates if group.present]
    if groups_there:
        return groups_there
    raise EddiError(problem("U001.nothing_here", Place(str(place))))


def roots(workspace: Path | None, packages: Sequence[Path]) -> list[Path]:
    """Return the folders in which ``groups`` looks; they need not be there."""
    if named := _named(workspace, packages):
        return list(dict.fromkeys(path.parent for path in named))
    return [root for place in _workspaces(workspace or Path()) for root in _roots(place)]


def _named(workspace: Path | None, packages: Sequence[Path]) -> list[Path]:
    place = workspace or Path()
    if not packages and (place / ANSWERS_FILE).is_file():
        packages = [place]
    return [path if path.name not in {"", ".."} else path.resolve() for path in packages]


def _roots(workspace: Path) -> list[Path]:
    places = (root_below(workspace, platform.root) for platform in platforms().values())
    return list(dict.fromkeys(places))


def _workspaces(place: Path) -> list[Path]:
    """Return the workspaces that ``generate`` of a deployment file has made, else the place itself.

    Where no package names the robot after which its workspace is called, it is another folder, and
    what lies in it is nobody's business.
    """
    if any(any(root.glob(f"*/{ANSWERS_FILE}")) for root in _roots(place)):
        return [place]
    inside = sorted(place.iterdir()) if place.is_dir() else []
    robots = [folder for folder in inside if folder.is_dir() and not folder.is_symlink()]
    return robots if any(map(_is_robot, robots)) else [place]


def _is_robot(workspace: Path) -> bool:
    try:
        packages = [package for root in _roots(workspace) for package in existing(root).items()]
    except EddiError:  # told where it is one of several robots
        return False
    monitors = (facts_of_package(name, answers) for name, answers in packages)
    fleets = (monitor.config.config.Fleet for monitor in monitors if monitor is not None)
    return any(fleet is not None and fleet.robot == workspace.name for fleet in fleets)


def _group(root: Path, packages: Sequence[Path]) -> PackageGroup:
    present = {}
    for path in packages:
        answers = read_answers(path)
        if answers is None:
            raise EddiError(problem("U001.not_a_package", Place(str(path))))
        check_answers(path, answers)
        present[path.name] = answers
    return PackageGroup(root, present)


def refuse_for_several(
    chosen: Sequence[PackageGroup], model: Path | None, configs: Sequence[Path]
) -> None:
    """Refuse (U009) a newer input for several robots: others rely on its digest."""
    if chosen[0].robot and (model is not None or configs):
        names = ", ".join(dict.fromkeys(group.robot for group in chosen))
        place = Place(str(model if model is not None else configs[0]))
        raise EddiError(problem("U009", place, names=names))


def targets(
    group: PackageGroup,
    model_file: Path | None,
    config_files: Sequence[Path],
    robot: RobotAdditions | None = None,
) -> tuple[list[PackageAnswers], list[Problem]]:
    """Return what the packages of a group should be, with the problems of newer inputs.

    Models of a robot may add to newer configurations.

    Raises:
        EddiError: an input cannot be used, a new configuration comes without a model and names none
            (G015) or belongs to no package (U005).
    """
    read, _ = read_configs(config_files, robot)
    configs = {package_name(config.config.Model.id): config for config in read}
    for name in sorted(configs.keys() - group.present.keys()):
        raise EddiError(problem("U005.no_package", configs[name].place("Model", "id"), name=name))
    models: dict[str, Model] = {}
    problems: list[Problem] = []
    paths = {} if model_file is not None else {f: named_model_path(c) for f, c in configs.items()}
    for path in dict.fromkeys(filter(None, [model_file, *paths.values()])):
        newer, model_problems = _newer_models(group, path, configs)
        models |= newer
        problems += model_problems
    remade: dict[str, Rejoined] = {}
    present: dict[str, PackageAnswers] = {}
    for folder, answers in group.present.items():
        if "facts" not in answers or folder in models:
            continue
        present[folder] = kept = stored(group.root / folder, answers)
        is_old = answers["generator_version"] != __version__ or kept.lacks
        if paths[folder] is None if folder in paths else is_old:
            made_anew = monitor_of_text(group.root / folder, answers)
            remade |= {folder: made_anew} if made_anew is not None else {}
    for folder, config in configs.items():
        if folder in remade:
            models[folder] = remade[folder][0].unconfigured
        elif folder not in models and paths.get(folder, model_file) is None:
            raise EddiError(problem("G015.no_model", Place(config.name)))
    renewed = remade | {
        folder: rejoined(folder, answers, models[folder], configs.get(folder))
        for folder, answers in group.present.items()
        if folder in models
    }
    packages: list[PackageAnswers] = []
    monitors: dict[str, Platform] = {}
    for folder, answers in group.present.items():
        if "facts" not in answers:
            continue
        platform = monitors[folder] = owner_of(str(answers["template"]))
        if folder not in renewed:
            packages.append(present[folder])
            continue
        monitor, binding_problems = renewed[folder]
        if folder in remade:
            monitor = _with_origin(monitor, facts_of(answers["facts"]))
        monitor = cross_checked(monitor, problems)
        package, package_problems = platform.monitor(monitor)
        packages.append(with_choices(package, [answers]))
        problems += [*binding_problems, *package_problems]
    joined = [monitor for monitor, _ in renewed.values()]
    problems += wiring_with(joined, group.present)
    shared = sorted(group.present.keys() - monitors.keys())
    templates = (str(group.present[folder]["template"]) for folder in shared)
    for platform in dict.fromkeys(map(owner_of, templates)):
        own = {p.folder: p.answers for p in packages if monitors.get(p.folder) is platform}
        made = support(platform, group.root, existing(group.root, own), own)
        packages += [package for package in made if package.folder in shared]
    problems = unanswered(problems, [new.model for new in joined if new.config is not None])
    if has_errors(problems):
        raise EddiError(*problems)
    return packages, without_written_inputs(problems, lambda package: [group.root / package])


def rejoined(
    folder: str, answers: Mapping[str, Any], model: Model, config: ConfigFile | None = None
) -> Rejoined:
    """Join a newer model with the configuration that its package remembers, or with a newer one.

    A model that no longer fits is an EddiError.
    """
    newer = config
    if text := answers.get("config"):
        old = from_data(text, f"the configuration that {folder} remembers")
        # types that came from models of the robot stay known without these
        newer = old if config is None else with_types(config, old.config.MessageTypes)
    marks = answers.get("default_guarantees") or ()
    monitor, problems = monitor_of(model, newer, marks)
    if monitor is None:
        raise EddiError(*problems)
    if newer is None:
        monitor = replace(monitor, package=folder)  # whatever the file is called today
    return monitor, problems


def monitor_of_text(package: Path, answers: Mapping[str, Any]) -> Rejoined | None:
    """Return the monitor of a package, made anew of the model that is in it as text, and problems.

    Nothing where the text is gone, or is not what the package was made of: its digest tells.
    """
    facts = facts_of(answers["facts"])
    with suppress(EddiError):
        source = read_source(next_to(str(package / ANSWERS_FILE), answers.get("model_text", "")))
        reading = kinds()[facts.kind].model_class.read_file(source, ())
        model = complete_reading(source, reading).models[0].named(facts.id)
        monitor, problems = rejoined(package.name, answers, model)
        if monitor.facts.digest == facts.digest:
            return monitor, problems
    return None


def _with_origin(monitor: BoundMonitor, before: MonitorFacts) -> BoundMonitor:
    """Return a monitor that is made of the text in its package with the places of before."""
    known = {(element.element, element.id): element for element in before.elements}
    facts = replace(
        monitor.facts,
        file=before.file,
        file_sha256=before.file_sha256,
        path=before.path,
        links=before.links,
        elements=tuple(known.get((of.element, of.id), of) for of in monitor.facts.elements),
    )
    return replace(monitor, facts=facts)


def _newer_models(
    group: PackageGroup, model_file: Path, configs: Container[str]
) -> tuple[dict[str, Model], list[Problem]]:
    """Return the newer model of each package that has one in the file, read with its marks."""
    source = read_source(model_file)
    file_name = markdown_code(source.file_name)
    made_of = {f: (a["kind"], model_id(a)) for f, a in group.present.items() if "facts" in a}
    first = read_models(source)
    names = {(model.kind, model.name) for model in first.models}
    folders = [folder for folder, made in made_of.items() if made in names]
    # a model without a name is that of the package that was made of the file of its name
    unnamed = {
        model.kind: model.name for model in first.models if kinds()[model.kind].named_by_config
    }
    of_file = {
        folder: (kind, unnamed[kind])
        for folder, (kind, _) in made_of.items()
        if kind in unnamed and group.present[folder]["model_file"] == file_name
    }
    of_file = {folder: made for folder, made in of_file.items() if folder in configs} or of_file
    if len(of_file) > 1:
        names_ = ", ".join(of_file)
        place = Place(source.name)
        raise EddiError(problem("U005.several", place, file=source.file_name, packages=names_))
    made_of.update(of_file)
    folders += [folder for folder in of_file if folder not in folders]
    if not folders:
        if has_errors(first.problems):
            raise EddiError(*first.problems)
        known = ", ".join(sorted({name for _, name in made_of.values()})) or "none"
        here = ", ".join(sorted(name for _, name in names)) or "none"
        raise EddiError(problem("U005.of_other_models", Place(source.name), here=here, known=known))
    marks = {m: None for f in folders for m in group.present[f].get("default_guarantees") or ()}
    reading = checked_models(model_file, tuple(marks))
    models = {(model.kind, model.name): model for model in reading.models}
    gone = [
        problem("U007", Place(source.name), model=name, folder=folder)
        for folder, (_, name) in made_of.items()
        if folder not in folders and group.present[folder]["model_file"] == file_name
    ]
    return {folder: models[made_of[folder]] for folder in folders}, [*reading.problems, *gone]


@dataclass(frozen=True)
class PackageState:
    """How far a package is from what it would be if it were generated now."""

    package: str  # name of its folder, with that of its robot where there are several
    outdated: Sequence[str]  # files that a regeneration would change
    edited: Sequence[str]  # generated files that were edited outside regions
    regions: dict[str, int]  # state (`untouched`, `edited`, ...) -> how many regions
    review: Sequence[str]  # hand-written bodies that need a look

    @property
    def drifted(self) -> bool:
        """Return whether something should be done."""
        return bool(self.outdated or self.edited or self.review)

    def as_text(self) -> str:
        """Return a few lines for people."""
        counts = ", ".join(f"{count} {state}" for state, count in sorted(self.regions.items()))
        state = "differs" if self.drifted else "up to date"
        lines = [f"{self.package}: {state} (regions: {counts or 'none'})"]
        lines += [f"  would change: {path}" for path in self.outdated]
        lines += [f"  edited outside regions: {path}" for path in self.edited]
        lines += [f"  look at: {reason}" for reason in self.review]
        return "\n".join(lines)

    def as_json(self) -> dict[str, object]:
        """Return the JSON form of ``status --json``."""
        package, *more = asdict(self).items()
        return dict([package, ("drifted", self.drifted), *more])


def states_of(
    group: PackageGroup, model: Path | None, configs: Sequence[Path], template: Template
) -> list[PackageState]:
    """Compare the packages of a group with a dry run of their regeneration."""
    packages, _ = targets(group, model, configs)
    outcome = write_packages(group.root, packages, template, dry_run=True)
    changes = sorted(path for path in outcome.changes if "/.eddi/" not in path)
    states = []
    for folder in group.present:
        regions = [*list_regions(group.root / folder)]
        edited = [region.file for region in regions if region.state == "outside"]
        changed = [
            path.removeprefix(f"{folder}/") for path in changes if path.startswith(f"{folder}/")
        ]
        outdated = [path for path in changed if path not in {*edited, ANSWERS_FILE}]
        counts = Counter(region.state for region in regions if region.id)
        review = [
            f"{region.file}: {region.why}"
            for region in regions
            if region.review and region.state != "outside"
        ]
        name = f"{group.robot}/{folder}" if group.robot else folder
        states.append(PackageState(name, outdated, edited, dict(counts), review))
    return states

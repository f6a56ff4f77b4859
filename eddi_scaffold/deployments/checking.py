"""``check`` as a function: every problem of some files, and of their combination."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.common.problems import (
    EddiError,
    Place,
    Problem,
    has_errors,
    problem,
    shortened_list,
)
from eddi_scaffold.config.deployment_file import is_fleet
from eddi_scaffold.config.file import ConfigFile, named_model_path
from eddi_scaffold.deployments.fleet_checks import check_fleet
from eddi_scaffold.deployments.hazards import HazardTrace
from eddi_scaffold.deployments.joining import join, join_pairs, packages_of
from eddi_scaffold.deployments.support import Deployment
from eddi_scaffold.deployments.wiring import absent_publishers, members_of
from eddi_scaffold.eddi_xml.document import recognises as is_xml
from eddi_scaffold.eddi_xml.hazard_analysis import HazardAnalysis
from eddi_scaffold.kinds import Model, ReadResult
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.config_reading import RobotAdditions, read_file
from eddi_scaffold.monitors.input_binding import UnwrittenInput
from eddi_scaffold.monitors.loading import (
    checked_models,
    is_config,
    read_models,
)
from eddi_scaffold.monitors.topic_types import check_types
from eddi_scaffold.platforms import DEFAULT, Platform, chosen

_OF_WHAT_LACKS = ("D006", "G001", "X037")
"""What is reported of something that no file has: it may be in one that could not be read."""


def check_files(
    files: Sequence[Path],
    default_guarantees: Sequence[str] = (),
    robot: RobotAdditions | None = None,
    platform: str | None = None,
    *,
    hazards: bool = False,
) -> list[Problem]:
    """Check every file by itself, and all that ``generate`` would make of them together.

    Args:
        files: models and configurations.
        default_guarantees: the marks of ``--default-guarantee``.
        robot: what models of a robot add to the configurations.
        platform: where monitors are to run. By default, models with configurations are checked for
            the default platform, with ``lifecycle`` for ROS 2, others by themselves.
        hazards: also what is missing between hazards and guarantees.

    Raises:
        EddiError: there is no such platform.
    """
    check = _Check(default_guarantees, robot, chosen(platform) if platform is not None else None)
    of_fleets: set[Path] = set()  # these are checked with their deployment file
    sources: list[Source] = []
    for path in files:
        try:
            source = read_source(path)
        except EddiError as failure:
            check.problems += failure.problems
            check.is_complete = False
            continue
        if is_fleet(source):
            reported, of_fleet = check_fleet(source, check.named)
            check.problems += reported
            of_fleets |= of_fleet
        else:
            sources.append(source)
    for source in sources:
        if Path(source.name).resolve() not in of_fleets:
            check.read(source)
    check.without_models()
    check.together()
    check.problems += check.of_hazards(whole=hazards)
    # that a VAR has no TIMEOUT is a question to whoever uses the model without a configuration
    return [each for each in check.problems if each.code != "W003"]


@dataclass
class _Check:
    """What is known of the files, and wrong with them."""

    marks: Sequence[str]
    robot: RobotAdditions | None
    target: Platform | None
    models: list[Model] = field(default_factory=list)
    configs: list[ConfigFile] = field(default_factory=list)
    monitors: list[BoundMonitor] = field(default_factory=list)
    analyses: list[HazardAnalysis] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)
    is_complete: bool = True  # every file could be read

    def read(self, source: Source) -> None:
        """Read a file, with all that is wrong with it by itself."""
        if is_config(source):
            configs, reported = read_file(source, self.robot)
            self.configs += configs
            self.is_complete &= not has_errors(reported)
        else:
            reading = read_models(source, self.marks)
            reported = [*reading.problems, *reading.unread, *_static(reading.models)]
            self.analyses += [reading.hazards] if reading.hazards is not None else []
            is_empty = not reading.models and reading.hazards is None
            if is_xml(source) and is_empty and not has_errors(reported):
                reported.append(self._requested(problem("F004.no_model", Place(source.name))))
            self.models += reading.models
            self.is_complete &= not is_empty
        self.problems += reported

    def named(self, path: Path) -> ReadResult:
        """Read the file that a configuration names, and report all problems in it."""
        reading = checked_models(path, self.marks)
        return ReadResult(reading.models, (*reading.problems, *_static(reading.models)))

    def without_models(self) -> None:
        """Take out the configurations that have no model, and report what shows in them."""
        alone = [] if self.models else [c for c in self.configs if not _names_its_model(c)]
        self.configs = [config for config in self.configs if config not in alone]
        for config in alone if not has_errors(self.problems) else ():  # it may be their model's
            used = {name for entry in config.config.EDDIInputs for name in entry.requires}
            missing = self._requested(problem("G015.unnamed", config.place("Model")))
            self.problems += [missing, *check_types(config, used)]

    def _requested(self, missing: Problem) -> Problem:
        """Return an error where a monitor is asked for: files by themselves may be as they are."""
        return missing if self.target is not None else replace(missing, level="warning")

    def together(self) -> None:
        """Report what is wrong with models and configurations as monitors of a platform."""
        models, configs, platform = self.models, self.configs, self.target
        if platform is None and configs:
            managed = any(config.config.Model.lifecycle for config in configs)
            platform = chosen("ros2" if managed else DEFAULT)
        if platform is None:
            return
        monitors, problems = join(models, configs, self.named, self.marks)
        problems += packages_of(monitors, platform, None)[1]
        self.monitors = monitors
        joined = {m.config.place("Model") for m in monitors if m.config}
        if joined >= {config.place("Model") for config in configs}:
            problems += absent_publishers(Deployment(members_of(monitors)))
        problems += [*_by_hand(monitors), *_unbound(models, monitors)]
        lacking = () if self.is_complete else _OF_WHAT_LACKS
        self.problems += [each for each in problems if each.code not in lacking]

    def of_hazards(self, *, whole: bool) -> list[Problem]:
        """Return how many hazards are not linked, or all that is wrong with their links (J...)."""
        if not whole or has_errors(self.problems):  # else links would seem to be missing
            items = filter(None, (analysis.unlinked() for analysis in self.analyses))
            return [problem("J001.count", of[0].place, number=len(of)) for of in items]
        if not self.analyses:
            return [problem("F004.no_hazards")]
        monitors = self.monitors
        if not self.configs:  # of the EDDI alone; what they lack is no matter here
            monitors = join_pairs([(model, None) for model in self.models])[0]
        alone = [monitor for monitor in monitors if monitor.config is None]
        traces = [HazardTrace(of, members_of(monitors), alone) for of in self.analyses]
        return [reported for trace in traces for reported in trace.check()]


def _static(models: Iterable[Model]) -> list[Problem]:
    return [problem for model in models for problem in model.check()]


def _names_its_model(config: ConfigFile) -> bool:
    try:
        return named_model_path(config) is not None
    except EddiError:
        return True  # joining reports why


def _unbound(models: Sequence[Model], monitors: Sequence[BoundMonitor]) -> Iterable[Problem]:
    """Name the models of an EDDI that should observe something, but run nowhere (X037)."""
    running = [monitor.model for monitor in monitors if monitor.config]
    places = {(model.source.name, model.place.path) for model in running}
    for model in models if places else ():
        if model.observes and (model.source.name, model.place.path) not in places:
            events = shortened_list({name: None for name, _ in model.observes})
            yield problem("X037", model.place, event=events, model=model.name)


def _by_hand(monitors: Iterable[BoundMonitor]) -> Iterable[Problem]:
    """Name the inputs that only hand-written code can make of their messages (K050)."""
    for monitor in monitors:
        if monitor.config is None:
            continue
        config, package = monitor.config, monitor.package
        if needed := monitor.needed_methods:
            regions = tuple(method.name for method in needed)
            reported = problem("K050.methods", config.place("Model"), names=shortened_list(regions))
            yield UnwrittenInput(**vars(reported), package=package, regions=regions)
        index = {entry.id: number for number, entry in enumerate(config.config.EDDIInputs)}
        for binding in monitor.inputs:
            if binding.requires and not binding.is_given:
                of = f"{binding.model.id} (input of {monitor.id})"
                place = config.place("EDDIInputs", index[binding.model.id])
                known = (binding.known_fields or {}).items()
                fields = [f"{name}.{field}" for name, all_ in known for field in all_]
                text = shortened_list(fields or [f"{name}.FIELD" for name in binding.arguments])
                reported = problem("K050.input", place, input=of, fields=text)
                yield UnwrittenInput(
                    **vars(reported), package=package, regions=binding.regions, by_hand=of
                )

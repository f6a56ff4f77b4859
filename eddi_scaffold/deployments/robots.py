"""The robots of a deployment file, with their platforms, models and configurations."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.identifiers import attribute, free_name, key_text, package_name
from eddi_scaffold.common.problems import EddiError, Place, Problem, has_errors, problem
from eddi_scaffold.config.deployment_file import ROBOTS, FleetFile, Robot, StationSection
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import InputEntry, SimulatorOutput
from eddi_scaffold.kinds import Model, ReadResult
from eddi_scaffold.monitors.config_reading import read_file
from eddi_scaffold.monitors.loading import candidates, model_for
from eddi_scaffold.platforms import MeetingPlace, Platform, chosen

Pair = tuple[Model, ConfigFile]


@dataclass(frozen=True, eq=False)
class FleetRobot:
    """One robot."""

    form: Robot  # its entry in the deployment file
    number: int  # of that entry
    platform: Platform  # where its monitors run
    graph: MeetingPlace | None  # where it hears others; `None` where its platform has no such place
    pairs: tuple[Pair, ...]  # model and configuration of each of its monitors

    @property
    def name(self) -> str:
        """Its name, for people and on the wire."""
        return self.form.name

    @property
    def where(self) -> str:
        """Its platform, and where it hears others, for people."""
        parts, graph = [self.platform.name], self.graph
        if graph is not None:
            parts += [f"{graph.key} {graph.name}"] if graph.name else []
            parts += [f"partition {graph.partition}"] if graph.partition else []
        return ", ".join(parts)


def read_robots(
    file: FleetFile, read: Callable[[Path], ReadResult]
) -> tuple[list[FleetRobot], list[Problem]]:
    """Return the robots of a deployment file that can be used as they are, and all problems."""
    reader = _Reader(file, read)
    all_robots = [reader.robot(number) for number in range(len(file.form.Robots))]
    robots = [robot for robot in all_robots if robot is not None]
    reader.platform(file.form.Station, "Station")
    return robots, [*reader.problems, *_check_namespaces(file, robots)]


@dataclass
class _Reader:
    file: FleetFile
    read: Callable[[Path], ReadResult]
    problems: list[Problem] = field(default_factory=list)
    known: dict[Path, ReadResult] = field(default_factory=dict)

    def robot(self, number: int) -> FleetRobot | None:
        form = self.file.form.Robots[number]
        platform = self.platform(form, ROBOTS, number)
        if platform is None:
            return None
        entries = range(len(form.monitors))
        pairs = [(index, pair) for index in entries for pair in self._pairs(number, index)]
        place = partial(self.file.place, ROBOTS, number, "monitors")
        first: dict[str, int] = {}  # package -> its entry
        clashes = []  # told before anything is made of them
        for index, (_, config) in pairs:
            name = package_name(config.config.Model.id)
            if name in first:
                line, case = place(first[name]).line, "G004.same_package_monitors"
                clashes.append(problem(case, place(index), kind=form.name, line=line, package=name))
            first.setdefault(name, index)
        self.problems += clashes
        if clashes or {index for index, _ in pairs} != {*entries}:
            return None
        graph = graph_of(form, platform)
        return FleetRobot(form, number, platform, graph, tuple(pair for _, pair in pairs))

    def platform(self, form: Robot | StationSection, *path: str | int) -> Platform | None:
        """Return a platform; report a place on it that it does not have (K003)."""
        if form.platform is None:
            return None
        try:
            platform = chosen(form.platform)
        except EddiError as failure:
            place = self.file.place(*path, "platform")
            self.problems += [replace(problem, place=place) for problem in failure.problems]
            return None
        meeting = platform.meeting
        own = [meeting.key, *(["partition"] if meeting.has_partitions else [])] if meeting else []
        for key in ("master", "domain", "partition"):
            if key not in own and getattr(form, key) is not None:
                place, name = self.file.place(*path, key), platform.name
                self.problems.append(problem("K003.platform", place, key=key, platform=name))
        return platform

    def _pairs(self, robot: int, monitor: int) -> list[Pair]:
        """Return what a file of configurations describes; none where something is wrong."""
        try:
            config_file, model_file = self.file.files(robot, monitor)
            override = self.file.overrides.get((robot, monitor))
            configs, problems = read_file(read_source(config_file), override=override)
            self.problems += problems
            if has_errors(problems):
                return []
            models = self._models(model_file).models if model_file is not None else ()
            named = [(config, candidates(config, models, self._models)) for config in configs]
            return [(model_for(config, reading.models), config) for config, reading in named]
        except EddiError as failure:
            self.problems += failure.problems
            return []

    def _models(self, path: Path) -> ReadResult:
        if path not in self.known:
            self.known[path] = self.read(path)
            self.problems += self.known[path].problems
        return self.known[path]


def graph_of(form: Robot | StationSection, platform: Platform) -> MeetingPlace | None:
    """Return where a robot or station hears others."""
    meeting = platform.meeting
    if meeting is None:
        return None
    named = getattr(form, meeting.key)
    partition = form.partition if meeting.has_partitions else None
    return MeetingPlace(
        meeting.key, str(meeting.default if named is None else named), partition or ""
    )


def _check_namespaces(file: FleetFile, robots: Sequence[FleetRobot]) -> Iterator[Problem]:
    """Report robots that nobody could tell apart (D010)."""
    first: dict[tuple[MeetingPlace, str], FleetRobot] = {}
    for robot in robots:
        prefix, place = robot.form.prefix, file.place(ROBOTS, robot.number, "namespace")
        before = first.setdefault((robot.graph, prefix), robot) if robot.graph else robot
        if before is not robot:
            names = {"other": before.name, "robot": robot.name, "prefix": prefix or "/"}
            yield problem("D010.same_namespace", place, **names)


def with_demand_inputs(
    config: ConfigFile,
    demand: str,
    sources: Sequence[tuple[SimulatorOutput, str]],
    max_age: float,
    place: Place,
) -> ConfigFile:
    """Return a configuration whose demand is fulfilled while one of some guarantees is active.

    What it says itself of where the demand comes from is replaced; its age limit stays. Sources are
    a topic, whose id is only a wish, and the id of the guarantee in its messages.
    """
    form, places = config.config, dict(config.places)
    outputs = list(form.SimulatorOutputs)
    names: list[str] = []
    fields: list[str] = []
    for output, guarantee in sources:
        taken = {attribute(entry.id) for entry in (*outputs, *form.EDDIInputs)}
        names.append(free_name(attribute(output.id), taken))
        fields.append(f"guarantees[{key_text(guarantee)}].active")
        places["SimulatorOutputs", len(outputs)] = place
        outputs.append(output.model_copy(update={"id": names[-1]}))
    how: dict[str, object] = {"field": fields[0]}
    if len(sources) > 1:
        how = {"expression": " OR ".join(map("{}.{}".format, names, fields))}
    entries = list(form.EDDIInputs)
    ids = [entry.id for entry in entries]
    index = ids.index(demand) if demand in ids else len(ids)
    old = entries[index] if demand in ids else InputEntry(id=demand, type="bool")
    replaced = dict.fromkeys(("field", "expression", "expression_file", "states"))
    age = max_age if old.max_age is None else old.max_age
    new = {**replaced, **how, "requires": names, "max_age": age}
    entries[index : index + 1] = [old.model_copy(update=new)]
    places |= {("EDDIInputs", index, key): place for key in ("requires", *how)}
    places.setdefault(("EDDIInputs", index), place)
    update = {"SimulatorOutputs": outputs, "EDDIInputs": entries}
    return replace(config, config=form.model_copy(update=update), places=places)

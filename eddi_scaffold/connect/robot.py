"""A robot as MROS models describe it: read, checked, and what it adds to configurations."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.identifiers import is_ros_name
from eddi_scaffold.common.problems import EddiError, Problem, did_you_mean, problem
from eddi_scaffold.config.field_types import declared
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.config_reading import RobotAdditions, read_file
from eddi_scaffold.monitors.loading import is_config
from eddi_scaffold.mros import (
    SYSTEM_SUFFIX,
    System,
    load_models,
    load_system,
    read_ros_models,
)
from eddi_scaffold.mros.resolving import Models
from eddi_scaffold.mros.topics import Outputs, TopicEntry, silent_problems, simulator_outputs


@dataclass(frozen=True)
class Robot:
    """A system and the models of its nodes, as files of this machine."""

    folder: Path  # of the models
    path: Path | None  # of the system, `None` where only models are known
    system: System
    models: Models
    problems: tuple[Problem, ...]  # of the files

    def located(self, problems: Iterable[Problem]) -> list[Problem]:
        """Return problems with files as a person can open them, not relative to the models."""
        models = self.models
        inside = {*models.skipped, *(reported.place.file for reported in models.problems)}
        inside |= {model.file for model in models.files} | {part.file for part in models.systems}
        paths = {file: str(self.folder / file) for file in inside if file is not None}
        if self.path is not None:
            paths[self.system.file] = str(self.path)
        return [
            replace(fault, place=replace(fault.place, file=paths.get(file, file)))
            if (file := fault.place.file) is not None
            else fault
            for fault in problems
        ]

    def message_types(self) -> dict[str, dict[str, str]]:
        """Return the messages that are specified next to node models; of a name the first."""
        types: dict[str, dict[str, str]] = {}
        for package in (package for file in self.models.files for package in file.packages):
            for spec in package.specs:
                fields = dict(spec.sections).get("message")
                if fields is not None:
                    pairs = ((field.type, field.name) for field in fields if field.value is None)
                    name = f"{package.name}/{spec.name}"
                    types.setdefault(name, declared(pairs, package.name))
        return types

    def simulator_outputs(self, entries: object) -> list[dict[str, JsonValue]]:
        """Return the entries that ``parse-rossystem`` would write in place of some.

        Topics that ROS does not allow are left out: an error in what nobody wrote would have no
        line to be mended.
        """
        listed = entries if isinstance(entries, list) else []
        rows = [row for row in listed if isinstance(row, dict)]
        by_topic = {str(row.get("topic")): row for row in rows}
        keys = ("id", "type", "topic")
        written = [[str(row.get(key)) for key in keys] for row in rows]
        existing = [TopicEntry(id_, type_, topic) for id_, type_, topic in written]
        new, taken = [], set[str]()
        for topic in simulator_outputs(self.system, self.models, existing=existing).topics:
            if is_ros_name(topic.topic) or topic.topic in by_topic:
                values = {key: getattr(topic, key) for key in keys}
                new.append({**by_topic.get(topic.topic, {}), **values})
                taken |= {topic.id, topic.topic}
        names = ({old.id, old.topic} for old in existing)
        return [*new, *(row for row, own in zip(rows, names, strict=True) if not own & taken)]


def read_robot(system: Path | None, folder: Path) -> Robot:
    """Read a system and all models of its directory (EddiError: one cannot be read)."""
    models = load_models(folder)
    if system is None:
        return Robot(folder, None, System("", "indent", ""), models, tuple(models.problems))
    try:
        model, problems = load_system(system, folder)
    except EddiError as failed:  # who can go no further sees an error in any case
        raise EddiError(*(replace(fault, level="error") for fault in failed.problems)) from None
    return Robot(folder, system, model, models, (*problems, *models.problems))


def robot_of(system: Path | None, folder: Path | None) -> Robot | None:
    """Read a system with models, models alone, or none (EddiError G017: there are no models)."""
    if folder is None and system is not None:
        raise EddiError(problem("G017"))
    return None if folder is None else read_robot(system, folder)


@contextmanager
def robot_models(
    system: Path | None, folder: Path | None
) -> Iterator[tuple[RobotAdditions | None, list[Problem]]]:
    """Add what a command was given with configurations: a system, models, both or none.

    What does not resolve in the system is a warning here: only what an input requires must.

    What is wrong may be the reason for what is refused inside, and is told with it.
    """
    robot = robot_of(system, folder)
    if robot is None:
        yield None, []
        return
    outputs = simulator_outputs(robot.system, robot.models)
    reported = robot.located([*robot.problems, *outputs.problems])
    problems = [replace(fault, level="warning") for fault in reported]
    additions = RobotAdditions(types=robot.message_types())
    if system is not None:
        additions = replace(additions, outputs=robot.simulator_outputs)
    try:
        yield additions, problems
    except EddiError as refused:
        raise EddiError(*problems, *refused.problems) from None


def check_robots(
    files: Sequence[Path], configs: Sequence[Path], folder: Path | None
) -> tuple[list[Problem], RobotAdditions | None]:
    """Check ``.rossystem`` and ``.ros*`` files, and configurations against the systems.

    The models of a directory, if there is one, add something to configurations.
    """
    robot, problems = None, list[Problem]()
    if folder is not None:
        robot = read_robot(None, folder)
        problems += robot.located(robot.problems)
    for path in files:
        problems += _check_file(path, robot, configs)
    return problems, None if robot is None else RobotAdditions(types=robot.message_types())


def _check_file(path: Path, robot: Robot | None, configs: Sequence[Path]) -> Sequence[Problem]:
    try:
        if not path.name.endswith(SYSTEM_SUFFIX):
            return read_ros_models(read_source(path).data, str(path)).problems
        system, problems = load_system(path, robot.folder if robot is not None else None)
    except EddiError as failed:
        return failed.problems
    if robot is None:
        return problems
    outputs = simulator_outputs(system, robot.models, include=("subscribed", "actions"))
    problems += [*outputs.problems, *silent_problems(system, robot.models)]
    problems = replace(robot, path=path, system=system).located(problems)
    for config in configs:
        problems += _compared(config, outputs, path)
    return problems


def _compared(path: Path, outputs: Outputs, system: Path) -> Iterable[Problem]:
    """Compare the topics of a configuration with those of a system (K040)."""
    try:
        source = read_source(path)
    except EddiError:
        return  # reported when the file itself is checked
    known = {topic.topic: topic.type for topic in outputs.topics}
    configs = read_file(source)[0] if is_config(source) else []
    listed = [(c, *entry) for c in configs for entry in enumerate(c.config.SimulatorOutputs)]
    for config, index, entry in listed:
        fields: dict[str, Any] = {"system": system, "topic": entry.topic}
        type_ = known.get(entry.topic)
        if type_ is None:
            hint = did_you_mean(entry.topic, known)
            place = config.place("SimulatorOutputs", index, "topic")
            yield problem("K040.topic", place, hint=hint, **fields)
        elif type_ != entry.type:
            place = config.place("SimulatorOutputs", index, "type")
            yield problem("K040.direction", place, actual=type_, **fields)

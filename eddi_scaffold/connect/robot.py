"""Models of a robot, and what they add to a configuration."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.identifiers import is_ros_name
from eddi_scaffold.common.problems import EddiError, Place, Problem, did_you_mean, problem
from eddi_scaffold.config.field_types import declared
from eddi_scaffold.connect.rossystem import Robot, read_robot
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.config_reading import RobotAdditions, read_config
from eddi_scaffold.monitors.loading import is_config
from eddi_scaffold.mros import SYSTEM_SUFFIX, MrosSyntaxError, read_ros_models
from eddi_scaffold.mros.directory import load_models, load_system, problem_of
from eddi_scaffold.mros.resolving import Models
from eddi_scaffold.mros.topics import Outputs, TopicEntry, silent_problems, simulator_outputs


@contextmanager
def robot_models(
    system: Path | None, folder: Path | None
) -> Iterator[tuple[RobotAdditions | None, list[Problem]]]:
    """Add what a command was given with configurations: a system, models, both or none.

    What does not resolve in the system is a warning here: only what an input requires must.

    Yields:
        What the models add, and what is wrong with them: it may be the reason for what is refused
        inside, and is told with it.

    Raises:
        EddiError: one of the two cannot be read, or the models of a system are missing (G017).
    """
    if folder is None:
        if system is not None:
            raise EddiError(problem("G017"))
        yield None, []
        return
    if system is None:
        models = load_models(folder)
        additions = RobotAdditions(types=message_types(models))
        problems = _located(folder, models.problems)
    else:
        robot = read_robot(system, folder)
        outputs = simulator_outputs(robot.system, robot.models)
        additions = _additions(robot)
        problems = robot.located([*robot.problems, *outputs.problems])
    problems = [replace(reported, level="warning") for reported in problems]
    try:
        yield additions, problems
    except EddiError as refused:
        raise EddiError(*problems, *refused.problems) from None


def _additions(robot: Robot) -> RobotAdditions:
    """Return what a system and its models add to configurations.

    The entries of ``SimulatorOutputs`` become those that ``parse-rossystem`` would write, without
    topics that ROS does not allow: an error in what nobody wrote would have no line to be mended.
    """

    def outputs(entries: object) -> list[dict[str, JsonValue]]:
        listed = entries if isinstance(entries, list) else []
        rows = [row for row in listed if isinstance(row, dict)]
        by_topic = {str(row.get("topic")): row for row in rows}
        place = Place(str(robot.path))
        keys = ("id", "type", "topic")
        written = [[str(row.get(key)) for key in keys] for row in rows]
        existing = [TopicEntry(id_, type_, topic, place) for id_, type_, topic in written]
        new, taken = [], set[str]()
        for topic in simulator_outputs(robot.system, robot.models, existing=existing).topics:
            if is_ros_name(topic.topic) or topic.topic in by_topic:
                values = {key: getattr(topic, key) for key in keys}
                new.append({**by_topic.get(topic.topic, {}), **values})
                taken |= {topic.id, topic.topic}
        names = ({old.id, old.topic} for old in existing)
        return [*new, *(row for row, own in zip(rows, names, strict=True) if not own & taken)]

    return RobotAdditions(outputs, message_types(robot.models))


def check_robots(
    files: Sequence[Path], configs: Sequence[Path], folder: Path | None
) -> tuple[list[Problem], RobotAdditions | None]:
    """Check ``.rossystem`` and ``.ros*`` files, and configurations against the systems.

    Args:
        files: of the MROS family.
        configs: the other files of the command; those that are configurations are compared.
        folder: directory of node models; without it the files are only read.

    Returns:
        All problems, and what the models add to configurations.
    """
    models = load_models(folder, systems=True) if folder is not None else None
    problems = _located(folder, models.problems) if folder is not None and models else []
    for path in files:
        problems += _check_file(path, folder, models, configs)
    return problems, RobotAdditions(types=message_types(models)) if models is not None else None


def _check_file(
    path: Path, folder: Path | None, models: Models | None, configs: Sequence[Path]
) -> Sequence[Problem]:
    try:
        if not path.name.endswith(SYSTEM_SUFFIX):
            return read_ros_models(read_source(path).data, str(path)).problems
        system, problems = load_system(path, folder)
    except MrosSyntaxError as failed:
        return [problem_of(failed)]
    except EddiError as failed:
        return failed.problems
    if folder is None or models is None:
        return problems
    outputs = simulator_outputs(system, models, include=("subscribed", "actions"))
    problems += [*outputs.problems, *silent_problems(system, models)]
    problems = Robot(folder, path, system, models, ()).located(problems)
    for config in configs:
        problems += _compared(config, outputs, path)
    return problems


def _compared(path: Path, outputs: Outputs, system: Path) -> Iterable[Problem]:
    """Compare the topics of a configuration with those of a system (K040)."""
    try:
        source = read_source(path)
    except EddiError:
        return  # reported when the file itself is checked
    config = read_config(source)[0] if is_config(source) else None
    known = {topic.topic: topic for topic in outputs.topics}
    for index, entry in enumerate(config.config.SimulatorOutputs if config else ()):
        assert config is not None
        topic = known.get(entry.topic)
        if topic is None:
            hint = did_you_mean(entry.topic, known)
            place = config.place("SimulatorOutputs", index, "topic")
            yield problem("K040.topic", place, hint=hint, system=system, topic=entry.topic)
        elif topic.type.replace(".", "/") != entry.type:
            yield problem(
                "K040.direction",
                config.place("SimulatorOutputs", index, "type"),
                topic=entry.topic,
                actual=topic.type.replace(".", "/"),
                system=system,
            )


def _located(folder: Path, problems: Iterable[Problem]) -> list[Problem]:
    return [
        replace(reported, place=replace(reported.place, file=str(folder / reported.place.file)))
        for reported in problems
    ]


def message_types(models: Models) -> dict[str, dict[str, str]]:
    """Return the messages that are specified next to node models; the first of a name is used."""
    found: dict[str, dict[str, str]] = {}
    for file in models.files:
        for package in file.packages:
            for spec in package.specs:
                fields = dict(spec.sections).get("message")
                if fields is not None:
                    pairs = ((field.type, field.name) for field in fields if field.value is None)
                    table = declared(pairs, package.name)
                    found.setdefault(f"{package.name}/{spec.name}", table)
    return found

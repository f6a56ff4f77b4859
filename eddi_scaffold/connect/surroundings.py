"""What is given beside the model: the robot, and other monitors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from eddi_scaffold.config.block import ConfigText, read_block
from eddi_scaffold.config.message_types import MessageFields
from eddi_scaffold.config.reading import RobotAdditions, read_configs
from eddi_scaffold.connect.draft import Age, deadline_age
from eddi_scaffold.deployments.joining import join
from eddi_scaffold.identifiers import is_ros_name
from eddi_scaffold.kinds import Model
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.loading import checked_models
from eddi_scaffold.mros.directory import load_models
from eddi_scaffold.problems import EddiError, Problem, error, has_errors
from eddi_scaffold.robot.robot_models import message_types
from eddi_scaffold.robot.rossystem import read_robot, with_topics
from eddi_scaffold.source import Source


@dataclass(frozen=True)
class Around:
    """What is given beside the model.

    Attributes:
        system: a ``.rossystem``.
        models: the directory of its node models.
        configs: of other monitors.
        marks: default guarantees.
        ages: full name of a topic -> when its messages are too old.
        topics: full name -> type, of those that were recorded.
        types: of their messages.
    """

    system: Path | None = None
    models: Path | None = None
    configs: Sequence[Path] = ()
    marks: Sequence[str] = ()
    ages: Mapping[str, Age] = field(default_factory=dict)
    topics: Mapping[str, str] = field(default_factory=dict)
    types: MessageFields = field(default_factory=dict)


@dataclass(frozen=True)
class OnRobot:
    """A configuration with the topics of a robot.

    Attributes:
        types: of the messages, next to the models.
        ages: full name of a topic -> when its messages are too old, by the models.
    """

    document: ConfigText
    types: MessageFields = field(default_factory=dict)
    ages: Mapping[str, Age] = field(default_factory=dict)
    problems: Sequence[Problem] = ()


def with_robot(document: ConfigText, around: Around) -> OnRobot:
    """Return the configuration with the topics of the system, and what the models say of them.

    Raises:
        EddiError: one of them cannot be read, or the models of a system are missing (G017).
    """
    if around.models is None:
        if around.system is not None:
            hint = "--models DIR: the directory of its .ros, .ros1 and .ros2 files"
            raise EddiError(error("G017", "--system needs the models of its nodes", hint=hint))
        return OnRobot(document)
    if around.system is None:
        return OnRobot(document, message_types(load_models(around.models)))
    robot = read_robot(around.system, around.models)
    parsed = with_topics(robot, document, wants=lambda one: is_ros_name(one.topic))
    after = read_block(Source(document.name, parsed.after.encode()))
    ages = {one.topic: deadline_age(one.deadlines) for one in parsed.outputs.topics}
    known = {topic: age for topic, age in ages.items() if age is not None}
    return OnRobot(after, message_types(robot.models), known, robot.located(parsed.problems))


def monitors_beside(models: Sequence[Model], around: Around) -> list[BoundMonitor]:
    """Return the monitors of the other configurations.

    Raises:
        EddiError: one of them cannot be used.
    """
    if not around.configs:
        return []
    configs, _ = read_configs(around.configs, RobotAdditions())
    monitors, problems = join(
        models, configs, lambda path: checked_models(path, around.marks), around.marks
    )
    if has_errors(problems):
        raise EddiError(*problems)
    return monitors
